//! Instruction sets, chosen once at run time: one source, three compilations.
//!
//! A kernel is plain scalar code over slices, marked `#[inline(always)]` and wrapped in a [`Vectorized`] value. [`Isa::run`]
//! compiles it once per tier, and the compiler vectorizes each copy. Rust never fuses `a * b + c`, so every tier gives the same
//! bits.
//!
//! No other module of the engine holds `unsafe` code, except to call into another language: OpenImageIO, a browser, the C library.
#![allow(unsafe_code)]

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU8, Ordering::Relaxed};

/// An instruction-set tier that kernels are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Isa {
    /// Instructions that every machine of the target architecture has (x86-64: SSE2).
    Baseline,
    /// Vectors of 256 bits (x86-64: AVX2).
    Avx2,
    /// Vectors of 512 bits (x86-64: AVX-512).
    Avx512,
}

/// Work that [`Isa::run`] compiles for each tier. `run` and everything it calls must be `#[inline(always)]`, or it is compiled
/// for the baseline only.
pub trait Vectorized {
    /// Result of the work.
    type Output;
    /// Does the work and returns its result.
    fn run(self) -> Self::Output;
}

/// The widest tier that this process may use, as a number; [`UNLIMITED`] until [`Isa::limit`] is called.
static LIMIT: AtomicU8 = AtomicU8::new(UNLIMITED);
const UNLIMITED: u8 = u8::MAX;

/// The reason why a tier of instructions cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum IsaError {
    /// No tier has this name.
    Unknown(String),
    /// This machine lacks the tier.
    Missing {
        /// The tier that was asked for.
        asked: Isa,
        /// The widest tier of this machine.
        widest: Isa,
    },
}

impl std::fmt::Display for IsaError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unknown(name) => write!(f, "`{name}` is not an instruction set; known: baseline, avx2, avx512"),
            Self::Missing { asked, widest } => {
                write!(f, "this machine does not have `{}`; its widest is {}", asked.name(), widest.name())
            }
        }
    }
}

impl std::error::Error for IsaError {}

impl Isa {
    /// Returns the widest tier that this machine has and this process may use; see [`Isa::limit`].
    #[must_use]
    pub fn detect() -> Self {
        Self::Avx512.allowed()
    }

    /// Limits this process: from now on nothing runs on a wider tier, whatever tier its code asks for. The command calls this
    /// once, at its start, with what `SPECTRA_ISA` says.
    pub fn limit(self) {
        LIMIT.store(self as u8, Relaxed);
    }

    /// Returns this tier, or the widest narrower one that the machine has and the process may use.
    #[inline]
    #[must_use]
    pub fn allowed(self) -> Self {
        static MACHINE: OnceLock<Isa> = OnceLock::new();
        let widest = (*MACHINE.get_or_init(Isa::of_machine)).min(self);
        match LIMIT.load(Relaxed) {
            limit if limit >= widest as u8 => widest,
            0 => Self::Baseline,
            _ => Self::Avx2,
        }
    }

    /// Returns the widest tier that the machine has.
    fn of_machine() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f")
                && std::arch::is_x86_feature_detected!("avx512dq")
                && std::arch::is_x86_feature_detected!("avx512vl")
                && std::arch::is_x86_feature_detected!("avx512bw")
            {
                return Self::Avx512;
            }
            if std::arch::is_x86_feature_detected!("avx2") {
                return Self::Avx2;
            }
        }
        Self::Baseline
    }

    /// Returns the tier of this name: `baseline`, `avx2` or `avx512`, as in `SPECTRA_ISA`.
    ///
    /// # Errors
    /// Returns [`IsaError`] if the name is unknown, or if this machine lacks that tier.
    pub fn by_name(name: &str) -> Result<Self, IsaError> {
        let isa = match name {
            "baseline" => Self::Baseline,
            "avx2" => Self::Avx2,
            "avx512" => Self::Avx512,
            _ => return Err(IsaError::Unknown(name.to_owned())),
        };
        let widest = Self::of_machine();
        if isa > widest {
            return Err(IsaError::Missing { asked: isa, widest });
        }
        Ok(isa)
    }

    /// Name of the tier, as [`Isa::by_name`] reads it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    /// Lists all tiers that this machine has and this process may use, narrowest first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|isa| *isa <= Self::detect()).collect()
    }

    /// Runs `work`, compiled for this tier.
    #[inline]
    pub fn run<V: Vectorized>(self, work: V) -> V::Output {
        #[cfg(target_arch = "x86_64")]
        match self.allowed() {
            // SAFETY: `allowed` gives only tiers whose features the machine has.
            Self::Avx512 => return unsafe { run_avx512(work) },
            // SAFETY: as above.
            Self::Avx2 => return unsafe { run_avx2(work) },
            Self::Baseline => {}
        }
        work.run()
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn run_avx2<V: Vectorized>(work: V) -> V::Output {
    work.run()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw")]
fn run_avx512<V: Vectorized>(work: V) -> V::Output {
    work.run()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Sum<'a>(&'a [f64]);
    impl Vectorized for Sum<'_> {
        type Output = f64;
        #[inline(always)]
        fn run(self) -> f64 {
            self.0.iter().map(|v| v.sqrt() / (1.0 + v)).sum()
        }
    }

    #[test]
    fn every_tier_gives_the_same_bits() {
        let values: Vec<f64> = (0..1000).map(|i| f64::from(i) * 0.37).collect();
        let want = Isa::Baseline.run(Sum(&values)).to_bits();
        for isa in Isa::available() {
            assert_eq!(isa.run(Sum(&values)).to_bits(), want, "{}", isa.name());
        }
    }

    #[test]
    fn unknown_tier_is_refused() {
        assert!(Isa::by_name("sse9").is_err());
        assert_eq!(Isa::by_name("baseline"), Ok(Isa::Baseline));
    }
}
