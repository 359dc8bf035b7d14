//! The science of scattering under the skin, in f64 and without a GPU.
//!
//! | module | question it answers |
//! |---|---|
//! | [`profile`] | how far does light travel under this surface: R(r), per channel, and as a few Gaussians |
//! | [`sphere`] | what leaves a sphere under one distant light: exact, a Legendre series or one smooth integral |
//! | [`curvature`] | screen-space curvature estimators, the twins of `glsl/curvature.comp` |
//! | [`blur`] | one pass of the diffusion, the twin of `glsl/blur.comp` |
//! | [`gather`] | light found from the light's own view, the twin of `glsl/translucent.comp` |
//! | [`light`] | both lighting forms, the twins of `glsl/light.comp` |
//! | [`octahedral`] | unit vectors in 2 x 16 bit |
//! | [`facet`] | how far a smooth surface lies above its triangles |
//! | [`vectors`] | every formula as numbers in and out, for ports |
//! | [`ring`] | the same on a ring, to reproduce Penner & Borshukov 2011 |
//! | [`lut`] | either of them as a small table over (mu, curvature) that a GPU samples bilinearly |
//! | [`moments`] | E max(0, X) of a normal variable: the closed form that needs no table |
//! | [`mass`] | how much surface, seen or hidden, a Gaussian finds around a vertex |
//! | [`burley`] | Burley's normalised diffusion as samples: its inverse distribution, and which one is closest to a profile |
//! | [`penumbra`] | what the profile makes of a shadow's edge whose penumbra has a known width |
//! | [`separable`] | the kernel of one separable pair of passes, and what passes through a thin part |
//! | [`sky`] | irradiance from a whole sky, and what scattering leaves of each of its bands |
//! | [`specular`] | what gloss takes from diffuse light, one lobe or two |
//! | [`occlusion`] | how much of the sky a concave patch of known curvature hides |
//!
//! Units: millimetres; variances in mm^2; curvatures in 1/mm, convex positive. `mu` is the cosine between the surface
//! normal and the light. Irradiance at normal incidence and albedo are one throughout: what is returned is exitance as
//! a fraction. A channel triple is red, green, blue.

pub mod blur;
pub mod burley;
pub mod curvature;
pub mod facet;
pub mod gather;
pub mod light;
pub mod lut;
pub mod mass;
pub mod moments;
pub mod occlusion;
pub mod octahedral;
pub mod penumbra;
pub mod profile;
pub(crate) mod quadrature;
pub mod ring;
pub mod separable;
pub mod sky;
pub mod specular;
pub mod sphere;
pub mod vectors;
