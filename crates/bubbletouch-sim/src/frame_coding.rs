//! Compact encoding of a frame: one bit per taxel, in words of 64 bits, then the nonzero values as little-endian f32.
//!
//! In a typical touch a tenth of the taxels are nonzero, so the encoding takes an eighth of the memory of an f32 frame. At most, the encoding takes one
//! thirty-second more memory than the f32 frame.

/// Number of taxels per word of bits.
const WORD: usize = 64;

/// Returns the largest number of bytes that an encoded frame of `n_taxels` taxels can have.
pub fn most_bytes(n_taxels: usize) -> usize {
    n_taxels.div_ceil(WORD) * 8 + 4 * n_taxels
}

/// Writes the values, rounded to single precision, to `out`; both slices have equal lengths.
pub fn round_to_single(values: &[f64], out: &mut [f32]) {
    assert_eq!(values.len(), out.len(), "values");
    for (to, &from) in out.iter_mut().zip(values) {
        *to = from as f32;
    }
}

/// Encodes a frame as bytes, which [`decode`] converts back.
pub fn encode(frame: &[f32]) -> Box<[u8]> {
    let mut out = Vec::with_capacity(most_bytes(frame.len()));
    for taxels in frame.chunks(WORD) {
        let bit = |(place, &value): (usize, &f32)| u64::from(value != 0.0) << place;
        let word: u64 = taxels.iter().enumerate().map(bit).sum();
        out.extend_from_slice(&word.to_le_bytes());
    }
    for value in frame.iter().filter(|&&value| value != 0.0) {
        out.extend_from_slice(&value.to_le_bytes());
    }
    out.into_boxed_slice()
}

/// Decodes a frame; `bytes` must be the result of [`encode`] for a frame with as many taxels.
pub fn decode(bytes: &[u8], frame: &mut [f64]) {
    let (words, values) = bytes.split_at(frame.len().div_ceil(WORD) * 8);
    let mut values = values.chunks_exact(4);
    frame.fill(0.0);
    for (word, taxels) in words.chunks_exact(8).zip(frame.chunks_mut(WORD)) {
        let mut left = u64::from_le_bytes(word.try_into().expect("chunks of eight"));
        while left != 0 {
            let value = values.next().expect("a value for every bit");
            let value = f32::from_le_bytes(value.try_into().expect("chunks of four"));
            taxels[left.trailing_zeros() as usize] = f64::from(value);
            left &= left - 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Seed;
    use rand::Rng;

    #[test]
    fn every_frame_comes_back_as_it_was() {
        let mut rng = Seed::new(7).named("frames").rng();
        for n_taxels in [1, 2, 63, 64, 65, 100, 4096] {
            for share in [0.0, 0.02, 0.5, 1.0] {
                let frame: Vec<f32> = (0..n_taxels)
                    .map(|_| match rng.gen_bool(share) {
                        true => rng.gen_range(f32::MIN_POSITIVE..5e-3),
                        false => 0.0,
                    })
                    .collect();
                let bytes = encode(&frame);
                assert!(bytes.len() <= most_bytes(n_taxels));
                let mut back = vec![f64::NAN; n_taxels];
                decode(&bytes, &mut back);
                let wanted: Vec<f64> = frame.iter().map(|&v| f64::from(v)).collect();
                assert_eq!(back, wanted, "{n_taxels} taxels, {share} of them touched");
            }
        }
    }

    #[test]
    fn a_usual_frame_takes_an_eighth() {
        let mut frame = vec![0.0; 4096];
        frame[1000..1400].fill(1e-3);
        assert_eq!(encode(&frame).len(), 4096 / 8 + 4 * 400);
    }
}
