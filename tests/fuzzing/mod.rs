//! Throws broken files at a reader: valid ones, mutated; it must answer, soon, in little memory (20 bytes for one
//! of its input, or as many as it states a reason for), with a value or a sentence.
//!
//! A run of the tests tries as many inputs a reader as take a few seconds, the same in every run. BUBBLETOUCH_FUZZ_SECONDS=600
//! goes on for as long a reader, from BUBBLETOUCH_FUZZ_SEED on. An input that a reader stumbles over is written to the folder of
//! temporary files, named in the failure, and once mended it belongs into `tests/corpus/`, which every run tries first.

mod mutation;

use crate::counting::{limit_bytes, peak_bytes};
use mutation::Mutator;
use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A reader under test.
pub struct Target<'a> {
    /// Its name, that of its folder in `tests/corpus/`.
    pub name: &'static str,
    /// Inputs that it accepts.
    pub seeds: Vec<Vec<u8>>,
    /// Words of its language that mutations put in.
    pub words: &'static [&'static str],
    /// Mutated inputs in a run of the tests: as many as take a few seconds.
    pub n_inputs: usize,
    /// Bytes that it may hold for one of its input, and beside these; why, if it is more than usual, at the place where the
    /// target is made.
    pub most_bytes: (usize, usize),
    /// Processor-seconds that it may take for however small an input; [`SOON`] unless it says why.
    pub least_s: f64,
    /// Reads an input.
    pub read: &'a dyn Fn(&[u8]) -> bubbletouch::Result<()>,
}

/// Beside a second for each 100 kB: what a small file may take.
pub const SOON: f64 = 0.25;

/// A mutated input is not longer.
const LONGEST: usize = 300_000;
/// The longest sentence.
const LONGEST_ERROR: usize = 5_000;
/// More memory than this ends the process, before it ends the machine.
const MOST_BYTES: usize = 1 << 30;
/// Inputs that brought something new, kept as starting points.
const MOST_KEPT: usize = 400;

impl Target<'_> {
    /// Tries seeds, the kept corpus, and mutations of both.
    pub fn run(&self) {
        for seed in &self.seeds {
            self.must_hold(seed);
            let read = (self.read)(seed);
            assert!(read.is_ok(), "{}: a seed is refused: {read:?}", self.name);
        }
        let mut pool = self.seeds.clone();
        for path in corpus(self.name) {
            let input = fs::read(&path).unwrap();
            self.must_hold(&input);
            pool.push(input);
        }
        let (seconds, seed) = (variable("SECONDS"), variable("SEED").unwrap_or(0));
        let mut mutator = Mutator::new(self.name, seed, self.words);
        let mut outcomes = BTreeSet::new();
        let start = Instant::now();
        let mut n_inputs = 0;
        let goes_on = |n: usize| match seconds {
            Some(seconds) => start.elapsed() < Duration::from_secs(seconds),
            None => n < self.n_inputs,
        };
        while goes_on(n_inputs) {
            let mut input = mutator.mutate(&pool);
            input.truncate(LONGEST);
            let outcome = self.must_hold(&input);
            n_inputs += 1;
            // Whoever comes by a new sentence has come further into the reader.
            if outcomes.insert(outcome) && pool.len() < MOST_KEPT {
                pool.push(input);
            }
        }
        let _ = writeln!(
            std::io::stderr(),
            "{}: {n_inputs} inputs in {:.1} s, {} different outcomes",
            self.name,
            start.elapsed().as_secs_f64(),
            outcomes.len()
        );
    }

    /// Reads an input within its limits; what came of it, numbers and names left out.
    fn must_hold(&self, input: &[u8]) -> String {
        // Left behind if the process ends before this returns.
        let kept = std::env::temp_dir().join(format!(
            "bubbletouch-{}-{}.input",
            self.name,
            std::process::id()
        ));
        fs::write(&kept, input).unwrap();
        let mut result = None;
        let start = processor_time();
        let peak = peak_bytes(|| {
            result = Some(limit_bytes(MOST_BYTES, || {
                catch_unwind(AssertUnwindSafe(|| (self.read)(input)))
            }));
        });
        let took = processor_time() - start;
        let said = match result.expect("it was read") {
            Err(_) => self.stumbled(&kept, "panicked"),
            Ok(Ok(())) => "read".to_owned(),
            Ok(Err(error)) if error.exit_code() != 2 => {
                self.stumbled(&kept, &format!("is not called bad input: {error}"))
            }
            Ok(Err(error)) => error.to_string(),
        };
        if said.len() > LONGEST_ERROR {
            self.stumbled(&kept, &format!("is answered in {} bytes", said.len()));
        }
        // In the tests ten times the bar, for a machine that does other things.
        let slack = if variable("SECONDS").is_some() {
            1.0
        } else {
            10.0
        };
        let allowed = slack * (input.len() as f64 / 1e5).max(self.least_s);
        if took.as_secs_f64() > allowed {
            self.stumbled(&kept, &format!("took {took:?} for {} bytes", input.len()));
        }
        let (times, spare) = self.most_bytes;
        let most = times * input.len() + spare;
        if peak > most {
            self.stumbled(&kept, &format!("held {peak} bytes for {}", input.len()));
        }
        fs::remove_file(&kept).unwrap();
        shape(&said)
    }

    fn stumbled(&self, kept: &Path, how: &str) -> ! {
        panic!(
            "{}: {} {how}; once mended it belongs into tests/corpus/{}",
            self.name,
            kept.display(),
            self.name
        )
    }
}

/// Kept inputs of a target, in the order of their names.
fn corpus(name: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/corpus")
        .join(name);
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
}

fn variable(name: &str) -> Option<u64> {
    let text = std::env::var(format!("BUBBLETOUCH_FUZZ_{name}")).ok()?;
    Some(text.parse().expect("a whole number"))
}

/// A sentence without what its input put into it: digits, and what stands in quotes.
fn shape(said: &str) -> String {
    let mut quoted = false;
    let plain = said.chars().filter(|&letter| {
        if matches!(letter, '`' | '"' | '\'') {
            quoted = !quoted;
        }
        !quoted && !letter.is_ascii_digit()
    });
    plain.take(120).collect()
}

/// What this thread has computed for, where the system says; else the time.
fn processor_time() -> Duration {
    let of_system = fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = of_system.and_then(|text| text.split(' ').next()?.parse().ok());
    match nanoseconds {
        Some(nanoseconds) => Duration::from_nanos(nanoseconds),
        None => {
            let now = std::time::SystemTime::now();
            now.duration_since(std::time::UNIX_EPOCH)
                .unwrap_or_default()
        }
    }
}
