//! Files that are almost right.

use rand::seq::SliceRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Numbers at and beyond the ends of what is read.
const NUMBERS: [&str; 30] = [
    "0",
    "-0",
    "-0.0",
    "1",
    "-1",
    "2",
    "1e308",
    "-1e308",
    "1e-308",
    "4.9e-324",
    "1e309",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "255",
    "256",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "18446744073709551616",
    "1_000_000_000",
    "0x7fffffff",
    "1e9",
    "99999999999999999999999999",
    "1.",
];

/// The same for numbers of four bytes.
const WORDS: [u32; 9] = [
    0,
    1,
    0xff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000,
    0x7fc0_0000,
];

/// Characters that no reader expects.
const STRANGE: [&[u8]; 9] = [
    b"\xff\xfe",
    b"\xc3\x28",
    b"\x00",
    b"\xef\xbb\xbf",
    b"\xed\xa0\x80",
    "\u{2028}".as_bytes(),
    "é".as_bytes(),
    "\u{1f9a0}".as_bytes(),
    b"\r",
];

/// What opens a nest, and what closes it.
const NESTS: [(&str, &str); 9] = [
    ("[", "]"),
    ("{a=", "}"),
    ("{\"a\":", "}"),
    ("<link>", "</link>"),
    ("<a>", ""),
    ("a.", "=1"),
    ("[[a]]\n", ""),
    ("\"", ""),
    ("(", ")"),
];

/// Draws mutations; the same for the same name and seed.
pub struct Mutator {
    rng: ChaCha8Rng,
    words: &'static [&'static str],
}

impl Mutator {
    pub fn new(name: &str, seed: u64, words: &'static [&'static str]) -> Self {
        let name = name
            .bytes()
            .fold(0_u64, |hash, byte| hash.wrapping_mul(31) + u64::from(byte));
        let rng = ChaCha8Rng::seed_from_u64(name ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        Self { rng, words }
    }

    /// One of the inputs with one to four mutations.
    pub fn mutate(&mut self, pool: &[Vec<u8>]) -> Vec<u8> {
        let mut input = pool.choose(&mut self.rng).cloned().unwrap_or_default();
        for _ in 0..[1, 1, 2, 4][self.rng.gen_range(0..4)] {
            self.change(&mut input, pool);
        }
        input
    }

    fn change(&mut self, input: &mut Vec<u8>, pool: &[Vec<u8>]) {
        match self.rng.gen_range(0..18) {
            0 => self.flip(input),
            1 => self.cut(input),
            2 => self.remove(input),
            3 => self.repeat(input),
            4..=7 => self.number(input),
            8 => self.lines(input),
            9 => self.insert_word(input),
            10 => self.swap_words(input),
            11 => self.nest(input),
            12 => self.splice(input, pool),
            13 => self.four_bytes(input),
            14 => {
                let strange = STRANGE[self.rng.gen_range(0..STRANGE.len())];
                let at = self.place(input);
                input.splice(at..at, strange.iter().copied());
            }
            15 => {
                *input = String::from_utf8_lossy(input)
                    .replace('\n', "\r\n")
                    .into_bytes()
            }
            16 => drop(input.splice(0..0, *b"\xef\xbb\xbf")),
            _ => self.rename(input),
        }
    }

    /// A place in an input, its end included.
    fn place(&mut self, input: &[u8]) -> usize {
        self.rng.gen_range(0..=input.len())
    }

    /// A stretch of an input, mostly short.
    fn stretch(&mut self, input: &[u8]) -> std::ops::Range<usize> {
        let start = self.place(input);
        let longest = match self.rng.gen_range(0..4) {
            0 => input.len() - start,
            _ => (input.len() - start).min(40),
        };
        start..start + self.rng.gen_range(0..=longest)
    }

    fn flip(&mut self, input: &mut [u8]) {
        if !input.is_empty() {
            let at = self.rng.gen_range(0..input.len());
            input[at] ^= 1 << self.rng.gen_range(0..8);
        }
    }

    fn cut(&mut self, input: &mut Vec<u8>) {
        let at = self.place(input);
        input.truncate(at);
    }

    fn remove(&mut self, input: &mut Vec<u8>) {
        let stretch = self.stretch(input);
        input.drain(stretch);
    }

    fn repeat(&mut self, input: &mut Vec<u8>) {
        let stretch = self.stretch(input);
        let n = [1, 2, 100, 3000][self.rng.gen_range(0..4)].min(100_000 / stretch.len().max(1));
        let part = input[stretch.clone()].repeat(n);
        input.splice(stretch.end..stretch.end, part);
    }

    /// Another number in place of one.
    fn number(&mut self, input: &mut Vec<u8>) {
        let is_part = |byte: &u8| byte.is_ascii_digit() || b"+-.".contains(byte);
        let numbers = words_of(input, is_part);
        let Some(number) = numbers.choose(&mut self.rng) else {
            return;
        };
        let other = NUMBERS[self.rng.gen_range(0..NUMBERS.len())];
        input.splice(number.clone(), other.bytes());
    }

    /// Lines change places, come twice or not at all.
    fn lines(&mut self, input: &mut Vec<u8>) {
        let mut lines: Vec<Vec<u8>> = input
            .split_inclusive(|&b| b == b'\n')
            .map(<[u8]>::to_vec)
            .collect();
        if lines.is_empty() {
            return;
        }
        let (a, b) = (
            self.rng.gen_range(0..lines.len()),
            self.rng.gen_range(0..lines.len()),
        );
        match self.rng.gen_range(0..3) {
            0 => lines.swap(a, b),
            1 => lines.insert(a, lines[b].clone()),
            _ => drop(lines.remove(a)),
        }
        *input = lines.concat();
    }

    fn insert_word(&mut self, input: &mut Vec<u8>) {
        if let Some(word) = self.words.choose(&mut self.rng) {
            let at = self.place(input);
            input.splice(at..at, word.bytes());
        }
    }

    /// Two words change places: a key for a key, or for a value.
    fn swap_words(&mut self, input: &mut Vec<u8>) {
        let words = words_of(input, |byte| byte.is_ascii_alphanumeric() || *byte == b'_');
        if words.len() < 2 {
            return;
        }
        let (a, b) = (
            self.rng.gen_range(0..words.len()),
            self.rng.gen_range(0..words.len()),
        );
        let (first, second) = (&words[a.min(b)], &words[a.max(b)]);
        if first != second {
            let (left, right) = (
                input[first.clone()].to_vec(),
                input[second.clone()].to_vec(),
            );
            input.splice(second.clone(), left);
            input.splice(first.clone(), right);
        }
    }

    /// A word becomes one of the language's.
    fn rename(&mut self, input: &mut Vec<u8>) {
        let words = words_of(input, |byte| byte.is_ascii_alphanumeric() || *byte == b'_');
        if let (Some(word), Some(other)) = (
            words.choose(&mut self.rng),
            self.words.choose(&mut self.rng),
        ) {
            input.splice(word.clone(), other.bytes());
        }
    }

    fn nest(&mut self, input: &mut Vec<u8>) {
        let (open, close) = NESTS[self.rng.gen_range(0..NESTS.len())];
        let n = [3, 100, 2000, 20_000][self.rng.gen_range(0..4)];
        let nest = format!("{}1{}", open.repeat(n), close.repeat(n));
        let numbers = words_of(input, u8::is_ascii_digit);
        match numbers.choose(&mut self.rng) {
            Some(number) if self.rng.gen_bool(0.7) => {
                drop(input.splice(number.clone(), nest.bytes()))
            }
            _ => {
                let at = self.place(input);
                input.splice(at..at, nest.bytes());
            }
        }
    }

    fn splice(&mut self, input: &mut Vec<u8>, pool: &[Vec<u8>]) {
        if let Some(other) = pool.choose(&mut self.rng) {
            let from = self.stretch(other);
            let to = self.stretch(input);
            input.splice(to, other[from].iter().copied());
        }
    }

    fn four_bytes(&mut self, input: &mut [u8]) {
        if input.len() >= 4 {
            // Often where binary files count.
            let at = match self.rng.gen_range(0..3) {
                0 => 80.min(input.len() - 4),
                _ => self.rng.gen_range(0..=input.len() - 4),
            };
            let word = WORDS[self.rng.gen_range(0..WORDS.len())];
            input[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
    }
}

/// Stretches of bytes of one kind.
fn words_of(input: &[u8], is_part: impl Fn(&u8) -> bool) -> Vec<std::ops::Range<usize>> {
    let mut words: Vec<std::ops::Range<usize>> = Vec::new();
    let places = input.iter().enumerate().filter(|(_, byte)| is_part(byte));
    for (at, _) in places {
        match words.last_mut() {
            Some(word) if word.end == at => word.end = at + 1,
            _ => words.push(at..at + 1),
        }
    }
    words
}
