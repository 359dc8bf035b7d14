//! `cargo run --release -p bust`: writes `assets/bust.glb` anew. `-- OUT CELL TRIANGLES TEXELS` for a quick look elsewhere.

use anyhow::{Context, Result};
use bust::{bake, glb, mesh, unwrap};

fn main() -> Result<()> {
    let told: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize, default: f64| {
        told.get(i).map_or(Ok(default), |t| t.parse().with_context(|| format!("'{t}' is no number")))
    };
    let out = told.first().map_or(concat!(env!("CARGO_MANIFEST_DIR"), "/../bust.glb"), String::as_str);
    let (cell, triangles, texels) = (number(1, 0.8)?, number(2, 60_000.)? as usize, number(3, 1024.)? as u32);
    let start = std::time::Instant::now();
    let tell = |what: &str| eprintln!("{:5.1} s: {what}", start.elapsed().as_secs_f64());
    let half = mesh::half(cell, triangles / 2);
    tell(&format!("half: {} triangles, {} vertices", half.triangles.len(), half.positions.len()));
    let uv = unwrap::unwrap(&half)?;
    tell("unwrapped");
    let (whole, uvs) = glb::both(&half, &uv);
    let textures = bake::bake(&whole, &uvs, texels);
    tell("painted");
    let bytes = glb::write(&half, &uv, &textures, &bake::eyes(256))?;
    let temporary = format!("{out}.part");
    std::fs::write(&temporary, &bytes).with_context(|| temporary.clone())?;
    std::fs::rename(&temporary, out).with_context(|| out.to_owned())?;
    tell(&format!("{out}: {} bytes", bytes.len()));
    Ok(())
}
