//! What the kernels are written with: single numbers, in loops over lanes without branches or calls, which the compiler turns
//! into vectors. No `map` and no closures: they are not always compiled into the loop, and then there is no vector.

use std::f32::consts::LN_2;

/// Pixels that go through a kernel together.
pub const LANES: usize = 16;
/// A number a lane.
pub type Lanes = [f32; LANES];

/// 2^x for |x| < 126, relative error below 3e-7.
#[inline(always)]
pub fn exp2(x: f32) -> f32 {
    const MAGIC: f32 = 12_582_912.; // 1.5 * 2^23: adding it rounds to whole numbers
    let t = x + MAGIC;
    let f = x - (t - MAGIC);
    let p = 1. + f * (LN_2 + f * (0.240_226_5 + f * (0.055_504_11 + f * (0.009_618_13 + f * 0.001_333_56))));
    p * f32::from_bits((t.to_bits() << 23).wrapping_add(0x3f80_0000))
}

/// Binary logarithm of a normal number above 0, error below 1e-6.
#[inline(always)]
pub fn log2(x: f32) -> f32 {
    let bits = x.to_bits();
    let e = (bits.wrapping_sub(0x3f35_04f3) as i32) >> 23;
    let m = f32::from_bits(bits.wrapping_sub((e << 23) as u32));
    let t = (m - 1.) / (m + 1.);
    let s = t * t;
    e as f32 + t * (2.885_39 + s * (0.961_796_7 + s * (0.577_078 + s * 0.412_198_6)))
}

/// A finite half from its bits.
#[inline(always)]
pub fn half(bits: u32) -> f32 {
    let magnitude = f32::from_bits((bits & 0x7fff) << 13) * f32::from_bits(0x7780_0000); // 2^112
    f32::from_bits(magnitude.to_bits() | (bits & 0x8000) << 16)
}

/// Bits of the nearest half of a number that is not beyond the largest one.
#[inline(always)]
pub fn to_half(x: f32) -> u32 {
    let b = (x.abs() * f32::from_bits(0x0780_0000)).to_bits(); // 2^-112
    (b + 0xfff + (b >> 13 & 1)) >> 13 | (x.to_bits() >> 16 & 0x8000)
}

/// The two signed coordinates of a word, in whole steps.
#[inline(always)]
pub fn steps(code: u32) -> [f32; 2] {
    [((code as i32) << 16 >> 16) as f32, ((code as i32) >> 16) as f32]
}

/// Two unorm16.
#[inline(always)]
pub fn unorm(code: u32) -> [f32; 2] {
    [(code & 0xffff) as i32 as f32 * (1. / 65535.), (code >> 16) as i32 as f32 * (1. / 65535.)]
}

/// A coordinate of -1..1 as snorm16.
#[inline(always)]
pub fn to_snorm(x: f32) -> u32 {
    const MAGIC: f32 = 12_582_912.;
    (x.clamp(-1., 1.) * 32767. + MAGIC).to_bits() & 0xffff
}

/// A number of 0..1 as unorm of `most` steps.
#[inline(always)]
pub fn to_unorm(x: f32, most: f32) -> u32 {
    const MAGIC: f32 = 8_388_608.; // 2^23
    (x.clamp(0., 1.) * most + MAGIC).to_bits() & 0xffff
}

/// Unit normal of an octahedral code, as `whole_normal` in `curvature.comp` has it.
#[inline(always)]
pub fn normal(code: u32) -> [f32; 3] {
    let [x, y] = steps(code);
    let z = 32767. - x.abs() - y.abs();
    let fold = (-z).max(0.);
    let x = x - if x >= 0. { fold } else { -fold };
    let y = y - if y >= 0. { fold } else { -fold };
    let r = 1. / (x * x + y * y + z * z).sqrt();
    [x * r, y * r, z * r]
}

/// Un-normalised normal of a level, and its curvature in units of the profile.
#[inline(always)]
pub fn level(code: [u32; 2]) -> ([f32; 3], f32) {
    let ([x, y], z) = (steps(code[0]), steps(code[1])[0]);
    let n = [(x * (1. / 32767.)).max(-1.), (y * (1. / 32767.)).max(-1.), (z * (1. / 32767.)).max(-1.)];
    (n, half(code[1] >> 16))
}

#[inline(always)]
pub fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub fn unit(a: [f32; 3]) -> [f32; 3] {
    scaled(a, 1. / dot(a, a).sqrt())
}

#[inline(always)]
pub fn scaled(a: [f32; 3], s: f32) -> [f32; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// The sum of `a` and `b` times `s`.
#[inline(always)]
pub fn along(a: [f32; 3], b: [f32; 3], s: f32) -> [f32; 3] {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s]
}

/// Compiles `$name` once more for the vectors that the driver's compiler has, and takes that where the processor has them.
#[macro_export]
macro_rules! vectorised {
    ($name:ident => $body:ident ( $($argument:ident : $kind:ty),* $(,)? )) => {
        pub fn $name($($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma")]
                fn wide($($argument: $kind),*) {
                    $body($($argument),*);
                }
                if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                    // SAFETY: the processor has just been asked.
                    unsafe { wide($($argument),*) };
                    return;
                }
            }
            $body($($argument),*);
        }
    };
}
