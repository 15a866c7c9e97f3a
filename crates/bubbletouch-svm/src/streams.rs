//! Random numbers: one stream for each class, so that a class's solution does not depend on the other classes.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// A source of one random stream for each class.
pub trait Streams {
    /// Returns the generator of the stream of this class, at its start.
    fn of_class(&self, class: u64) -> ChaCha8Rng;
}

/// The streams of a seed: stream `class` of the ChaCha generator with this seed.
impl Streams for u64 {
    fn of_class(&self, class: u64) -> ChaCha8Rng {
        let mut rng = ChaCha8Rng::seed_from_u64(*self);
        rng.set_stream(class);
        rng
    }
}
