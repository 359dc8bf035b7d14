//! The rows: what is tried, what must hold, the bound, and who measures it. A new row is a line here.

use super::Engine::{Each, Once, Scattering};
use super::{Row, edge, file, gathered, integral, lighting, material, size, surface, twins};

type Known = &'static [(&'static str, &'static str, &'static str)];

// Method, quantity (empty: any), why.
#[rustfmt::skip]
mod known {
    use super::Known;

    pub const GLOW: Known = &[("", "|E - 1/4| median", "taps land where no surface is: what is wider than the object cannot be gathered from the screen")];
    pub const METAL: Known = &[
        ("preintegrated", "albedo 0: - gloss", "forward shading keeps gloss in f32, the G-buffer that lambert reads in 8 bits"),
    ];
    pub const BUMPS: Known = &[("pdss", "roughness / lambert's", "a mean normal made unit again, as published: where bumps cancel, what is left of them is stretched")];
    pub const QUADS: Known = &[
        ("preintegrated", "p99", "curvature from derivatives over quads of 2 x 2 pixels, as published: a crop by an odd number cuts other quads"),
        ("burley", "p99", "samples are turned by the pixel's place in the picture, as published: a crop turns them otherwise, by as much as they err"),
    ];
    pub const ALONE: Known = &[("preintegrated", "behind lit", "it gathers nothing, so that nothing near can reach it: there is no wrong input")];
    const FIRST: &str = "transmittance takes the first surface that the shadow map holds for the one where light enters; from inside there is none";
    pub const INSIDE: Known = &[
        ("preintegrated", "largest exitance", FIRST),
        ("gaussians", "largest exitance", FIRST),
        ("separable", "largest exitance", FIRST),
        ("burley", "largest exitance", FIRST),
    ];
}
use known::{ALONE, BUMPS, GLOW, INSIDE, METAL, QUADS};

/// Every row, in the order in which they are run.
#[rustfmt::skip]
pub const ROWS: &[Row] = &[
    // Curvature.
    Row { name: "sphere r = 1e-3 .. 1e6 mm", holds: "H r = 1, one bound at every scale", bounds: &[("|H r - 1| p99", 1e-2)], quick: false, engine: Once(surface::scales), expected: &[] },
    Row { name: "plane", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: false, engine: Once(surface::plane), expected: &[] },
    Row { name: "cube", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: false, engine: Once(surface::cube), expected: &[] },
    Row { name: "cylinder", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: false, engine: Once(surface::cylinder), expected: &[] },
    Row { name: "saddle", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: false, engine: Once(surface::saddle), expected: &[] },
    Row { name: "torus", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: true, engine: Once(surface::torus), expected: &[] },
    Row { name: "torus, metric", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: false, engine: Once(surface::torus_metric), expected: &[] },
    Row { name: "ellipsoid", holds: "H and K are the shape's", bounds: &[("r|dH| p99", 1e-2), ("r|dH| rim p99", 0.1), ("r^2|dK| p99", 2e-2)], quick: false, engine: Once(surface::ellipsoid), expected: &[] },
    Row { name: "field of view 1 .. 170 degrees, parallel", holds: "the bound on H", bounds: &[("|H r - 1| p99", 1e-2)], quick: false, engine: Once(surface::fields), expected: &[] },
    Row { name: "near and far 1e8 apart", holds: "the bound on H, near and far", bounds: &[("|H r - 1| p99", 1e-2)], quick: false, engine: Once(surface::range), expected: &[] },
    Row { name: "object a fifth .. 100 screens", holds: "H on average", bounds: &[("|mean H r - 1|", 1e-2)], quick: false, engine: Once(surface::distances), expected: &[] },
    Row { name: "normals in 8, 10, 16 bit", holds: "noise in H goes as q / 2s", bounds: &[("metric: spread", 1.25), ("fit: spread", 1.25)], quick: true, engine: Once(surface::formats), expected: &[] },
    Row { name: "16-bit normals, levels, halves", holds: "half a step of the format", bounds: &[("oct-16: angle, rad", 6.48e-5), ("level: |dn|", 1.53e-5), ("level: dH, relative", 4.9e-4), ("light: relative", 4.9e-4)], quick: true, engine: Once(surface::storage), expected: &[] },
    Row { name: "curvature in f32 and f64", holds: "|dH| q", bounds: &[("vergne", 1e-4), ("trace", 1e-6), ("metric", 1e-6), ("fit", 1e-6)], quick: true, engine: Once(surface::precision), expected: &[] },
    Row { name: "levels and light of pdss in f32 and f64", holds: "the device is the twins", bounds: &[("soft normal p99", 2e-4), ("soft H length p99", 2e-4), ("exitance p99", 5e-4), ("ambient p99", 1e-4)], quick: true, engine: Once(twins::pdss), expected: &[] },
    Row { name: "levels and light of moments in f32 and f64", holds: "the device is the twins", bounds: &[("soft normal p99", 2e-4), ("soft H length p99", 2e-4), ("exitance p99", 5e-4), ("ambient p99", 1e-4)], quick: true, engine: Once(twins::moments), expected: &[] },
    Row { name: "light gathered by moments in f32 and f64", holds: "the device is the twins", bounds: &[("gathered light p99", 5e-5), ("kept texels that differ", 0.)], quick: true, engine: Once(gathered::moments), expected: &[] },
    // Pre-integration.
    Row { name: "sphere, k = 1e-8 .. 1e14", holds: "D in 0..1, rises with mu, keeps energy", bounds: &[("outside 0..1", 1e-12), ("falls with mu by", 1e-12), ("|2 int D dmu - 1|", 1e-6), ("|D - quadrature|", 1e-7)], quick: true, engine: Once(integral::gaussian), expected: &[] },
    Row { name: "sphere, Burley, as stiff", holds: "D in 0..1, rises with mu, keeps energy", bounds: &[("outside 0..1", 1e-10), ("falls with mu by", 1e-10), ("|2 int D dmu - 1|", 1e-6)], quick: false, engine: Once(integral::burley), expected: &[] },
    Row { name: "ring, k = 1e-8 .. 1e14", holds: "D in 0..1, rises with mu, keeps a ring's energy", bounds: &[("outside 0..1", 1e-12), ("falls with mu by", 1e-12), ("|int D dtheta / 2 - 1|", 1e-6)], quick: false, engine: Once(integral::ring), expected: &[] },
    Row { name: "closed form, s = 1e-14 .. 100", holds: "keeps energy; the shader's cubic is it", bounds: &[("odd part / s", 1e-12), ("fast - exact / s", 3e-5)], quick: true, engine: Once(integral::rectified), expected: &[] },
    Row { name: "table on the device, r = 1e-3 .. 1e6 mm", holds: "D of the integral", bounds: &[("wax: |table - D|", 1e-3), ("skin: |table - D|", 1e-3)], quick: true, engine: Once(integral::table), expected: &[] },
    Row { name: "table, energy", holds: "what sampling it adds", bounds: &[("|2 int D dmu - 1|", 1e-3)], quick: true, engine: Once(integral::table_energy), expected: &[] },
    Row { name: "weights of a profile", holds: "sum to 1", bounds: &[("|sum of weights - 1|", 1e-6)], quick: false, engine: Once(integral::weights), expected: &[] },
    // Sizes.
    Row { name: "scene and profile x 1e-4, 1e4", holds: "the same picture", bounds: &[("p99", 1e-3)], quick: false, engine: Each(size::scaled), expected: &[] },
    Row { name: "radius 0 and 1e-9", holds: "the bits of lambert", bounds: &[("pixels that differ", 0.)], quick: true, engine: Scattering(size::radius_zero), expected: &[] },
    Row { name: "object a pixel large; radius below one", holds: "the bits of lambert", bounds: &[("pixels that differ", 0.)], quick: false, engine: Scattering(size::far), expected: &[] },
    Row { name: "object 100 times the screen", holds: "exitance is the cosine", bounds: &[("median |E - mu|", 5e-3)], quick: false, engine: Scattering(size::near), expected: &[] },
    Row { name: "channels 1 : 1e4 apart", holds: "the narrow one is lambert", bounds: &[("blue - lambert p99", 4e-3), ("outside 0..1.4", 2e-3)], quick: false, engine: Scattering(size::channels), expected: &[] },
    Row { name: "radius beyond object and screen", holds: "an even glow of 1/4", bounds: &[("outside 0..1", 1e-3), ("|E - 1/4| median", 0.05)], quick: false, engine: Scattering(size::wide), expected: GLOW },
    Row { name: "1x1, rows, columns, odd, 8192 wide", holds: "within 0..1, something lit", bounds: &[("outside 0..1", 0.)], quick: false, engine: Each(size::sizes), expected: &[] },
    Row { name: "a crop", holds: "equals the whole's crop", bounds: &[("p99", 1e-4)], quick: false, engine: Each(size::crops), expected: QUADS },
    Row { name: "eye moves by parts of a pixel", holds: "flicker, rms", bounds: &[("full", 1e-3), ("half", 3e-3), ("quarter", 3e-3)], quick: false, engine: Scattering(size::motion), expected: &[] },
    // Materials and meshes.
    Row { name: "albedo 0 and 1, metal, under a white sky", holds: "white stays white, black is gloss", bounds: &[("albedo 1: |L - 1|", 5e-3), ("metal: |L - 1|", 5e-3), ("albedo 0: - gloss", 1e-3)], quick: false, engine: Each(material::furnace), expected: METAL },
    Row { name: "scatter mask 0", holds: "the bits of lambert", bounds: &[("pixels that differ", 0.)], quick: true, engine: Scattering(material::mask_zero), expected: &[] },
    Row { name: "strong normal map, grazing view", holds: "H bounded, light evened out", bounds: &[("outside 0..1", 0.), ("|H| q", 0.5001), ("roughness / lambert's", 1.)], quick: false, engine: Scattering(material::normal_map), expected: BUMPS },
    Row { name: "smooth normals on eight sides", holds: "H bounded by the footprint", bounds: &[("|H| q", 0.5001), ("outside 0..1", 0.)], quick: false, engine: Scattering(material::smooth_prism), expected: &[] },
    Row { name: "flat normals on eight sides", holds: "H bounded by the footprint", bounds: &[("|H| q", 0.5001), ("outside 0..1", 0.)], quick: false, engine: Scattering(material::flat_prism), expected: &[] },
    Row { name: "flat-shaded torus", holds: "H bounded by the footprint", bounds: &[("|H| q", 0.5001), ("outside 0..1", 0.)], quick: false, engine: Scattering(material::flat_torus), expected: &[] },
    // Files.
    Row { name: "broken normals and triangles", holds: "repaired, said once", bounds: &[("repairs not said once", 0.), ("picture p99", 2e-3)], quick: false, engine: Scattering(file::damage), expected: &[] },
    Row { name: "no normals, no UVs, no indices", holds: "the picture with them", bounds: &[("no normals p99", 5e-3), ("no indices p99", 1e-4)], quick: false, engine: Scattering(file::missing), expected: &[] },
    Row { name: "node scale uneven, negative, zero", holds: "normals and picture", bounds: &[("2, .5, .001: normal, rad", 1e-3), ("mirrored p99", 5e-3), ("zero: pixels out of 0..1", 0.)], quick: false, engine: Scattering(file::scales), expected: &[] },
    Row { name: "1e-4 .. 1e4 m a unit", holds: "the same picture at one real size", bounds: &[("p99", 1e-3)], quick: false, engine: Scattering(file::units), expected: &[] },
    Row { name: "0, 1, 2, 65535, 70000 vertices", holds: "drawn, or refused in a line", bounds: &[("counts gone wrong", 0.)], quick: true, engine: Once(file::vertices), expected: &[] },
    Row { name: "10000 nodes", holds: "one mesh of as many, to a step of a half", bounds: &[("largest difference", 5e-4)], quick: false, engine: Each(file::nodes), expected: &[] },
    // Lights.
    Row { name: "light inside the mesh", holds: "dark outside", bounds: &[("largest exitance", 1e-3)], quick: false, engine: Each(lighting::inside), expected: INSIDE },
    Row { name: "light behind", holds: "dark in the middle", bounds: &[("45 degrees away", 1e-3), ("outside 0..1", 1e-3)], quick: false, engine: Each(lighting::behind), expected: &[] },
    Row { name: "light of 1e6", holds: "1e6 times that of 1", bounds: &[("exitance", 2e-3), ("radiance", 2e-3)], quick: true, engine: Each(lighting::strong), expected: &[] },
    Row { name: "light on the surface", holds: "the light at 1 mm", bounds: &[("outside 0..1", 1e-3), ("not finite", 0.)], quick: false, engine: Each(lighting::touching), expected: &[] },
    Row { name: "no light; a sky alone", holds: "nothing; the sky", bounds: &[("without light", 0.), ("an even sky: off .3", 0.)], quick: false, engine: Each(lighting::dark), expected: &[] },
    Row { name: "1, 64, 128, 1000 lights", holds: "sums; a refusal with its limit", bounds: &[("64, 128 - 1", 2e-3), ("1000 not refused", 0.)], quick: false, engine: Each(lighting::many), expected: &[] },
    Row { name: "lights that share channels", holds: "the sum of each alone", bounds: &[("all - sum", 5e-4)], quick: true, engine: Once(lighting::shared), expected: &[] },
    // Edges.
    Row { name: "skin behind a card", holds: "no bleed over 60 mm", bounds: &[("behind lit", 1e-3), ("card lit", 1e-3)], quick: false, engine: Scattering(edge::card), expected: ALONE },
    Row { name: "bright background", holds: "no bleed from 60 mm behind", bounds: &[("largest change", 1e-3)], quick: false, engine: Scattering(edge::background), expected: &[] },
    Row { name: "two profiles touching", holds: "no bleed into the other", bounds: &[("bleed from another profile", 1e-3), ("bleed from what does not scatter", 1e-3)], quick: true, engine: Scattering(edge::touching), expected: &[] },
];
