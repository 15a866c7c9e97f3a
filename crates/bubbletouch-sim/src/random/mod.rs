//! Named random streams: one ChaCha stream per name, independent of the order of calls.
//!
//! A name is a path such as `(2018, "noise", "mug", 17)`. Its SHA-256 hash is the key of a ChaCha8 stream.
//! Any draw can therefore be made alone, on any thread or machine, with equal results.
//!
//! ```
//! use bubbletouch_sim::random::Seed;
//! use rand::Rng;
//!
//! let study = Seed::new(2018);
//! let a: f64 = study.named("noise").named("mug").numbered(17).rng().r#gen();
//! let b: f64 = study.named("noise").named("mug").numbered(17).rng().r#gen();
//! let c: f64 = study.named("noise").named("mug").numbered(18).rng().r#gen();
//! assert_eq!(a, b);
//! assert_ne!(a, c);
//! ```

mod counter;

pub use counter::{CounterKey, GROUP};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use sha2::{Digest, Sha256};

/// Seed of a random stream, derived from a name of words and numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed([u8; 32]);

impl Seed {
    /// Returns the root seed of all random streams of a study.
    pub fn new(seed: u64) -> Self {
        Self(Sha256::digest(seed.to_le_bytes()).into())
    }

    /// Returns the seed of the stream whose name has one more word.
    pub fn named(&self, word: &str) -> Self {
        self.child(b"word", word.as_bytes())
    }

    /// Returns the seed of the stream whose name has one more number.
    pub fn numbered(&self, number: u64) -> Self {
        self.child(b"number", &number.to_le_bytes())
    }

    /// Returns the random number generator of the stream, at the start of the stream.
    pub fn rng(&self) -> ChaCha8Rng {
        ChaCha8Rng::from_seed(self.0)
    }

    fn child(&self, kind: &[u8], bytes: &[u8]) -> Self {
        let mut hash = Sha256::new();
        hash.update(self.0);
        hash.update(kind);
        hash.update(bytes);
        Self(hash.finalize().into())
    }
}

#[cfg(feature = "learning")]
impl bubbletouch_svm::streams::Streams for Seed {
    fn named(&self, word: &str) -> Box<dyn bubbletouch_svm::streams::Streams> {
        Box::new(Seed::named(self, word))
    }

    fn numbered(&self, number: u64) -> Box<dyn bubbletouch_svm::streams::Streams> {
        Box::new(Seed::numbered(self, number))
    }

    fn rng(&self) -> ChaCha8Rng {
        Seed::rng(self)
    }
}
