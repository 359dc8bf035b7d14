//! The science against independent twins: published tables, tanh-sinh quadrature, Monte Carlo, closed forms.
//!
//! Every checker is also shown a wrong answer that looks right, and must catch it.

#[path = "skin/burley.rs"]
mod burley;
#[path = "skin/fewer.rs"]
mod fewer;
#[path = "skin/lut.rs"]
mod lut;
#[path = "skin/moments.rs"]
mod moments;
#[path = "skin/occlusion.rs"]
mod occlusion;
#[path = "skin/penumbra.rs"]
mod penumbra;
#[path = "skin/profile.rs"]
mod profile;
#[path = "skin/ring.rs"]
mod ring;
#[path = "skin/separable.rs"]
mod separable;
#[path = "skin/sky.rs"]
mod sky;
#[path = "skin/specular.rs"]
mod specular;
#[path = "skin/sphere.rs"]
mod sphere;
#[path = "skin/twin.rs"]
mod twin;
