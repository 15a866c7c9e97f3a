//! Human touches: the motion of each kind, and a study that distinguishes the kinds by their course over time.

use crate::command::{Case, says};
use bubbletouch::contact::{Press, Until, Workspace, spring_load};
use bubbletouch::kinds::recognition::RecognitionStudy;
use bubbletouch::objects::{FingerPose, Model};
use bubbletouch::random::Seed;
use bubbletouch::study::progress::Silent;
use bubbletouch::study::table::Tables;
use bubbletouch::study::{HumanTouches, Plan, StudySpec, Sweep, TouchSet, record_touch};
use bubbletouch::world::{
    HandState, HumanTouch, Layout, Patch, TOUCH_KINDS, Taxel, Taxels, TouchKind, TouchRanges,
};
use ndarray::Array2;

/// Distance from the arm's axis to the outside of its skin, metres.
const SURFACE: f64 = 0.043;
/// Time between two samples of a touch, seconds.
const STEP: f64 = 5e-3;
/// Maximum speed of any part of a hand, m/s.
const FASTEST: f64 = 2.0;

fn forearm(pitch: f64) -> Patch {
    let taxel = Taxel {
        radius: 0.5 * pitch,
        stiffness: 100.0,
        damping: 0.0,
        stroke: 6e-3,
    };
    let layout = Layout::cylinder(SURFACE - taxel.radius, 0.19, 4.6, pitch).unwrap();
    Patch::new("forearm", layout, Taxels::Equal(taxel)).unwrap()
}

fn touch(kind: TouchKind, number: u64) -> HumanTouch {
    let seed = Seed::new(2018).numbered(number);
    HumanTouch::draw(kind, &TouchRanges::usual(kind), SURFACE, &seed).unwrap()
}

/// Returns a touch at many times, including its start and end.
fn film(touch: &HumanTouch) -> Vec<HandState> {
    let n = (touch.duration() / STEP).ceil() as usize;
    (0..=n).map(|k| touch.at(k as f64 * STEP)).collect()
}

/// Presses a hand into a skin.
fn press(skin: &Patch, state: &HandState) -> Workspace {
    let mut workspace = Workspace::new();
    let hand: [Model; 1] = [state.spheres().into()];
    Press::new(skin, &hand, &[state.patch_from_hand], Until::Pose)
        .with_contacts()
        .run(&mut workspace)
        .unwrap();
    workspace
}

/// Returns the spring force Σ k δ in newtons, and the position of the centre of pressure: metres along the arm, radians around it.
fn felt(skin: &Patch, state: &HandState) -> (f64, Option<(f64, f64)>) {
    let load = spring_load(skin, press(skin, state).contacts());
    let place = load.center_of_pressure.map(|p| (p.z, p.y.atan2(p.x)));
    (load.spring_force, place)
}

fn deepest(touch: &HumanTouch) -> HandState {
    let states = film(touch).into_iter();
    let deepest = states.min_by(|a, b| a.height.total_cmp(&b.height));
    deepest.unwrap()
}

#[test]
fn every_touch_is_drawn_from_its_ranges() {
    for kind in TOUCH_KINDS {
        let ranges = TouchRanges::usual(kind);
        for number in 0..200 {
            let touch = touch(kind, number);
            assert!(ranges.depth.contains(&touch.depth));
            assert!(ranges.rise.contains(&touch.rise) && ranges.hold.contains(&touch.hold));
            assert!(ranges.contacts.contains(&touch.contacts));
            assert!(ranges.travel.contains(&touch.travel));
            assert!(ranges.along.contains(&touch.along) && ranges.around.contains(&touch.around));
            let is_flat = matches!(kind, TouchKind::Shove | TouchKind::Grab);
            assert!(ranges.fingers.contains(&touch.fingers) || is_flat && touch.fingers == 5);
            let lengthwise = touch.direction.sin().asin().abs();
            assert!(lengthwise <= ranges.direction.end() + 1e-12);
            let start = touch.at(0.0);
            assert!(ranges.hand_length.contains(&start.hand.length));
            assert!(ranges.clearance.contains(&start.height));
            assert!(touch.duration() < 3.2, "{kind:?} of {} s", touch.duration());
        }
    }
}

#[test]
fn no_part_of_a_hand_jumps() {
    let step = 1e-3;
    for kind in TOUCH_KINDS {
        for number in 0..6 {
            let touch = touch(kind, number);
            let places = |time: f64| {
                let state = touch.at(time);
                let strands = state.hand.strands().concat().into_iter();
                let place = |ball: bubbletouch::objects::Sphere| {
                    state.patch_from_hand.transform_point(ball.center)
                };
                strands.map(place).collect::<Vec<_>>()
            };
            let mut before = places(-step);
            for k in 0..(touch.duration() / step) as usize + 2 {
                let now = places(k as f64 * step);
                for (a, b) in before.iter().zip(&now) {
                    let speed = a.distance(*b) / step;
                    assert!(speed < FASTEST, "{kind:?}: {speed} m/s");
                }
                before = now;
            }
        }
    }
}

#[test]
fn a_hand_starts_and_ends_in_the_air_and_touches_in_between() {
    let skin = forearm(6e-3);
    for kind in TOUCH_KINDS {
        let mut n_missed = 0;
        for number in 0..40 {
            let touch = touch(kind, number);
            for time in [-1.0, 0.0, touch.duration(), touch.duration() + 1.0] {
                assert_eq!(felt(&skin, &touch.at(time)).0, 0.0, "{kind:?} {number}");
            }
            n_missed += usize::from(felt(&skin, &deepest(&touch)).0 == 0.0);
        }
        // A light fingertip between taxels deflects none, and neither does a hand beyond the end of the skin.
        assert!(n_missed <= 2, "{n_missed} of 40: {kind:?}");
    }
}

#[test]
fn a_hand_goes_exactly_as_deep_as_it_says() {
    // For dense taxels, the deepest one is as deep as the hand.
    let skin = forearm(1.5e-3);
    for number in 0..10 {
        let touch = touch(TouchKind::Tap, number);
        let state = deepest(&touch);
        assert!((state.height + touch.depth).abs() < 1e-5 || touch.hold < STEP);
        let pressed = press(&skin, &state);
        let most = pressed.deflections().iter().copied().fold(0.0, f64::max);
        assert!(most <= -state.height + 1e-9, "{most} for {}", state.height);
        assert!(most > -state.height - 3e-4, "{most} for {}", state.height);
    }
}

#[test]
fn a_tap_and_a_hold_of_the_same_name_differ_in_time_only() {
    for number in 0..40 {
        let [tap, hold] = [TouchKind::Tap, TouchKind::Hold].map(|kind| touch(kind, number));
        let instant = |touch: &HumanTouch| {
            let start = touch.duration() - touch.hold;
            touch.at(0.5 * start + 0.5 * touch.hold)
        };
        let (a, b) = (instant(&tap), instant(&hold));
        assert_eq!(a.hand, b.hand);
        let moved = a.patch_from_hand.translation - b.patch_from_hand.translation;
        assert!(moved.length() < 1e-9, "{moved}");
        assert!(tap.hold < 0.2 + 1e-12 && hold.hold >= 0.25);
        assert!((hold.duration() - tap.duration() - hold.hold + tap.hold).abs() < 1e-9);
    }
}

#[test]
fn a_pat_has_as_many_contacts_as_it_says_and_all_others_have_one() {
    for kind in TOUCH_KINDS {
        for number in 0..40 {
            let touch = touch(kind, number);
            let presses: Vec<bool> = film(&touch).iter().map(|s| s.height < 0.0).collect();
            let begins = presses.windows(2).filter(|pair| !pair[0] && pair[1]);
            assert_eq!(begins.count(), touch.contacts, "{kind:?} {number}");
            assert_eq!(touch.contacts > 1, kind == TouchKind::Pat);
        }
    }
}

#[test]
fn the_centre_of_pressure_of_a_stroke_travels_its_length_its_way() {
    let skin = forearm(3e-3);
    let fingertip = TouchRanges {
        fingers: vec![1],
        ..TouchRanges::usual(TouchKind::Stroke)
    };
    for number in 0..12 {
        let seed = Seed::new(7).numbered(number);
        let touch = HumanTouch::draw(TouchKind::Stroke, &fingertip, SURFACE, &seed).unwrap();
        let pressed = film(&touch);
        let pressed: Vec<_> = pressed
            .iter()
            .filter(|s| s.height < -0.9 * touch.depth)
            .collect();
        let ends = [pressed[0], pressed[pressed.len() - 1]];
        let [a, b] = ends.map(|state| felt(&skin, state).1.unwrap());
        let (along, around) = (b.0 - a.0, SURFACE * (b.1 - a.1));
        let (sin, cos) = touch.direction.sin_cos();
        for (moved, expected) in [(along, touch.travel * cos), (around, touch.travel * sin)] {
            assert!((moved - expected).abs() < 3e-3, "{moved} m for {expected}");
        }
    }
}

#[test]
fn shoves_and_grabs_push_harder_than_taps() {
    let skin = forearm(6e-3);
    let mean = |kind: TouchKind| {
        let forces = (0..40).map(|number| {
            let states = film(&touch(kind, number));
            let some = states.iter().step_by(4);
            some.map(|state| felt(&skin, state).0).fold(0.0, f64::max)
        });
        forces.sum::<f64>() / 40.0
    };
    let tap = mean(TouchKind::Tap);
    let (shove, grab) = (mean(TouchKind::Shove), mean(TouchKind::Grab));
    assert!(
        tap > 0.1 && shove > 2.0 * tap && grab > 2.0 * tap,
        "{tap} {shove} {grab} N"
    );
}

#[test]
fn a_grab_closes_its_fingers_around_the_arm_and_opens_them() {
    let skin = forearm(6e-3);
    let bent = |finger: &FingerPose| finger.knuckle + finger.middle + finger.end;
    let angles = |state: &HandState| {
        let workspace = press(&skin, state);
        let touched = workspace.contacts().iter();
        let angles: Vec<f64> = touched.map(|c| c.point.y.atan2(c.point.x)).collect();
        let most = angles.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most - angles.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let mut wider = 0;
    for number in 0..20 {
        let grab = touch(TouchKind::Grab, number);
        let states = film(&grab);
        let (start, end) = (&states[0], &states[states.len() - 1]);
        assert_eq!((start.closed, end.closed), (0.0, 0.0));
        let closed = states.iter().find(|state| state.closed == 1.0).unwrap();
        let mut turned = 0.0;
        for (open, closed) in start.hand.fingers.iter().zip(&closed.hand.fingers) {
            assert!(bent(closed) >= bent(open), "{number}");
            turned += bent(closed) - bent(open);
        }
        assert!(turned > 2.0, "{number}: {turned} rad of four fingers");
        let is_laid_on = |s: &&HandState| s.height == -grab.depth && s.closed < 1e-3;
        let laid_on = states.iter().find(is_laid_on).unwrap();
        wider += usize::from(angles(closed) > angles(laid_on) + 0.5);
    }
    assert!(wider >= 16, "{wider} of 20 reach around the arm");
}

/// Change of the ranges from which a touch is drawn.
type Change = fn(&mut TouchRanges);

#[test]
fn what_no_hand_can_do_is_refused_by_its_name() {
    let refused = |ranges: &TouchRanges, radius: f64, words: &str| {
        let drawn = HumanTouch::draw(TouchKind::Tap, ranges, radius, &Seed::new(1));
        let error = drawn.unwrap_err().to_string();
        assert!(error.starts_with(words), "{error}");
    };
    let none = "fingers: none; at least one number, 1 to 5";
    #[allow(clippy::reversed_empty_ranges)]
    let changes: [(Change, &str); 5] = [
        (
            |of| of.depth = 3e-3..=1e-3,
            "range of depth: 0.003 to 0.001",
        ),
        (|of| of.rise = 0.1..=f64::NAN, "range of rise: 0.1 to NaN"),
        (
            |of| of.hold = 0.0..=f64::INFINITY,
            "range of hold: 0 to inf",
        ),
        (|of| of.fingers.clear(), none),
        (
            |of| of.contacts = 2..=3,
            "range of lift: 0 m between contacts",
        ),
    ];
    let usual = TouchRanges::usual(TouchKind::Tap);
    for (change, words) in changes {
        let mut ranges = usual.clone();
        change(&mut ranges);
        refused(&ranges, SURFACE, &format!("tap, {words}"));
    }
    refused(&usual, f64::NAN, "radius of the arm: NaN m; ");
}

const STUDY: &str = include_str!("../fixtures/texts/human_touch.toml");

fn laid_out(text: &str) -> bubbletouch::Result<(Plan, HumanTouches, Sweep)> {
    let spec = StudySpec::parse("study.toml", text)?;
    let plan = Plan::new("study.toml", spec)?;
    let human = plan.spec.human_touch.as_ref();
    let human = human.expect("a study of human touches");
    let touches = HumanTouches::draw(human, &Seed::new(plan.spec.seed))?;
    let sweep = Sweep::new(&plan, &touches)?;
    Ok((plan, touches, sweep))
}

fn outcome(kinds: &str) -> Tables {
    let (plan, touches, _) = laid_out(&STUDY.replace("KINDS", kinds)).unwrap();
    let study = RecognitionStudy::new(plan, Box::new(touches)).unwrap();
    study.run(&Silent).unwrap()
}

fn accuracies(outcome: &Tables) -> Vec<f64> {
    let summary = outcome.summary.iter();
    summary.map(|(_, score)| score.accuracy).collect()
}

#[test]
fn time_tells_kinds_apart_that_one_frame_does_not() {
    let found = accuracies(&outcome(""));
    let [deepest, _, summarised, course] = found[..] else {
        panic!("{found:?}")
    };
    let is_told = summarised > deepest + 0.2 && course > deepest + 0.3 && course > 0.75;
    assert!(is_told, "{found:?}");
    let found = accuracies(&outcome("kinds = [\"tap\", \"hold\"]"));
    // One frame cannot tell a tap from a hold.
    let is_told = (0.2..0.8).contains(&found[0]) && found[3] > 0.9;
    assert!(is_told, "{found:?}");
}

#[test]
fn touches_are_balanced_and_alone_the_same() {
    let (plan, touches, sweep) = laid_out(&STUDY.replace("KINDS", "")).unwrap();
    assert_eq!(touches.class_names(), TOUCH_KINDS.map(TouchKind::name));
    for (label, kind) in TOUCH_KINDS.into_iter().enumerate() {
        assert_eq!(sweep.labels.iter().filter(|&&l| l == label).count(), 40);
        let of_kind = touches.with_label(label).iter();
        assert!(of_kind.clone().all(|t| t.touch.kind == kind));
        let fits = |t: &bubbletouch::study::RecordedTouch| {
            t.onset >= 0.0 && t.onset + t.touch.duration() <= 3.2 + 1e-9
        };
        assert!(of_kind.clone().all(fits));
    }
    // A study with fewer kinds and fewer touches has the same touches.
    let fewer = STUDY.replace("KINDS", "kinds = [\"pat\", \"tap\"]");
    let (_, fewer, _) = laid_out(&fewer.replace("per_kind = 40", "per_kind = 12")).unwrap();
    assert_eq!(fewer.with_label(0), &touches.with_label(4)[..12]);
    assert_eq!(fewer.with_label(1), &touches.with_label(0)[..12]);
    // Frame by frame, as with manual presses, with new spheres each time.
    let human = plan.spec.human_touch.as_ref().unwrap();
    let array = &plan.array;
    let skin = human.skin(array).unwrap();
    let frames = touches.simulate((array, human.n_frames()), &Silent);
    let deflection = frames.to_array();
    assert_eq!(deflection.dim(), (240 * 49, 1024));
    let mut workspace = Workspace::new();
    for number in [3, 100, 205] {
        let recorded = &touches.touches[number];
        for frame in 0..human.n_frames() {
            let state = recorded.touch.at(frame as f64 / 15.0 - recorded.onset);
            let workspace = press(&skin, &state);
            let row = deflection.row(number * human.n_frames() + frame);
            for (&stored, &pressed) in row.iter().zip(workspace.deflections()) {
                assert!((stored - pressed).abs() < 1e-8);
            }
        }
        let mut alone = Array2::zeros((human.n_frames(), 1024));
        let (interval, out) = (human.interval(), alone.view_mut());
        record_touch(&skin, recorded, interval, out, &mut workspace);
        let first = number * human.n_frames();
        let rows = deflection.slice(ndarray::s![first..first + human.n_frames(), ..]);
        assert_eq!(alone.mapv(f64::from), rows);
    }
}

#[test]
fn rows_and_columns_of_the_array_run_along_and_around_the_arm() {
    let (plan, touches, _) = laid_out(&STUDY.replace("KINDS", "")).unwrap();
    let skin = touches.spec.skin(&plan.array).unwrap();
    let centers = skin.layout().centers();
    let place = |row: usize, column: usize| {
        let p = centers[row * 32 + column];
        (p.z, p.y.atan2(p.x))
    };
    let (first, right, up) = (place(0, 0), place(0, 1), place(1, 0));
    assert!((up.0 - first.0 - 6e-3).abs() < 1e-12 && (up.1 - first.1).abs() < 1e-12);
    assert!((right.0 - first.0).abs() < 1e-12 && right.1 > first.1);
    assert!(
        (place(0, 31).1 + first.1).abs() < 1e-12,
        "the middle is at +x"
    );
}

#[test]
fn tables_name_frames_and_temporal_features_and_the_written_study_runs_again() {
    let case = Case::new();
    let text = STUDY.replace("KINDS", "kinds = [\"tap\", \"pat\", \"grab\"]");
    case.file("study.toml", text.replace("per_kind = 40", "per_kind = 8"));
    case.succeeds("run study.toml --out found");
    let read = |name: &str| case.bytes(&format!("found/{name}"));
    let text = String::from_utf8(read("summary.csv")).unwrap();
    let columns = ",frames,temporal_features,features,";
    says(&text, &[columns, ",49,stacked_8,raw,"]);
    let page = String::from_utf8(read("report.html")).unwrap();
    assert!(page.contains("its confusion matrix is diagonal"));
    // The resolved study can be run again.
    let again = String::from_utf8(read("study.toml")).unwrap();
    assert!(!again.contains("[objects]") && !again.contains("[touches]"));
    laid_out(&again).unwrap();
}
