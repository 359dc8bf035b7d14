//! [`shaderc`], and nothing else: what this crate adds is in its build script,
//! which links what Debian and Ubuntu leave out of their `libshaderc_combined.a`.
pub use shaderc::*;
