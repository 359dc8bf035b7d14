fn main() {
    let compiler = shaderc::Compiler::new().unwrap();
    let glsl = "#version 460\nlayout(local_size_x = 8) in;\nvoid main() {}\n";
    let out = compiler.compile_into_spirv(glsl, shaderc::ShaderKind::Compute, "proof.comp", "main", None).unwrap();
    assert_eq!(out.as_binary()[0], 0x0723_0203);
    let text = "OpCapability Shader\nOpMemoryModel Logical GLSL450\n";
    let out = compiler.assemble(text, None).unwrap();
    assert_eq!(out.as_binary()[0], 0x0723_0203);
}
