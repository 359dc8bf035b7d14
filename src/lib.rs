//! pdss: pre-integrated deferred subsurface scattering (Chen, Lambert & Penner, SIGGRAPH 2014 poster) on Vulkan.
//!
//! A scene, a camera, lights, a diffusion profile and [`settings`] go in; a picture comes out, and with it the plan of the
//! frame, its barriers, its memory and its times. Lengths are millimetres throughout.
//!
//! # The frame
//!
//! What [`methods`] lists for `pdss`, inputs -> outputs; [`targets`] says what a texel of each means. A step that a scene
//! does not need is not there, and [`plan::Plan::left_out`] says why.
//!
//! ```text
//! shadow      meshes                                   -> shadow                 one layer a light, six a point light
//! gbuffer     meshes                                   -> viewz normal albedo material (bumped)
//! tiles       viewz                                    -> lists of tiles to visit
//! visibility  viewz normal shadow                      -> lit                    cosine times visibility
//! curvature   viewz normal                             -> curvature              H, K, confidence
//! blur        viewz normal curvature lit               -> soft0.. softlit0..     one level after the other, wider each time
//! clear       -                                        -> ldr or exr
//! light       G-buffer, soft, softlit, table, shadow   -> ldr or exr             the table is what is pre-integrated
//! ```
//!
//! `moments` runs the same stages, with closed forms instead of the table, and without `curvature` where ambient occlusion
//! is off. `lambert` has `clear`, `shadow`, `gbuffer`, `tiles` and `light` alone.
//!
//! # A frame in code
//!
//! [`frame::Renderer::new`] plans, creates everything and records once; [`frame::Renderer::run`] is one submit.
//!
//! ```no_run
//! use pdss::frame::{Inputs, Output, Renderer};
//! use pdss::gpu::{Gpu, Options};
//! use pdss::scene::{Camera, Light, LoadOptions, Scene};
//! use pdss::settings::{Method, Settings, Size};
//! use pdss::skin::profile::Profile;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let gpu = Gpu::open(&Options { validate: false, device: None })?;
//! let mut scene = Scene::open("shape:torus:11,4.5", &LoadOptions::default())?;
//! scene.assign_profile(None, 0)?; // every opaque dielectric scatters
//! let camera = Camera::orbit(30., 40., 57., None, 30., &scene); // yaw, pitch, mm; its target; field of view
//! let lights = vec![Light::directional(140., 35., 3.5), Light::directional(-40., 15., 0.4)];
//! let profiles = vec![Profile::resolve("skin")?];
//! let settings = Settings { method: Method::Pdss, size: Size { width: 825, height: 540 }, ..Settings::default() };
//!
//! let inputs = Inputs { scene: &scene, camera, lights, profiles, settings, timing: None, output: Output::Ldr };
//! let mut renderer = Renderer::new(&gpu, inputs)?;
//! renderer.run()?;
//! let rgba8: Vec<u8> = renderer.ldr()?; // sRGB, row by row from the top
//!
//! drop(renderer);
//! gpu.close()?; // an error if anything was leaked
//! # let _ = rgba8;
//! # Ok(())
//! # }
//! ```
//!
//! # Where things are
//!
//! [`scene`] reads glTF and makes shapes. [`skin`] is the science, in f64 and without a GPU. [`plan`] decides, [`stages`] are
//! the steps, [`methods`] put them in order, [`frame`] creates and records what was decided. [`gpu`] holds all unsafe code.
//! [`report`] turns frames into pictures, tables and records; [`compare`] holds all methods against [`truth`] and the clock. `glsl/README.md` is the guide for porting the shaders.
#![deny(unsafe_code)]
#![warn(missing_docs)]

pub mod cache;
pub mod compare;
pub mod frame;
pub mod gpu;
pub mod methods;
pub mod plan;
pub mod report;
pub mod scene;
pub mod settings;
pub mod shaders;
pub mod skin;
pub mod stages;
pub mod stress;
pub mod targets;
pub mod truth;
