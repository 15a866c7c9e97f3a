//! Choice of the vector instructions of the press kernels.

use serde::{Deserialize, Serialize};
use std::sync::OnceLock;

/// Vector instructions of x86-64; other processors have only their baseline. All choices give bitwise equal results, because no operations are fused. Choices
/// other than the best serve comparisons.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Instructions {
    /// Best instruction set that the processor supports.
    #[default]
    Best,
    /// Instruction set that every processor of the compilation target supports.
    Baseline,
    /// AVX2 instructions with vectors of 256 bits.
    Avx2,
    /// AVX-512 instructions (F, BW, DQ and VL) with vectors of 512 bits.
    Avx512,
}

impl Instructions {
    /// Returns the instruction sets that this processor supports, the best one last.
    pub fn here() -> &'static [Self] {
        static HERE: OnceLock<Vec<Instructions>> = OnceLock::new();
        HERE.get_or_init(|| [vec![Self::Baseline], Self::beyond_baseline()].concat())
    }

    #[cfg(target_arch = "x86_64")]
    fn beyond_baseline() -> Vec<Self> {
        use std::arch::is_x86_feature_detected as has;
        let has_256 = has!("avx2") && has!("fma");
        let has_512 = has!("avx512f") && has!("avx512bw") && has!("avx512dq") && has!("avx512vl");
        match (has_256, has_512) {
            (false, _) => Vec::new(),
            (true, false) => vec![Self::Avx2],
            (true, true) => vec![Self::Avx2, Self::Avx512],
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn beyond_baseline() -> Vec<Self> {
        Vec::new()
    }

    /// Returns this instruction set if it is supported and not `Best`, otherwise the best supported instruction set.
    pub fn resolved(self) -> Self {
        let here = Self::here();
        match here.contains(&self) {
            true => self,
            false => here[here.len() - 1],
        }
    }
}

/// Defines a function that is compiled once per variant of [`Instructions`]; its first argument selects the variant. The shared body must be
/// `#[inline(always)]`, as must all functions that it calls.
macro_rules! for_instructions {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)? = $body:ident) => {
        $(#[$meta])*
        $vis fn $name(
            instructions: $crate::contact::Instructions,
            $($arg: $type),*
        ) $(-> $out)? {
            use $crate::contact::Instructions;

            #[multiversion::multiversion(targets(
                "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma"
            ))]
            fn avx512($($arg: $type),*) $(-> $out)? {
                $body($($arg),*)
            }

            #[multiversion::multiversion(targets("x86_64+avx2+fma"))]
            fn avx2($($arg: $type),*) $(-> $out)? {
                $body($($arg),*)
            }

            fn baseline($($arg: $type),*) $(-> $out)? {
                $body($($arg),*)
            }

            match instructions.resolved() {
                Instructions::Avx512 => avx512($($arg),*),
                Instructions::Avx2 => avx2($($arg),*),
                Instructions::Baseline | Instructions::Best => baseline($($arg),*),
            }
        }
    };
}
pub(crate) use for_instructions;
