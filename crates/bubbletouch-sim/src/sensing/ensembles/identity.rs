//! Identity ensemble: the frame itself, for any m.

use super::ensemble::EnsembleAbout;
use super::subsample::Taxels;

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    is_whole_frame: true,
    ..EnsembleAbout::new("identity", |(ny, nx), _, _| {
        Box::new(Taxels((0..ny * nx).collect()))
    })
};
