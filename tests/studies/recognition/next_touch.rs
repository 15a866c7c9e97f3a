//! Choice of the next touch: compared with the definition of expected entropy, with brute force, and with cases that have an analytical solution.

use bubbletouch::random::Seed;
use bubbletouch::recognition::evaluation::next_touch::{
    AnswerModel, PoseAnswers, Poses, most_informative, sequence,
};
use ndarray::{Array1, Array2, array};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{LN_2, TAU};

const N_OBJECTS: usize = 4;
const N_POSES: usize = 7;

fn random_answers(rng: &mut ChaCha8Rng) -> Array2<f64> {
    let mut given =
        Array2::from_shape_simple_fn((N_OBJECTS, N_OBJECTS), || rng.gen_range(0.01..1.0));
    given.outer_iter_mut().for_each(|mut row| row /= row.sum());
    given
}

/// Returns Σ_a P(a) H(O | a) after some touches, from the joint probabilities of an object and all labels.
fn expected_entropy(tables: &[Array2<f64>], answers: &[usize], made: &[usize], next: usize) -> f64 {
    let so_far = |object: usize| -> f64 {
        let told = |&touch: &usize| tables[touch][[object, answers[touch]]];
        made.iter().map(told).product()
    };
    let joint = |object: usize, answer: usize| so_far(object) * tables[next][[object, answer]];
    let all: f64 = (0..N_OBJECTS).map(so_far).sum();
    let mut expected = 0.0;
    for answer in 0..N_OBJECTS {
        let of_answer: f64 = (0..N_OBJECTS).map(|object| joint(object, answer)).sum();
        for object in 0..N_OBJECTS {
            let belief = joint(object, answer) / of_answer;
            expected -= of_answer / all * belief * belief.ln();
        }
    }
    expected
}

#[test]
fn each_touch_has_the_least_expected_entropy_of_those_that_are_left() {
    let mut rng = Seed::new(30).rng();
    for _ in 0..50 {
        let tables: Vec<Array2<f64>> = (0..N_POSES).map(|_| random_answers(&mut rng)).collect();
        let told: Vec<PoseAnswers> = tables.iter().cloned().map(PoseAnswers::new).collect();
        let answers: Vec<usize> = (0..N_POSES).map(|_| rng.gen_range(0..N_OBJECTS)).collect();
        let chosen = sequence((2, N_POSES), N_POSES, |made, left| {
            let place = most_informative((&told, &answers), made, left);
            let of = |&touch: &usize| expected_entropy(&tables, &answers, made, touch);
            let least = left.iter().map(of).fold(f64::INFINITY, f64::min);
            assert!((of(&left[place]) - least).abs() < 1e-12);
            // Remaining touches have no label yet; using this value would cause an error.
            let mut unknown = vec![usize::MAX; N_POSES];
            made.iter()
                .for_each(|&touch| unknown[touch] = answers[touch]);
            assert_eq!(most_informative((&told, &unknown), made, left), place);
            place
        });
        let mut sorted = chosen.clone();
        sorted.sort_unstable();
        assert_eq!((chosen[0], sorted), (2, (0..N_POSES).collect()));
    }
}

#[test]
fn a_pose_that_parts_two_objects_tells_one_bit_and_one_that_does_not_nothing() {
    let useless = PoseAnswers::new(array![[0.3, 0.7], [0.3, 0.7]]);
    let even = array![0.5, 0.5];
    assert!(useless.information(&even).abs() < 1e-15);
    for error in [1e-12, 0.1, 0.25] {
        let telling = PoseAnswers::new(array![[1.0 - error, error], [error, 1.0 - error]]);
        // Capacity of a binary symmetric channel.
        let capacity = LN_2 + error * f64::ln(error) + (1.0 - error) * f64::ln(1.0 - error);
        assert!((telling.information(&even) - capacity).abs() < 1e-15);
        let poses = [useless.clone(), useless.clone(), telling.clone()];
        assert_eq!(most_informative((&poses, &[0, 0, 0]), &[0], &[1, 2]), 1);
        let mut belief = even.clone();
        telling.update_belief(&mut belief, 1);
        assert!((belief[1] - (1.0 - error)).abs() < 1e-15);
    }
    // Three objects: one pose separates the first from both others, another one separates the second. The current belief determines which pose is more
    // informative.
    let part = |object: usize| {
        let row = |o: usize| match o == object {
            true => [0.98, 0.01, 0.01],
            false => [0.01, 0.01, 0.98],
        };
        PoseAnswers::new(Array2::from_shape_fn((3, 3), |(o, a)| row(o)[a]))
    };
    let doubtful = PoseAnswers::new(array![
        [0.8, 0.1, 0.1],
        [0.1, 0.45, 0.45],
        [0.1, 0.45, 0.45]
    ]);
    let poses = [doubtful, part(0), part(1)];
    assert_eq!(most_informative((&poses, &[0]), &[0], &[1, 2]), 0);
    assert_eq!(most_informative((&poses, &[1]), &[0], &[1, 2]), 1);
}

fn random_poses(n: usize, rng: &mut ChaCha8Rng) -> Poses {
    Poses {
        coordinates: Array2::from_shape_simple_fn((n, 2), || rng.gen_range(-1.0..1.0)),
        // An angle of up to half a turn, in units of half a turn.
        turns: vec![None, Some(2.0)],
    }
}

#[test]
fn the_farthest_touch_has_the_largest_distance_to_the_nearest_one_made() {
    let mut rng = Seed::new(31).rng();
    let poses = random_poses(30, &mut rng);
    let distance = |a: usize, b: usize| {
        let apart = &poses.coordinates.row(a) - &poses.coordinates.row(b);
        // Angle between two directions.
        let angle = (apart[1] / 2.0 * TAU).cos().acos();
        apart[0].hypot(angle / TAU * 2.0)
    };
    let chosen = sequence((7, 12), 30, |made, left| {
        let place = poses.farthest(made, left);
        let nearest = |touch: usize| {
            let distances = made.iter().map(|&other| distance(touch, other));
            distances.fold(f64::INFINITY, f64::min)
        };
        let greatest = left.iter().map(|&touch| nearest(touch)).fold(0.0, f64::max);
        assert!((nearest(left[place]) - greatest).abs() < 1e-9);
        place
    });
    assert_eq!(chosen.len(), 12);
    let line = Poses {
        coordinates: array![[0.0], [0.3], [0.9]],
        turns: vec![Some(1.0)],
    };
    // 0.9 of a turn is a tenth of a turn away from zero.
    assert_eq!(line.farthest(&[0], &[1, 2]), 0);
    assert_eq!(line.select(&[1, 0, 2]).farthest(&[1], &[0, 2]), 0);
}

/// Two objects that are confused if the first coordinate is below 0 and never otherwise, for any second coordinate.
#[test]
fn a_model_of_answers_knows_where_objects_are_confused() {
    let mut rng = Seed::new(32).rng();
    let poses = random_poses(402, &mut rng);
    let x = |touch: usize| poses.coordinates[[touch, 0]];
    let touches: Vec<(usize, usize, usize)> = (0..400)
        .map(|touch| {
            let (object, coin) = (touch % 2, rng.gen_range(0..2));
            (touch, object, if x(touch) < 0.0 { coin } else { object })
        })
        .collect();
    let model = AnswerModel::new(&poses, &touches, 2);
    let even = array![0.5, 0.5];
    let mut mean = [Vec::new(), Vec::new()];
    for touch in (0..400).filter(|&touch| x(touch).abs() > 0.3) {
        let told = model.at(touch);
        mean[usize::from(x(touch) > 0.0)].push(told.information(&even));
    }
    let [none, all] = mean.map(|told| Array1::from(told).mean().unwrap());
    println!("{none:.3} and {all:.3} of {LN_2:.3}");
    assert!(none < 0.1 && all > 0.5, "{none} {all}");
    // For an object without touches, only the sum of its label probabilities is known: 1.
    let unknown = AnswerModel::new(&poses, &touches[..0], 2).at(401);
    assert!(unknown.information(&even).abs() < 1e-15);
}
