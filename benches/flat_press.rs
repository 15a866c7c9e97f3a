//! Press of a flat square patch in double and in single precision, to measure the accuracy and speed of single precision. Studies and scenes compute presses in
//! double precision; the single-precision press exists only for this benchmark.
//!
//! Spheres are given in the patch frame; rows of the footprint are processed in blocks of a 512-bit register. No root is computed where it cannot increase a
//! deflection. Coordinates are relative to the middle of the patch, which makes single precision as accurate as possible.

use multiversion::multiversion;

macro_rules! kernel {
    ($name:ident, $real:ty, $lanes:expr, $doc:expr) => {
        #[doc = $doc]
        ///
        /// Spheres are (x, y, h, S) in metres, where S includes the taxel radius. Taxels are at all pairs of `places`, which are ascending and evenly spaced,
        /// at least two, and a whole number of blocks. Writes the deflections (n × n, rows by y), metres, without the limit of a stroke.
        #[multiversion(targets(
            "x86_64+avx512f+avx512bw+avx512dq+avx512vl+avx2+fma",
            "x86_64+avx2+fma"
        ))]
        pub fn $name(spheres: &[[f64; 4]], places: &[$real], deflections: &mut [$real]) {
            let n = places.len();
            let density = 1.0 / (places[1] - places[0]);
            deflections.fill(0.0);
            for sphere in spheres {
                let (x, y, h, s) = (
                    sphere[0] as $real,
                    sphere[1] as $real,
                    sphere[2] as $real,
                    sphere[3] as $real,
                );
                let lift = if h > 0.0 { h } else { 0.0 };
                for row in 0..n {
                    let dy = places[row] - y;
                    let left = s * s - lift * lift - dy * dy;
                    if left <= 0.0 {
                        continue;
                    }
                    let (middle, spread) = ((x - places[0]) * density, left.sqrt() * density);
                    let first = (middle - spread).max(0.0) as usize / $lanes;
                    let last = (((middle + spread).max(0.0) as usize + 1).min(n)).div_ceil($lanes);
                    for block in first..last {
                        let start = block * $lanes;
                        let places = &places[start..start + $lanes];
                        let taxels = &mut deflections[row * n + start..][..$lanes];
                        let (mut squares, mut raised) = ([0.0; $lanes], [0.0; $lanes]);
                        let mut beaten = 0_u32;
                        for k in 0..$lanes {
                            let dx = places[k] - x;
                            squares[k] = (s * s - dy * dy) - dx * dx;
                            raised[k] = taxels[k];
                            let bar = (h + raised[k]).max(0.0);
                            beaten |= u32::from(squares[k] > bar * bar) << k;
                        }
                        if beaten == 0 {
                            continue;
                        }
                        for k in 0..$lanes {
                            let needed = squares[k].sqrt() - h;
                            let needed = if squares[k] > 0.0 { needed } else { 0.0 };
                            raised[k] = raised[k].max(needed);
                        }
                        taxels.copy_from_slice(&raised);
                    }
                }
            }
        }
    };
}

kernel!(
    press_f64,
    f64,
    8,
    "Presses spheres in doubles, eight taxels at once."
);
kernel!(
    press_f32,
    f32,
    16,
    "Presses spheres in singles, sixteen taxels at once."
);
