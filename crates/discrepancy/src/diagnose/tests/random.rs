//! Seeded noise: SplitMix64 (Steele, Lea and Flood 2014) and the method of Box and Muller.

pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }

    /// First-order autoregression of unit variance, in its stationary state from the start.
    pub fn coloured(&mut self, samples: usize, colour: f64) -> Vec<f64> {
        let fresh = (1.0 - colour * colour).sqrt();
        let mut state = self.normal();
        (0..samples)
            .map(|_| {
                let now = state;
                state = colour * state + fresh * self.normal();
                now
            })
            .collect()
    }
}
