//! Picture of a few test frames: without noise, with noise, and reconstructed by several configurations.

use crate::report::pictures::snapshots::{Snapshots, snapshots};
use crate::sensing::{Reconstructor, SensedDictionary};
use crate::studies::prelude::*;
use crate::studies::reconstruction::charts::{cell_words, noise_words};
use crate::studies::reconstruction::study::ReconstructionStudy;
use ndarray::Array2;

impl ReconstructionStudy {
    /// Returns a picture of test frames at the largest noise level, or an empty list if the study has no results.
    pub(super) fn sample_frames(&self, tables: &[Table]) -> Result<Vec<NamedPicture>> {
        let Some(configurations) = tables
            .first()
            .filter(|configurations| configurations.n_rows > 0)
        else {
            return Ok(Vec::new());
        };
        let touches = self.frames(&Silent)?;
        let loudest = touches
            .noisy
            .iter()
            .max_by(|a, b| a.level.total_cmp(&b.level));
        let Some(noisy) = loudest else {
            return Ok(Vec::new());
        };
        let all = self.plan.configurations();
        let shown = shown_rows(configurations, noisy.level);
        let read = touches.pick(&noisy.frames);
        let back = |&row: &usize| {
            let configuration = &all[configurations.number("configuration", row) as usize];
            let dictionary = touches.dictionary(&self.plan, configuration.dictionary)?;
            let projection = self
                .plan
                .projection(configuration.ensemble, configuration.measurements)?;
            let sensed = SensedDictionary::new(&projection, dictionary)?;
            let effort = &self.plan.spec.reconstruction.effort();
            let reconstructor =
                Reconstructor::new(configuration.solver, &sensed, effort, noisy.std)?;
            let measured = projection.measure(read.view());
            let [solver, m] =
                ["solver", "measurements"].map(|name| configurations.words(name, row));
            let back = reconstructor.reconstruct(measured.view())?.frames;
            Ok((format!("{solver} of m = {m}"), back))
        };
        let back = shown.iter().map(back).collect::<Result<Vec<_>>>()?;
        let clean = touches.pick(&touches.test);
        let mut frames = Vec::new();
        for (sample, (_, name)) in touches.shown.iter().enumerate() {
            let mut add = |name: String, of_all: &Array2<f64>| {
                let values = of_all.row(sample).to_vec();
                let ImageShape { ny, nx } = self.plan.array.shape();
                let frame = Array2::from_shape_vec((ny, nx), values);
                frames.push((name, frame.expect("one value a taxel")));
            };
            add(name.replace('_', " "), &clean);
            add("full, noisy".to_owned(), &read);
            for (name, back) in &back {
                add(name.clone(), back);
            }
        }
        let noise = noise_words(configurations, shown.first().copied().unwrap_or(0));
        let words: Vec<String> = shown
            .iter()
            .map(|&row| cell_words(configurations, row))
            .collect();
        let picture = snapshots(&Snapshots {
            frames,
            pitch_mm: millimetres(self.plan.array.pitch()),
            quantity: self.plan.quantity(),
            caption: format!("{noise}; {}", words.join("; ")),
        })?;
        Ok(vec![NamedPicture {
            name: "frames".to_owned(),
            title: "Sample frames and what came back of them".to_owned(),
            png: picture.small_png()?,
            size: (picture.width / 2, picture.height / 2),
        }])
    }
}

/// Returns the two table rows whose frames are shown for a noise level. One is the best configuration whose number of measurements is nearest to a quarter of
/// the taxels. The other is the best configuration with the fewest measurements.
fn shown_rows(configurations: &Table, level: f64) -> Vec<usize> {
    let of_level: Vec<usize> = (0..configurations.n_rows)
        .filter(|&row| configurations.number("noise_std", row) == level)
        .filter(|&row| configurations.word("ensemble", row) != "identity")
        .collect();
    let least = |of: &dyn Fn(usize) -> f64| {
        let rows = of_level.iter().copied();
        rows.min_by(|&a, &b| of(a).total_cmp(&of(b)))
    };
    let m = |row| configurations.number("measurements", row);
    let quarter = least(&|row| (configurations.number("ratio", row) / 4.0).ln().abs());
    let best = |like: usize| {
        least(&|row| match m(row) == m(like) {
            true => configurations.number("error", row),
            false => f64::INFINITY,
        })
    };
    let like = [quarter, least(&m)].into_iter().flatten();
    like.filter_map(best).collect()
}
