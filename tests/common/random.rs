//! Numbers that look random and are the same in every run, for tests that shoot rays.

use rastray::math::DVec3;

/// Numbers in -1..1 (splitmix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// The next number.
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Three numbers.
    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next())
    }

    /// A unit vector.
    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let d = self.vector();
            if d.length() < 1.0 && d.length() > 0.1 {
                return d.normalize();
            }
        }
    }
}
