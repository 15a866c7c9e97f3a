//! Charts and answers of a whole-body study.

use crate::error::Result;
use crate::report::study_content::NamedPicture;
use crate::studies::whole_body::memory_chart::memory_chart;
use crate::studies::whole_body::picture::picture_of_body;
use crate::studies::whole_body::plan::WholeBodyPlan;
use crate::table::{Along, ChartSpec, Mark, Rule, Shown, Table, short_number};

impl WholeBodyPlan {
    /// Returns charts of the computing time per step. Some show it by the number of taxels, of touched taxels and of spheres; others show the time of each
    /// stage in each scene.
    pub(crate) fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let (recognition, timing, steps) = (&tables[1], &tables[3], &tables[4]);
        let ladder = |series: &str, name: &str, (x, line): (&str, &str), size: &str| {
            of_series(steps, series).map(|shown| ChartSpec {
                shown: vec![shown],
                lines: vec![line.to_owned()],
                rules: vec![Rule::at(Along::Y, 1000.0, "a millisecond")],
                ..steps.chart(
                    name,
                    format!("Time of a step by the size of {size}"),
                    ("us_median", x),
                )
            })
        };
        let by_stage = of_series(timing, "scene").map(|shown| ChartSpec {
            shown: vec![shown],
            lines: vec!["compression".to_owned(), "n_threads".to_owned()],
            panels: Some("stage".to_owned()),
            mark: Mark::Points,
            rules: vec![Rule::at(Along::X, 1000.0, "a millisecond")],
            ..timing.chart(
                "time_by_stage",
                "From touch to answer: where the time of a step goes",
                ("name", "us_median"),
            )
        });
        let of_skin = "the skin, the touch the same";
        let of_touch = "the touch, the skin the same";
        let of_object = "the object, skin and touch the same";
        let taxels = ("n_taxels", "touched");
        let touched = ("touched_mean", "n_spheres");
        let spheres = ("n_spheres", "touched");
        let charts = [
            ladder("skin", "time_by_taxels", taxels, of_skin),
            ladder("touch", "time_by_touched", touched, of_touch),
            ladder("spheres", "time_by_spheres", spheres, of_object),
            by_stage,
            memory_chart(recognition),
        ];
        charts.into_iter().flatten().collect()
    }

    pub(crate) fn pictures(&self, tables: &[Table]) -> Result<Vec<NamedPicture>> {
        Ok(picture_of_body(self, &tables[0])?.into_iter().collect())
    }

    /// Returns answers about the time from touch to decision, its growth with the skin, steps per second, memory, and recognition.
    pub(crate) fn answers(&self, tables: &[Table]) -> Vec<String> {
        let (cases, recognition) = (&tables[0], &tables[1]);
        let (timing, steps) = (&tables[3], &tables[4]);
        let mut answers = Vec::new();
        let us = |row: usize| timing.number("us_median", row);
        let whole = (0..timing.n_rows).filter(|&row| timing.word("stage", row) == "whole");
        answers.extend(whole.max_by(|&a, &b| us(a).total_cmp(&us(b))).map(|row| {
            let [taxels, at_most, scene, compression] =
                ["n_taxels", "us_median", "name", "compression"].map(|name| timing.words(name, row));
            format!(
                "From touch to answer on {taxels} taxels: at most {at_most} (median over steps; scene {scene}, {compression})."
            )
        }));
        let skins = (0..steps.n_rows).filter(|&row| steps.word("series", row) == "skin");
        for rungs in steps.groups(&["touched"], skins) {
            let n_taxels = |row: &usize| steps.number("n_taxels", *row);
            let by_size = |a: &usize, b: &usize| n_taxels(a).total_cmp(&n_taxels(b));
            let ends = (
                rungs.iter().copied().min_by(by_size),
                rungs.iter().copied().max_by(by_size),
            );
            let (Some(first), Some(last)) = ends else {
                continue;
            };
            if n_taxels(&first) == n_taxels(&last) {
                continue;
            }
            let touched = rungs
                .iter()
                .map(|&row| steps.number("touched_mean", row).round());
            let fewest = touched.clone().fold(f64::INFINITY, f64::min);
            let most = touched.fold(0.0, f64::max);
            let touched = match fewest == most {
                true => short_number(most),
                false => format!("{} to {}", short_number(fewest), short_number(most)),
            };
            let growth = steps.number("us_median", last) / steps.number("us_median", first);
            let [smallest, taxels] = [first, last].map(|row| steps.words("n_taxels", row));
            answers.push(format!(
                "From {smallest} to {taxels} taxels with {touched} touched, the time of a step is {} times as long: {} ({} steps/s).",
                short_number((100.0 * growth).round() / 100.0),
                steps.words("us_median", last),
                short_number(steps.number("steps_per_s", last).round())
            ));
        }
        let bytes = cases.numbers("bytes_per_taxel").unwrap_or_default();
        answers.extend(bytes.iter().copied().reduce(f64::max).map(|most| {
            let most = short_number(most);
            format!("A body at rest takes at most {most} bytes a taxel.")
        }));
        answers.extend((0..recognition.n_rows).map(|row| {
            let [objects, m, compression] = ["n_objects", "n_measurements", "compression"]
                .map(|name| recognition.words(name, row));
            let [accuracy, low, high] = ["accuracy", "accuracy_low", "accuracy_high"]
                .map(|name| recognition.number(name, row));
            format!(
                "{objects} objects from {m} measurements of {compression}: accuracy {accuracy:.3} [{low:.3}, {high:.3}]."
            )
        }));
        answers
    }
}

/// Returns a filter for the rows of a scaling series; `None` if the table has no such rows.
fn of_series(table: &Table, series: &str) -> Option<Shown> {
    let mut rows = 0..table.n_rows;
    let row = rows.find(|&row| table.word("series", row) == series)?;
    table.shown("series", row)
}
