//! Lanes in the registers of the processor at hand, chosen at run time, or without its help.

mod portable;
#[cfg(target_arch = "x86_64")]
mod wide;

use super::lanes::Vectorised;
use portable::Eight;

/// Which instructions of the processor are used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// What every processor has.
    Portable,
    /// Vectors of four doubles, on x86-64.
    Avx2,
    /// Vectors of eight doubles, on x86-64.
    Avx512,
}

impl Instructions {
    /// All, the best last.
    pub const ALL: [Instructions; 3] = [Instructions::Portable, Instructions::Avx2, Instructions::Avx512];

    /// The best of what the processor at hand has.
    pub fn detect() -> Self {
        let best = Self::ALL.into_iter().rev().find(|instructions| instructions.available());
        best.unwrap_or(Instructions::Portable)
    }

    /// Whether the processor at hand has them.
    pub fn available(self) -> bool {
        match self {
            Instructions::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 => wide::Four::new().is_some(),
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 => wide::Eight::new().is_some(),
            #[cfg(not(target_arch = "x86_64"))]
            Instructions::Avx2 | Instructions::Avx512 => false,
        }
    }

    /// Runs some work with these instructions, or without them where the processor does not have them.
    pub fn run<W: Vectorised>(self, work: W) -> W::Output {
        #[cfg(target_arch = "x86_64")]
        match self {
            Instructions::Portable => {}
            Instructions::Avx2 => {
                if let Some(registers) = wide::Four::new() {
                    return wide::run(registers, work);
                }
            }
            Instructions::Avx512 => {
                if let Some(registers) = wide::Eight::new() {
                    return wide::run(registers, work);
                }
            }
        }
        work.run(Eight::default())
    }
}
