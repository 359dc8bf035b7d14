//! [`shaderc`], and nothing else: what this crate adds is in its build script,
//! which links what Debian and Ubuntu leave out of their `libshaderc_combined.a`.
pub use shaderc::*;

#[cfg(test)]
mod tests {
    use super::*;

    const MAGIC: u32 = 0x0723_0203;

    #[test]
    fn compiles_and_optimizes() {
        let mut options = CompileOptions::new().unwrap();
        options.set_target_env(TargetEnv::Vulkan, EnvVersion::Vulkan1_3 as u32);
        options.set_optimization_level(OptimizationLevel::Performance);
        let text = "#version 460\nlayout(local_size_x = 8) in;\nvoid main() {}\n";
        let compiler = Compiler::new().unwrap();
        let made = compiler.compile_into_spirv(text, ShaderKind::Compute, "a.comp", "main", Some(&options)).unwrap();
        assert_eq!(made.as_binary()[0], MAGIC);
    }

    #[test]
    fn assembles() {
        let text = "OpCapability Shader\nOpMemoryModel Logical GLSL450\n";
        let made = Compiler::new().unwrap().assemble(text, None).unwrap();
        assert_eq!(made.as_binary()[0], MAGIC);
    }
}
