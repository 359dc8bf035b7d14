//! Numbers that look random and are the same every time.

/// A well-mixed word from two (the finaliser of SplitMix64, Steele, Lea & Flood 2014).
pub fn hash(a: u64, b: u64) -> u64 {
    let mut z = a.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(b.wrapping_mul(0xd1b5_4a32_d192_ed03));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A word as a number 0..1, 1 excluded.
pub fn unit(word: u64) -> f64 {
    (word >> 11) as f64 / (1u64 << 53) as f64
}

/// A low-discrepancy sequence over the unit square, shifted at random (Roberts 2018; Cranley & Patterson 1976).
#[derive(Clone, Copy, Debug)]
pub struct Shift([f64; 2]);

impl Shift {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self([unit(hash(seed, 1)), unit(hash(seed, 2))])
    }

    /// The i-th point; each axis 0..1.
    pub fn point(&self, i: usize) -> [f64; 2] {
        // Powers of the inverse of the plastic number, the root of x^3 = x + 1.
        const STEP: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
        std::array::from_fn(|k| (self.0[k] + STEP[k] * i as f64).fract())
    }

    /// The i-th of n points of a lattice: evenly spaced along the first axis, by the golden ratio along the second.
    pub fn lattice(&self, i: usize, n: usize) -> [f64; 2] {
        let along = ((i as f64 + self.0[0]) / n as f64).fract();
        [along, (self.0[1] + 0.618_033_988_749_894_9 * i as f64).fract()]
    }
}
