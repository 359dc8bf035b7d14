//! From a compute shader over tiles, the same as a fragment shader: its stores at its own pixel become outputs. Which of the two is
//! faster is the device's affair (`src/gpu/suit.rs`), and no shader is written twice. `common/tiles.glsl` finds the pixel in either.

/// The text of the fragment shader, from a compute shader's with its includes read and its conditions decided; `None` where it
/// stores to an image that it also reads.
pub fn fragment(text: &str) -> Option<String> {
    let mut out = String::with_capacity(text.len());
    let mut outputs = 0;
    for line in text.lines() {
        let words: Vec<&str> =
            line.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|w| !w.is_empty()).collect();
        let image = words.iter().position(|w| matches!(*w, "image2D" | "uimage2D"));
        let declared = image.filter(|_| words.contains(&"uniform"));
        if let Some(at) = declared.filter(|_| !words.contains(&"readonly")) {
            if !words.contains(&"writeonly") {
                return None;
            }
            let kind = if words[at] == "uimage2D" { "uvec4" } else { "vec4" };
            out += &format!("layout(location = {outputs}) out {kind} {};\n", words[at + 1]);
            outputs += 1;
            continue;
        }
        // Who leaves before the end has stored nothing.
        let leaves = words.first() == Some(&"if") && words.last() == Some(&"return") && !words.contains(&"imageStore");
        out += &if leaves { line.replace("return", "discard") } else { line.to_owned() };
        out.push('\n');
        if line.starts_with("#version") {
            out += "#define imageStore(image, pixel, value) image = value\n";
        }
    }
    Some(out)
}
