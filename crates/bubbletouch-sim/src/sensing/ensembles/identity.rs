//! Identity ensemble: the frame itself, for any m.

use super::ensemble::EnsembleAbout;
use super::subsample::Taxels;
use crate::world::ImageShape;

pub(crate) const ABOUT: EnsembleAbout = EnsembleAbout {
    is_whole_frame: true,
    ..EnsembleAbout::new("identity", |ImageShape { ny, nx }, _, _| {
        Box::new(Taxels((0..ny * nx).collect()))
    })
};
