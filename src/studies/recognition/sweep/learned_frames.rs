//! Numbers of frames on which learned ensembles and image features are fitted.

/// Returns the maximum number of training touches of F frames on which ensembles and image estimators are fitted.
pub(crate) fn learned_touches(n_frames: usize) -> usize {
    LEARNED_FRAMES.div_ceil(n_frames.max(1))
}

/// Maximum number of frames on which image estimators are fitted. With fewer frames than components, the estimate is underdetermined; with more frames, fitting
/// takes longer.
pub const LEARNED_FRAMES: usize = 4096;

/// Approximate number of frames including copies, if there are fewer than [`LEARNED_FRAMES`]; a copy adds less information than a new frame. With 880 frames of
/// a real skin and block averages at 16:1, for example, the accuracy is 0.922 with half as many copies and 0.930 with this number. Twice as many copies give
/// the same accuracy and take twice as long.
pub const WITH_COPIES: usize = 2 * LEARNED_FRAMES;
