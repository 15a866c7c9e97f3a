//! Laws of the signal stage, compared with SciPy and with slow, simple code. Noise of ten times the full scale and smoothing wider than the array have the
//! behaviour that the guide's page on limits states.

use super::{TAXEL, grid, noise, read, smoothing};
use crate::standard_errors::assert_expected;
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, Quantity, SensorError, SignalStep};
use bubbletouch_sim::world::{Grid, Patch};
use rand::Rng;

/// Reference: `scipy.ndimage.gaussian_filter(f, width)`, SciPy 1.17.1, with f[i, j] = ((7 i + 5 j) mod 11) / 10, 4 × 6.
#[rustfmt::skip]
const SCIPY: [(f64, [f64; 24]); 3] = [
    (0.8, [
        0.25411185677479653, 0.4569717509441071, 0.6240653249073445, 0.5525411783651744, 0.6003611412931387, 0.5531844902576213,
        0.4256466181696452, 0.4397228452790132, 0.47294062676665316, 0.41538011821393106, 0.5108647890335141, 0.655472805648325,
        0.5514303461182104, 0.5265402896774988, 0.4834551329491864, 0.43945710076605105, 0.4478973152785497, 0.5310213090843637,
        0.7341482670680308, 0.6237452110528869, 0.5925810272026794, 0.5195794908289815, 0.4938966574412932, 0.3949843068790081,
    ]),
    (2.0, [
        0.4670186340071158, 0.4794440774850115, 0.49774762171478804, 0.5153163135058969, 0.5289371316664317, 0.53666811034098,
        0.489823458653297, 0.49603843231684297, 0.5050264918074957, 0.5137855279006547, 0.5211468247263834, 0.5257309577298175,
        0.5232356982641969, 0.5208243219499438, 0.516701660313433, 0.5127262689538511, 0.5106712460162758, 0.5103326915913806,
        0.5476893875523547, 0.5392863203132785, 0.5259353233023398, 0.5127607925015413, 0.503651645525833, 0.4995010618608581,
    ]),
    (7.5, [
        0.5124959808358575, 0.5124980877498719, 0.5124972301331161, 0.5125034728151585, 0.5125026151451886, 0.5125047221342338,
        0.5124965903445403, 0.5124986976399706, 0.5124978403189886, 0.5125040837173572, 0.5125032263825908, 0.5125053336974567,
        0.5124954910190093, 0.5124975988014937, 0.5124967423599697, 0.5125029867495214, 0.5125021303700862, 0.5125042380650268,
        0.5124944466661023, 0.5124965548595116, 0.5124956992576665, 0.5125019446482209, 0.512501089051285, 0.5125031972377722,
    ]),
];

#[test]
fn smoothing_is_scipys_gaussian_filter_even_when_wider_than_the_array() {
    let frame: Vec<f64> = (0..4)
        .flat_map(|i| (0..6).map(move |j| ((7 * i + 5 * j) % 11) as f64 / 10.0))
        .collect();
    for (width, golden) in SCIPY {
        let ours = read(&[smoothing(width)], &grid(6, 4), &frame, 0);
        for (ours, scipy) in ours.iter().zip(golden) {
            assert!(
                (ours - scipy).abs() < 1e-14,
                "width {width}: {ours} {scipy}"
            );
        }
    }
}

#[test]
fn smoothing_wider_than_the_array_is_the_weighted_mean_of_the_mirrored_array() {
    let mut rng = Seed::new(2).named("frame").rng();
    let frame: Vec<f64> = (0..36).map(|_| rng.gen_range(0.0..5e-3)).collect();
    for pitches in [1.0, 3.0, 6.0, 20.0, 300.0, 1e4] {
        let found = read(&[smoothing(pitches)], &grid(6, 6), &frame, 0);
        // Slow oracle: every weight of the truncated Gaussian on the endlessly mirrored array.
        let reach = (4.0 * pitches + 0.5) as i64;
        let tap = |t: i64| (-0.5 * (t as f64 / pitches).powi(2)).exp();
        let sum: f64 = (-reach..=reach).map(tap).sum();
        let mirrored = |place: i64| {
            let wrapped = place.rem_euclid(12);
            wrapped.min(11 - wrapped) as usize
        };
        let mut weights = [[0.0; 6]; 6];
        for (to, row) in weights.iter_mut().enumerate() {
            for t in -reach..=reach {
                row[mirrored(to as i64 + t)] += tap(t) / sum;
            }
        }
        for (taxel, found) in found.iter().enumerate() {
            let weight = |from: usize| weights[taxel / 6][from / 6] * weights[taxel % 6][from % 6];
            let terms = frame.iter().enumerate();
            let slow: f64 = terms.map(|(from, value)| weight(from) * value).sum();
            assert!((found - slow).abs() < 1e-15, "{pitches}: {found} {slow}");
        }
        if pitches >= 300.0 {
            let mean = frame.iter().sum::<f64>() / 36.0;
            assert!(found.iter().all(|v| (v / mean - 1.0).abs() < 1e-4));
        }
    }
}

#[test]
fn one_width_smooths_the_same_patch_of_skin_at_every_pitch() {
    // A Gaussian of width a smoothed by w has the peak a² / (a² + w²).
    let exact = 36.0 / 52.0;
    for (n, pitch) in [(41, 2e-3), (81, 1e-3), (161, 0.5e-3)] {
        let grid = Grid {
            nx: n,
            ny: n,
            pitch,
        };
        let bump = |i: usize| {
            let (x, y) = (grid.x(i % n), grid.y(i / n));
            (-0.5 * (x * x + y * y) / 6e-3f64.powi(2)).exp()
        };
        let frame: Vec<f64> = (0..n * n).map(bump).collect();
        let step = [SignalStep::Smoothing { width: 4e-3 }];
        let blurred = read(&step, &Patch::grid(grid, TAXEL).unwrap(), &frame, 0);
        assert!((blurred[n * n / 2] - exact).abs() < 1e-3);
    }
}

#[test]
fn noise_is_normal_and_independent_between_neighbours_and_neither_clipped_nor_bounded() {
    let patch = grid(160, 160);
    let full_scale = TAXEL.stroke;
    let n = patch.n_taxels() as f64;
    let even = vec![0.5 * full_scale; patch.n_taxels()];
    for std in [0.1, 1.0, 10.0] {
        let noisy = read(&[noise(std)], &patch, &even, 3);
        let scaled = noisy.iter().zip(&even);
        let z: Vec<f64> = scaled
            .map(|(v, even)| (v - even) / (std * full_scale))
            .collect();
        let mean = z.iter().sum::<f64>() / n;
        let moment = |power| z.iter().map(|v| (v - mean).powi(power)).sum::<f64>() / n;
        let neighbours = z.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n;
        for (what, found, expected, variance) in [
            ("mean", mean, 0.0, 1.0),
            ("variance", moment(2), 1.0, 2.0),
            ("fourth moment", moment(4), 3.0, 96.0),
            ("neighbours", neighbours, 0.0, 1.0_f64),
        ] {
            let what = format!("{std}: {what}");
            assert_expected(&what, found, expected, (variance / n).sqrt());
        }
        let is_beyond = |v: &&f64| !(0.0..=full_scale).contains(*v);
        let beyond = noisy.iter().filter(is_beyond).count() as f64 / n;
        assert!(
            std < 1.0 || beyond > 0.5,
            "{std}: {beyond} beyond the full scale"
        );
        // A converter after the noise clips the values.
        let converter = SensorError::Quantisation
            .step(&[8.0], Seed::new(1))
            .unwrap();
        let clipped = read(&[noise(std), converter], &patch, &noisy, 3);
        let range = 0.0..=full_scale * (1.0 + 1e-12);
        assert!(clipped.iter().all(|v| range.contains(v)));
    }
}

#[test]
fn noise_levels_share_their_pattern_and_touches_do_not() {
    let at = |level: f64, touch: u64| read(&[noise(level)], &grid(8, 8), &[0.0; 64], touch);
    let (quiet, loud, other) = (at(0.1, 1), at(0.4, 1), at(0.1, 2));
    for (quiet, loud) in quiet.iter().zip(&loud) {
        assert!((4.0 * quiet - loud).abs() < 1e-17);
    }
    assert_ne!(quiet, other);
    assert_eq!(at(0.0, 1), vec![0.0; 64]);
}

#[test]
fn two_noise_steps_of_one_chain_are_independent() {
    let single = read(&[noise(1.0)], &grid(8, 8), &[0.0; 64], 1);
    let double = read(&[noise(1.0); 2], &grid(8, 8), &[0.0; 64], 1);
    let pairs = double.iter().zip(&single);
    // The second step adds the difference.
    let mut apart = pairs.map(|(double, single)| (double - 2.0 * single).abs());
    assert!(apart.any(|apart| apart > 1e-4));
}

#[test]
fn full_scale_noise_before_and_after_force_is_the_same_noise() {
    // Values far from zero, so that forces are not clipped at zero.
    let both = |steps: [SignalStep; 2]| read(&steps, &grid(8, 8), &[4.0; 64], 5);
    let before = both([noise(0.1), SignalStep::Force]);
    let after = both([SignalStep::Force, noise(0.1)]);
    for (before, after) in before.iter().zip(after) {
        assert!((before - after).abs() < 1e-12);
    }
}

#[test]
fn the_order_of_steps_is_the_order_of_the_list() {
    let spread = |steps: [SignalStep; 2]| {
        let frame = read(&steps, &grid(16, 16), &[0.0; 256], 9);
        (frame.iter().map(|v| v * v).sum::<f64>() / 256.0).sqrt()
    };
    let smoothed_last = spread([noise(0.1), smoothing(2.0)]);
    let smoothed_first = spread([smoothing(2.0), noise(0.1)]);
    // Smoothing by σ = 2 taxels reduces white noise to about 1 / (2 √π σ).
    assert!(smoothed_last < 0.25 * smoothed_first);
}

#[test]
fn a_chain_knows_what_its_frames_are_and_refuses_what_they_are_not() {
    let patch = grid(4, 4);
    let force = SignalStep::Force;
    let noise_in = |std, unit| SignalStep::Noise(Noise { std, unit });
    let quantity = |steps: &[SignalStep]| Chain::new(steps, &patch).unwrap().quantity();
    assert_eq!(quantity(&[]), Quantity::Deflection);
    assert_eq!(quantity(&[force, smoothing(1.0)]), Quantity::Force);
    assert_eq!(
        quantity(&[force, noise_in(0.1, NoiseUnit::N)]),
        Quantity::Force
    );
    for refused in [
        vec![force, force],
        vec![force, noise_in(0.1, NoiseUnit::Mm)],
        vec![noise_in(0.1, NoiseUnit::N), force],
        vec![noise(-0.1)],
        vec![noise(f64::NAN)],
        vec![noise(f64::INFINITY)],
        vec![smoothing(f64::NAN)],
    ] {
        assert!(Chain::new(&refused, &patch).is_err(), "{refused:?}");
    }
}
