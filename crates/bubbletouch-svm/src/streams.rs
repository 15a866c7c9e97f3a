//! Named random streams; separate streams for each class or tree make its draws independent of other models.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Name of a random stream, extended by words and numbers, such as `tree 3 rows`. Functions take `&dyn Streams`, so that training is compiled once for every
/// type of name.
pub trait Streams {
    /// Returns the name of the stream with this word appended.
    fn named(&self, word: &str) -> Box<dyn Streams>;

    /// Returns the name of the stream with this number appended.
    fn numbered(&self, number: u64) -> Box<dyn Streams>;

    /// Returns a new random generator for this stream.
    fn rng(&self) -> ChaCha8Rng;
}

/// Random streams of a numeric seed: words and numbers are hashed into the seed (FNV-1a).
impl Streams for u64 {
    fn named(&self, word: &str) -> Box<dyn Streams> {
        Box::new(hash(*self, word.as_bytes()))
    }

    fn numbered(&self, number: u64) -> Box<dyn Streams> {
        Box::new(hash(*self, &number.to_le_bytes()))
    }

    fn rng(&self) -> ChaCha8Rng {
        ChaCha8Rng::seed_from_u64(*self)
    }
}

fn hash(seed: u64, bytes: &[u8]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    bytes.iter().fold(seed ^ 0xcbf2_9ce4_8422_2325, step)
}
