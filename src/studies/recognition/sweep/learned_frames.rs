//! Numbers of training frames to which learned ensembles and image features are fitted.

/// Returns the maximum number of training touches with `n_frames` frames each to which ensembles and image estimators are fitted.
pub(crate) fn learned_touches(n_frames: usize) -> usize {
    LEARNED_FRAMES.div_ceil(n_frames.max(1))
}

/// Maximum number of frames to which image estimators are fitted. With fewer frames than components, the estimate is underdetermined; with more frames, fitting
/// takes longer.
pub const LEARNED_FRAMES: usize = 4096;

/// Approximate number of frames, including shifted copies, to which image estimators are fitted if there are fewer than [`LEARNED_FRAMES`] frames. A copy adds
/// less information than a new frame. For example, 880 frames of a real skin and block averages at 16:1 give an accuracy of 0.930. With half as many copies,
/// the accuracy is 0.922. Twice as many copies give the same accuracy and take twice as long.
pub const WITH_COPIES: usize = 2 * LEARNED_FRAMES;
