//! A small kind of study has all abilities of a study: it runs, continues with its journal, is verified, and is reported again.

#[path = "../../../examples/own_kind/saturation.rs"]
mod saturation;

use crate::engine::journal::journal_file::{JOURNAL_FILE, Journal};
use crate::engine::progress::Silent;
use crate::engine::provenance::Manifest;
use crate::engine::work_items::{Part, RunOptions};
use crate::report::page::StudyAbout;
use crate::report::study_folder::ChartFormat;
use crate::studies::{AnyStudy, Loaded, Source};
use saturation::SaturationStudy;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

const STUDY: &str = include_str!("../../../examples/own_kind/saturation.toml");

fn load(text: &str) -> Loaded<SaturationStudy> {
    Loaded::load(&Source::of_text("saturation.toml", text)).unwrap()
}

/// Runs the work items of a study that its folder does not have yet; returns their number.
fn run(study: &Loaded<SaturationStudy>, folder: &Path) -> usize {
    let journal = Journal::open(&folder.join(JOURNAL_FILE), study.identity()).unwrap();
    let n_pending = study.n_pending(Part::All, &journal);
    let options = RunOptions {
        journal: &journal,
        ..RunOptions::whole(&Silent)
    };
    let outcome = study.run(&options).unwrap();
    let manifest = Manifest::ended(study.identity(), SystemTime::now());
    study
        .write(folder, &outcome, manifest, ChartFormat::Svg)
        .unwrap();
    n_pending
}

#[test]
fn a_small_kind_of_study_runs_continues_is_verified_and_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let study = load(STUDY);
    assert_eq!([run(&study, folder), run(&study, folder)], [4, 0]);
    let table = fs::read_to_string(folder.join("saturation.csv")).unwrap();
    // A touch of 4 mm pushes the middle of the ball beyond the stroke of 2 mm, and a touch of 1 mm does not.
    let ball = "\ntennis_ball,1,0.5\ntennis_ball,60,0.0\n";
    assert!(table.ends_with(ball), "{table}");
    // One more value adds the work of this value alone.
    let more = load(&STUDY.replace("[1, 60]", "[1, 2, 60]"));
    assert_eq!(run(&more, folder), 2);
    let said = more.verify(folder, 6, 0, &Silent).unwrap();
    assert!(said.starts_with("6 of 6 work items ran again"), "{said}");
    let drawn = || fs::read(folder.join("saturated.svg")).unwrap();
    let before = drawn();
    fs::remove_file(folder.join("saturated.svg")).unwrap();
    let about = StudyAbout {
        manifest: Manifest::read(folder).unwrap(),
        ..StudyAbout::default()
    };
    more.report(folder, about).unwrap();
    assert!(before == drawn());
    // The version of the kind is a part of the program.
    let mut earlier = more.identity().clone();
    assert!(earlier.program.ends_with(" with saturation@1"));
    earlier.program = earlier.program.replace("@1", "@2");
    let refused = Journal::open(&folder.join(JOURNAL_FILE), &earlier).unwrap_err();
    let said = refused.to_string();
    assert!(said.contains("saturation@1, is bubbletouch"), "{said}");
    // All results depend on the stroke.
    let other = load(&STUDY.replace("stroke_mm = 2.0", "stroke_mm = 3.0"));
    let refused = Journal::open(&folder.join(JOURNAL_FILE), other.identity()).unwrap_err();
    let said = refused.to_string();
    assert!(said.contains("skin.stroke_mm: was 2.0, is 3.0"), "{said}");
}
