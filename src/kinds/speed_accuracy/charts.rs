//! What is charted and said: what each choice costs and gives, with the fronts.

use super::study::{CONTACT_PARETO, RECOGNITION_PARETO, SpeedAccuracyStudy};
use crate::kinds::Findings;
use crate::report::chart::front_ends;
use crate::table::{ChartSpec, Mark, Table};

impl Findings for SpeedAccuracyStudy {
    /// A chart of contact, of decisions and of trainings: of those parts that there are.
    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        let chart = |name: &str, (table, x, y): (&'static str, &str, &str)| ChartSpec {
            name: format!("speed_accuracy_{name}"),
            table,
            x: x.to_owned(),
            y: y.to_owned(),
            mark: Mark::Points,
            front: true,
            ..ChartSpec::default()
        };
        let contact = ChartSpec {
            title: "Contact: error of the deflections against the time of a touch".to_owned(),
            note: "Medians over objects. What is right says exact contact.".to_owned(),
            lines: vec!["way".to_owned()],
            panels: Some("touched".to_owned()),
            ..chart(
                "contact",
                (CONTACT_PARETO.name(), "us_per_touch", "error_mm"),
            )
        };
        let decision = ChartSpec {
            title: "Recognition: accuracy against the time of a decision".to_owned(),
            note: "Press, noise, compression and answer of one touch, one thread; tested on the exact objects.".to_owned(),
            lines: vec!["classifier".to_owned()],
            ..chart("decision", (RECOGNITION_PARETO.name(), "decision_us", "accuracy"))
        };
        let training = ChartSpec {
            title: "Recognition: accuracy against the time of a training".to_owned(),
            note: "One thread; tested on the exact objects.".to_owned(),
            lines: vec!["classifier".to_owned()],
            ..chart("training", (RECOGNITION_PARETO.name(), "fit_s", "accuracy"))
        };
        let all = [contact, decision, training].into_iter();
        let is_there = |chart: &ChartSpec| {
            let table = tables.iter().find(|table| table.file == chart.table);
            table.is_some_and(|table| table.n_rows > 0)
        };
        all.filter(is_there).collect()
    }

    /// The cheapest and the best of each front, and what was left out because it is not there.
    fn answers(&self, tables: &[Table]) -> Vec<String> {
        let charts = self.charts(tables).into_iter();
        let fronts = charts.filter_map(|chart| {
            let [cheapest, best] = front_ends(&chart, tables)?;
            Some(format!("{}, the front: {cheapest} … {best}.", chart.title))
        });
        let peers = self.plan.peers.as_ref().filter(|path| !path.exists());
        let peers =
            peers.map(|path| format!("Without other programs: there is no {}.", path.display()));
        let scans = self.plan.scans().filter(|scans| !scans.meshes.is_dir());
        let scans = scans.map(|scans| {
            let folder = scans.meshes.display();
            format!("Without scans: there is no folder {folder}; --objects names one.")
        });
        fronts.chain(peers).chain(scans).collect()
    }
}
