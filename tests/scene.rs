//! Scenes from files made by others, from files made here, and from formulas. What a checker lets pass, its twin shows
//! it can also refuse.

#[path = "scene/appearance.rs"]
mod appearance;
#[path = "scene/atlas.rs"]
mod atlas;
#[path = "scene/cameras.rs"]
mod cameras;
#[path = "scene/check.rs"]
mod check;
#[path = "scene/collection.rs"]
mod collection;
#[path = "scene/compressed.rs"]
mod compressed;
#[path = "scene/fixture.rs"]
mod fixture;
#[path = "scene/geometry.rs"]
mod geometry;
#[path = "scene/layers.rs"]
mod layers;
#[path = "scene/lies.rs"]
mod lies;
#[path = "scene/motion.rs"]
mod motion;
#[path = "scene/shapes.rs"]
mod shapes;
