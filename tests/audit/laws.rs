//! Laws of audits: they depend on data and seed alone, and a clock that wraps around continues.

use crate::sets::*;
use bubbletouch::audit::{AuditData, Finding, Verdict};
use ndarray::Array2;

#[test]
fn an_audit_depends_on_data_and_seed_alone() {
    let findings = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let findings = pool.unwrap().install(|| Set::discs(3).findings());
        format!("{findings:?}")
    };
    assert_eq!(findings(1), findings(3));
}

/// Returns the finding of a check.
fn finding(set: Set, check: &str) -> Finding {
    let mut findings = set.findings().into_iter();
    findings.find(|finding| finding.check == check).unwrap()
}

/// The user decides what is part of the claim: the same number is a note or a fault.
#[test]
fn what_is_not_claimed_becomes_a_fault_and_the_named_split_a_note() {
    let verdict = |names: Option<&str>| {
        let mut set = Set::discs(1);
        set.options.not_claimed = names.map(|name| vec![name.to_owned()]);
        finding(set, "mean").verdict
    };
    assert_eq!(verdict(None), Verdict::Note);
    assert_eq!(verdict(Some("mean")), Verdict::Fault);
}

/// Readings without classes: a touch whose nearest touches belong to one other class is chance, and no wrong label.
#[test]
fn no_label_is_doubtful_if_no_classifier_recognises_more_than_chance() {
    let mut rng = rng("blind", 1);
    let labels = shuffled_labels(&mut rng, 4, 100);
    let set = Set::new(rng, labels, 1, |_, _, rng| row(64, |_| normal(rng)));
    assert_eq!(finding(set, "labels").verdict, Verdict::NotChecked);
}

/// Readings fall under pressure, and the full scale of the converter is above them; a full scale of 0 is reached.
#[test]
fn touches_at_the_full_scale_are_counted_on_its_side_of_rest() {
    let share = |full_scale: f64| {
        let mut set = Set::discs(2);
        set.frames.mapv_inplace(|x| (0.9 - x).max(0.0));
        set.full_scale = Some(full_scale);
        finding(set, "saturation").value.unwrap()
    };
    assert_eq!(share(1.5), 0.0);
    let at_zero = share(0.0);
    assert!((0.1..0.9).contains(&at_zero), "{at_zero}");
}

/// Law: times of a clock that wraps around continue, and times that fall back otherwise are sorted by value.
#[test]
fn a_clock_that_wraps_around_continues() {
    let sorted = |time: &dyn Fn(usize) -> f64| {
        let mut data = AuditData {
            frames: Array2::from_shape_fn((60, 1), |(touch, _)| touch as f64),
            n_frames: 1,
            ..AuditData::default()
        };
        data.sort_by_time(&(0..60).map(time).collect::<Vec<_>>());
        data.frames.into_raw_vec_and_offset().0
    };
    let in_order: Vec<f64> = (0..60).map(|touch| touch as f64).collect();
    let start = 4_294_967_296.0 - 20_500.0;
    for factor in [1.0, 1e-3, 1e-6] {
        let wrapped = |touch: usize| (start + 1000.0 * touch as f64) % 4_294_967_296.0 * factor;
        assert_eq!(sorted(&wrapped), in_order);
    }
    let wrapping: [fn(usize) -> f64; 4] = [
        // Signed counters, and 16 bits.
        |touch| f64::from((2_147_480_000 + 500 * touch as u32) as i32),
        |touch| f64::from((60_000 + 500 * touch as u32) as u16),
        // A time of day over midnight in seconds, and the second of a minute with two wraps.
        |touch| (86_000.0 + 37.5 * touch as f64) % 86_400.0,
        |touch| (30.0 + 2.2 * touch as f64) % 60.0,
    ];
    for wrapped in wrapping {
        assert_eq!(sorted(&wrapped), in_order);
    }
    // Touches that are listed by class.
    let by_class = sorted(&|touch| (touch % 20 * 3 + touch / 20) as f64);
    let expected: Vec<f64> = (0..60).map(|k| (k / 3 + 20 * (k % 3)) as f64).collect();
    assert_eq!(by_class, expected);
}
