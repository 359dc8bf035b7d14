//! Every image a stage writes: format, unit, range, space, who writes it, who reads it.

use ash::vk;

/// One line of the table.
#[derive(Debug)]
pub struct Target {
    /// Name in shaders, plans and views; numbered targets share the line of their stem.
    pub name: &'static str,
    /// Texel format.
    pub format: vk::Format,
    /// What a texel means, who writes and who reads it.
    pub meaning: &'static str,
}

/// The table.
#[rustfmt::skip]
pub const TARGETS: &[Target] = &[
    Target { name: "depth", format: vk::Format::D32_SFLOAT, meaning: "reversed infinite depth, 0 far. gbuffer tests and writes; nobody reads" },
    Target { name: "viewz", format: vk::Format::R32_SFLOAT, meaning: "distance along the view axis, mm; negated where the surface scatters; 0 background. gbuffer writes, every screen stage reads" },
    Target { name: "normal", format: vk::Format::R32_UINT, meaning: "unit normal, unbumped, view space, towards the eye, octahedral 2 x snorm16. gbuffer writes; curvature, blur, light read" },
    Target { name: "bumped", format: vk::Format::R32_UINT, meaning: "unit normal with the normal map, view space, octahedral 2 x snorm16. gbuffer writes; blur, light read" },
    Target { name: "albedo", format: vk::Format::R8G8B8A8_UNORM, meaning: "rgb: square root of linear base colour, 0..1; a: share that scatters, 0..1, above 0 where the material has the profile, whose gloss it then has. gbuffer writes, light reads" },
    Target { name: "material", format: vk::Format::R8G8B8A8_UNORM, meaning: "r perceptual roughness, g metallic, b occlusion, a square root of F0. gbuffer writes, light reads" },
    Target { name: "coat", format: vk::Format::R32G32_UINT, meaning: "x: coat's share 6 bits, its roughness 6, tint of F0 5 5 5, F90 5; y: square root of sheen 6 6 6, its roughness 6, square root of thickness over the frame's most 8. gbuffer writes; light, irradiance, combine, transmittance read" },
    Target { name: "curvature", format: vk::Format::R32G32_UINT, meaning: "x: H in 1/mm as f32 bits, convex > 0; y: half sign(K) sqrt|K| times the pixel's footprint, half confidence 0..1. curvature writes; blur, light (wrap) read" },
    Target { name: "mass", format: vk::Format::A2B10G10R10_UNORM_PACK32, meaning: "half the reciprocal of the kernel's mass for each gathered level, 0..1. gbuffer writes; translucent, light read" },
    Target { name: "facet", format: vk::Format::R32_UINT, meaning: "normal of the triangle itself, view space, octahedral, 2 x snorm16, in the lowest five bits of each how far the surface rises above it (common/facet_code.glsl). gbuffer writes, what asks shadow maps reads" },
    Target { name: "lit", format: vk::Format::R32_UINT, meaning: "clamped cosine times visibility of two lights, 0..1, 2 x unorm16. visibility writes; blur, light read" },
    Target { name: "soft", format: vk::Format::R32G32_UINT, meaning: "blurred level: un-normalised mean normal, view space, 3 x snorm16; H times the profile's length, half. blur writes and reads, light reads" },
    Target { name: "litgeo", format: vk::Format::R32_UINT, meaning: "`lit` by the triangles' own normals, 2 x unorm16. visibility writes, blur reads" },
    Target { name: "softgeo", format: vk::Format::R32_UINT, meaning: "blurred `litgeo` of two lights, 2 x unorm16. blur writes and reads, translucent reads" },
    Target { name: "softlit", format: vk::Format::R32_UINT, meaning: "blurred `lit` of two lights, 2 x unorm16; of wide levels, where light is gathered, that of seen and hidden surface, over mass. blur writes and reads, translucent reads and writes, light reads" },
    Target { name: "irradiance", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "diffuse light before it scatters, linear Rec. 709, in units of light_unit, E n.l with shadows; times the square root of base colour where texturing is pre-post. irradiance writes, transmittance adds to it; gaussians, separable, burley, combine read" },
    Target { name: "reflected", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "specular radiance, in units of light_unit. irradiance writes, combine reads" },
    Target { name: "across", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "light blurred along rows. gaussians, separable write and read" },
    Target { name: "down", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "light blurred along rows and columns, one Gaussian. gaussians writes and reads" },
    Target { name: "scattered", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "diffuse light after it scattered. gaussians, separable, burley or gather writes, combine reads" },
    Target { name: "chart", format: vk::Format::R32_UINT, meaning: "texture coordinate, 2 x unorm16. gbuffer writes, gather reads" },
    Target { name: "sheet", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "irradiance over texture coordinates, linear Rec. 709, sheet 0 before it scatters, each later one after a Gaussian more; a: number of the chart, 0 none. unwrap and sheets write; sheets, gather read" },
    Target { name: "sheetacross", format: vk::Format::R16G16B16A16_SFLOAT, meaning: "a sheet between the two passes of a pair. sheets writes and reads" },
    Target { name: "stretch", format: vk::Format::R32_UINT, meaning: "texels a mm along u and v, 2 halves, blurred as the sheets are. unwrap and sheets write, sheets reads" },
    Target { name: "stretchacross", format: vk::Format::R32_UINT, meaning: "stretch between the two passes of a pair. sheets writes and reads" },
    Target { name: "exr", format: vk::Format::R32G32B32A32_SFLOAT, meaning: "radiance, linear Rec. 709, or a view; a coverage. light or view writes, overlay draws over, tonemap or the host reads" },
    Target { name: "ldr", format: vk::Format::R8G8B8A8_UNORM, meaning: "tone-mapped, sRGB-encoded picture; a coverage. light or tonemap writes, the host reads" },
    Target { name: "shadow", format: vk::Format::D32_SFLOAT, meaning: "depth from each light, reversed, one layer a light (six a point light). shadow writes; visibility, light sample" },
    Target { name: "inert", format: vk::Format::D32_SFLOAT, meaning: "depth of what does not scatter, in the texels of `shadow` that `sparse` keeps. inert writes, sparse samples" },
    Target { name: "sparse", format: vk::Format::R32_SFLOAT, meaning: "every so many-th texel of `shadow`, a layer a light with a slot; 0 where it is of what does not scatter. sparse writes, translucent reads" },
    Target { name: "entrance", format: vk::Format::R32_UINT, meaning: "texture coordinate of what each light meets first, 2 x unorm16, layers as `shadow`; all bits set where it does not scatter. entrance writes, gather reads" },
];

/// The line of a target; numbers at the end of a name do not matter.
pub fn describe(name: &str) -> Option<&'static Target> {
    let stem = name.split('@').next().unwrap_or(name).trim_end_matches(|c: char| c.is_ascii_digit());
    TARGETS.iter().find(|t| t.name == stem)
}
