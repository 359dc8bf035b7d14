//! The steps of a frame: one file a stage, one shader of the same stem. A stage adds its passes to the [`Plan`]; what they
//! touch is read from the shader, so a stage names its module, its domain, its constants, and nothing else.
//!
//! [`Plan`]: crate::plan::Plan

pub mod background;
pub mod blur;
pub mod burley;
pub mod combine;
pub mod curvature;
pub mod entrance;
pub mod forward;
pub mod gather;
pub mod gaussians;
pub mod gbuffer;
pub mod inert;
pub mod irradiance;
pub mod layer;
pub mod light;
pub mod overlay;
pub mod seams;
pub mod separable;
pub mod shadow;
pub mod sheets;
pub mod sparse;
pub mod tiles;
pub mod tonemap;
pub mod translucent;
pub mod transmittance;
pub mod unwrap;
pub mod view;
pub mod visibility;
