//! The science, in f64, without a GPU.
pub mod curvature;
