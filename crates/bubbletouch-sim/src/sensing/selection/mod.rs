//! Selection of the m taxels to read among n taxels, on frames of training touches.
//!
//! | method | taxels | uses labels |
//! |---|---|---|
//! | [`Greedy`](Selection::Greedy) | one after the other, each with the highest validation accuracy together with the earlier taxels | yes |
//! | [`PivotedQr`](Selection::PivotedQr) | the first m pivots of a QR factorisation of m principal components | no |
//! | [`Random`](Selection::Random) | drawn without replacement, as by the ensemble `subsample` | no |

mod greedy;

pub(super) use greedy::greedy_taxels;

use serde::{Deserialize, Serialize};

/// Method that selects the taxels to read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Selection {
    /// Forward selection. Each step adds the taxel with which a nearest-neighbour classifier recognises most training touches. Each touch is compared with the
    /// touches of other groups.
    #[default]
    Greedy,
    /// QR factorisation with column pivoting of the first m principal components of the training frames. From readings of the pivots, the components are
    /// reconstructed with little amplification of noise. Manohar et al. (2018), *Data-driven sparse sensor placement for reconstruction*, IEEE Control Systems
    /// 38, 63.
    PivotedQr,
    /// Random taxels; a control for the other methods.
    Random,
}

impl Selection {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::Greedy, Self::PivotedQr, Self::Random];

    /// Names of the methods in the file of a study, with their display names.
    pub const NAMES: &[(&str, &str)] = &[
        ("greedy", "greedy"),
        ("pivoted_qr", "pivoted QR"),
        ("random", "random"),
    ];
}
