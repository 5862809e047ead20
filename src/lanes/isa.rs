//! The instruction set: found at run time, entered once per call, overridable for tests.

use fearless_simd::{Level, Simd};

use super::{Lanes, Real};

/// An instruction set that the lanes can be entered at. The bytes of a picture do not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// One lane, no vector instructions asked for.
    Scalar,
    /// x86-64 SSE4.2: 4 lanes of f32.
    Sse42,
    /// x86-64 AVX2 and FMA: 8 lanes of f32.
    Avx2,
    /// x86-64 AVX-512 (Ice Lake's set): 16 lanes of f32.
    Avx512,
    /// AArch64 NEON: 4 lanes of f32.
    Neon,
}

impl Isa {
    /// Every instruction set that is known, slowest first.
    pub const ALL: [Self; 5] = [
        Self::Scalar,
        Self::Sse42,
        Self::Avx2,
        Self::Avx512,
        Self::Neon,
    ];

    /// The best instruction set of this machine.
    ///
    /// ```
    /// use rastray::lanes::Isa;
    /// assert!(Isa::detect().is_available());
    /// assert_eq!(Isa::available().last(), Some(&Isa::detect()));
    /// ```
    pub fn detect() -> Self {
        let best = Self::ALL.into_iter().rev().find(|isa| isa.is_available());
        best.unwrap_or(Self::Scalar)
    }

    /// Every instruction set that this machine can run, slowest first.
    pub fn available() -> Vec<Self> {
        Self::ALL
            .into_iter()
            .filter(|isa| isa.is_available())
            .collect()
    }

    /// Whether this machine can run it. Asking for one that it cannot run is the caller's error: refuse it where the
    /// user names it; [`dispatch`] itself runs one lane instead, with the same bytes.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Sse42 => Level::new().as_sse4_2().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Level::new().as_avx2().is_some(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Level::new().as_avx512().is_some(),
            #[cfg(target_arch = "aarch64")]
            Self::Neon => Level::new().as_neon().is_some(),
            _ => false,
        }
    }

    /// The command line's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse42 => "sse4.2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// The instruction set of a name, whether or not this machine has it.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|isa| isa.name() == name)
    }
}

/// Work that is written over [`Lanes`] and entered at an instruction set.
pub trait Kernel<R: Real> {
    /// What it answers.
    type Output;
    /// Does the work. Must be `#[inline(always)]`, and so must all that it calls: only what is inlined into the entry
    /// is compiled for its instructions.
    fn run<L: Lanes<Scalar = R>>(self) -> Self::Output;
}

/// Runs a kernel at an instruction set; one lane where the machine lacks it.
#[inline]
pub fn dispatch<R: Real, K: Kernel<R>>(isa: Isa, kernel: K) -> K::Output {
    let level = Level::new();
    match isa {
        #[cfg(target_arch = "x86_64")]
        Isa::Avx512 => {
            if let Some(token) = level.as_avx512() {
                return token.vectorize(
                    #[inline(always)]
                    || kernel.run::<R::Avx512>(),
                );
            }
        }
        #[cfg(target_arch = "x86_64")]
        Isa::Avx2 => {
            if let Some(token) = level.as_avx2() {
                return token.vectorize(
                    #[inline(always)]
                    || kernel.run::<R::Avx2>(),
                );
            }
        }
        #[cfg(target_arch = "x86_64")]
        Isa::Sse42 => {
            if let Some(token) = level.as_sse4_2() {
                return token.vectorize(
                    #[inline(always)]
                    || kernel.run::<R::Sse42>(),
                );
            }
        }
        #[cfg(target_arch = "aarch64")]
        Isa::Neon => {
            if let Some(token) = level.as_neon() {
                return token.vectorize(
                    #[inline(always)]
                    || kernel.run::<R::Neon>(),
                );
            }
        }
        _ => {}
    }
    let _ = level;
    kernel.run::<R::Single>()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Width;
    impl<R: Real> Kernel<R> for (Width, R) {
        type Output = usize;
        fn run<L: Lanes<Scalar = R>>(self) -> usize {
            L::WIDTH
        }
    }

    #[test]
    fn every_entry_has_its_width() {
        for isa in Isa::available() {
            let expected = match isa {
                Isa::Scalar => 1,
                Isa::Sse42 | Isa::Neon => 4,
                Isa::Avx2 => 8,
                Isa::Avx512 => 16,
            };
            assert_eq!(dispatch(isa, (Width, 0.0f32)), expected);
            assert_eq!(dispatch(isa, (Width, 0.0f64)), expected.div_ceil(2));
        }
    }

    #[test]
    fn names_come_back() {
        for isa in Isa::ALL {
            assert_eq!(Isa::from_name(isa.name()), Some(isa));
        }
        assert_eq!(Isa::from_name("mmx"), None);
    }
}
