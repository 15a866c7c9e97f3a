//! Laws of the signal stage, compared with SciPy and with slow, simple code.

use crate::standard_errors::{assert_expected, mean_and_std, of_mean, of_std};
use bubbletouch_sim::random::Seed;
use bubbletouch_sim::signal::{Chain, Noise, NoiseUnit, Quantity, SignalStep, SignalWorkspace};
use bubbletouch_sim::world::{Grid, Patch, Taxel};

const PITCH: f64 = 2e-3;

fn patch(nx: usize, ny: usize) -> Patch {
    let pitch = PITCH;
    let grid = Grid { nx, ny, pitch };
    let taxel = Taxel {
        radius: 1e-3,
        stiffness: 200.0,
        damping: 0.4,
        stroke: 5e-3,
    };
    Patch::grid(grid, taxel).unwrap()
}

fn noise(std: f64, unit: NoiseUnit) -> SignalStep {
    SignalStep::Noise(Noise { std, unit })
}

fn smoothing(width_pitches: f64) -> SignalStep {
    SignalStep::Smoothing {
        width: width_pitches * PITCH,
    }
}

fn applied(steps: &[SignalStep], patch: &Patch, frame: &[f64], touch: u64) -> Vec<f64> {
    let chain = Chain::new(steps, patch).unwrap();
    let mut out = frame.to_vec();
    let seed = Seed::new(2018).numbered(touch);
    chain.apply(&mut out, None, &seed, &mut SignalWorkspace::default());
    out
}

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
        let ours = applied(&[smoothing(width)], &patch(6, 4), &frame, 0);
        for (ours, scipy) in ours.iter().zip(golden) {
            assert!(
                (ours - scipy).abs() < 1e-14,
                "width {width}: {ours} {scipy}"
            );
        }
    }
}

#[test]
fn one_width_smooths_the_same_patch_of_skin_at_every_pitch() {
    let blurred_at_centre = |n: usize, pitch: f64| {
        let grid = Grid {
            nx: n,
            ny: n,
            pitch,
        };
        let patch = Patch::grid(grid, *patch(1, 1).taxels().at(0)).unwrap();
        let bump = |row: usize, column: usize| {
            let (x, y) = (grid.x(column), grid.y(row));
            (-0.5 * (x * x + y * y) / 6e-3f64.powi(2)).exp()
        };
        let frame: Vec<f64> = (0..n * n).map(|i| bump(i / n, i % n)).collect();
        let step = [SignalStep::Smoothing { width: 4e-3 }];
        applied(&step, &patch, &frame, 0)[(n * n) / 2]
    };
    // A Gaussian of width a smoothed by w has the peak a² / (a² + w²).
    let exact = 36.0 / 52.0;
    for (n, pitch) in [(41, 2e-3), (81, 1e-3), (161, 0.5e-3)] {
        assert!((blurred_at_centre(n, pitch) - exact).abs() < 1e-3);
    }
}

#[test]
fn noise_has_the_asked_mean_and_spread_and_no_correlation_between_neighbours() {
    let z = applied(
        &[noise(0.2, NoiseUnit::Mm)],
        &patch(250, 250),
        &[0.0; 62_500],
        3,
    );
    let (mean, std) = mean_and_std(&z);
    let products: Vec<f64> = z.windows(2).map(|w| w[0] * w[1]).collect();
    let (neighbours, _) = mean_and_std(&products);
    let n = z.len();
    assert_expected("mean", mean, 0.0, of_mean(0.2e-3, n));
    assert_expected("std", std, 0.2e-3, of_std(0.2e-3, n));
    assert_expected("neighbours", neighbours, 0.0, of_mean(0.2e-3f64.powi(2), n));
}

#[test]
fn noise_levels_share_their_pattern_and_touches_do_not() {
    let patch = patch(8, 8);
    let at = |level: f64, touch: u64| {
        let steps = [noise(level, NoiseUnit::FullScale)];
        applied(&steps, &patch, &[0.0; 64], touch)
    };
    let (quiet, loud, other) = (at(0.1, 1), at(0.4, 1), at(0.1, 2));
    for (quiet, loud) in quiet.iter().zip(&loud) {
        assert!((4.0 * quiet - loud).abs() < 1e-17);
    }
    assert_ne!(quiet, other);
    assert_eq!(at(0.0, 1), vec![0.0; 64]);
}

#[test]
fn two_noise_steps_of_one_chain_are_independent() {
    let once = [noise(1.0, NoiseUnit::FullScale)];
    let twice = [once[0], once[0]];
    let patch = patch(8, 8);
    let single = applied(&once, &patch, &[0.0; 64], 1);
    let double = applied(&twice, &patch, &[0.0; 64], 1);
    let second: Vec<f64> = double.iter().zip(&single).map(|(d, s)| d - s).collect();
    assert!(
        second
            .iter()
            .zip(&single)
            .any(|(a, b)| (a - b).abs() > 1e-4)
    );
}

#[test]
fn full_scale_noise_before_and_after_force_is_the_same_noise() {
    let patch = patch(8, 8);
    // Values far from zero, so that forces are not clipped at zero.
    let frame = vec![4.0; 64];
    let level = noise(0.1, NoiseUnit::FullScale);
    let before = applied(&[level, SignalStep::Force], &patch, &frame, 5);
    let after = applied(&[SignalStep::Force, level], &patch, &frame, 5);
    for (before, after) in before.iter().zip(after) {
        assert!((before - after).abs() < 1e-12);
    }
}

#[test]
fn the_order_of_steps_is_the_order_of_the_list() {
    let patch = patch(16, 16);
    let spread = |steps: &[SignalStep]| {
        let frame = applied(steps, &patch, &[0.0; 256], 9);
        (frame.iter().map(|v| v * v).sum::<f64>() / 256.0).sqrt()
    };
    let level = noise(0.1, NoiseUnit::FullScale);
    let smoothed_last = spread(&[level, smoothing(2.0)]);
    let smoothed_first = spread(&[smoothing(2.0), level]);
    // Smoothing by σ = 2 taxels reduces white noise to about 1 / (2 √π σ).
    assert!(smoothed_last < 0.25 * smoothed_first);
}

#[test]
fn a_chain_knows_what_its_frames_are_and_refuses_what_they_are_not() {
    let patch = patch(4, 4);
    let force = SignalStep::Force;
    let quantity = |steps: &[SignalStep]| Chain::new(steps, &patch).unwrap().quantity();
    assert_eq!(quantity(&[]), Quantity::Deflection);
    assert_eq!(quantity(&[force, smoothing(1.0)]), Quantity::Force);
    for refused in [
        vec![force, force],
        vec![force, noise(0.1, NoiseUnit::Mm)],
        vec![noise(0.1, NoiseUnit::N), force],
        vec![noise(-0.1, NoiseUnit::FullScale)],
        vec![smoothing(f64::NAN)],
    ] {
        assert!(Chain::new(&refused, &patch).is_err(), "{refused:?}");
    }
    assert!(Chain::new(&[force, noise(0.1, NoiseUnit::N)], &patch).is_ok());
}
