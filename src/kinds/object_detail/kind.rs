//! What the engine asks of a study of object detail.

use super::plan::ObjectDetailPlan;
use super::spec::ObjectDetailStudySpec;
use super::study::{COST, DETAIL, ObjectDetailStudy, RECOGNITION, SUMMARY, TIMING};
use super::variants::levels;
use super::{answers, charts};
use crate::error::Result;
use crate::kinds::{About, Facts, Kind, Source};
use crate::study::pieces::Scale;
use crate::study::{load_named_meshes, objects_content};
use crate::table::{ChartSpec, Table};
use crate::toml_text;
use std::path::Path;

impl Kind for ObjectDetailStudy {
    const ABOUT: About = About {
        table: "object_detail",
        words: "a study of how detailed objects are",
        may_change: &[
            "question",
            "expected",
            "object_detail.recognition.classifiers",
        ],
    };

    fn load(source: &Source) -> Result<Self> {
        let mut spec = ObjectDetailStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        source.replace_objects(&mut spec.objects);
        let plan = ObjectDetailPlan::new(&source.place, spec)?;
        Ok(Self {
            meshes: load_named_meshes(plan.meshes(), &plan.spec.objects)?,
            packings: source.packings.clone(),
            plan,
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        Ok(Facts::of(
            toml_text::write(spec),
            objects_content(&spec.objects)?,
        ))
    }

    fn scale(&self) -> Scale {
        let n_objects = self.meshes.len();
        let n_levels = levels(&self.plan).len();
        let per_object = self.plan.placement.per_object.unwrap_or(1);
        let learned = self.plan.recognition();
        let n_learned =
            learned.map_or(0, |learned| learned.training_touches + learned.test_touches);
        let n_classifiers = learned.map_or(0, |learned| learned.classifiers.len());
        let n_taxels = self.plan.patch.grid.n_taxels();
        let n_measurements = learned.map_or(0, |learned| learned.measurements);
        Scale {
            objects: format!("{n_objects} meshes, in {n_levels} models each"),
            touches: match n_learned {
                0 => format!("{per_object} of each model"),
                n => format!("{per_object} of each model, {n} of each for recognition"),
            },
            n_configurations: n_levels * (n_objects + n_classifiers),
            bytes: 8.0 * (n_objects * n_learned * n_levels * n_measurements) as f64,
            // Frames as they were, and as they are read.
            item_bytes: 12.0 * (n_learned * n_taxels) as f64,
        }
    }

    fn read(folder: &Path) -> Result<Vec<Table>> {
        let mut tables = vec![
            DETAIL.read(folder)?,
            SUMMARY.read(folder)?,
            TIMING.read(folder)?,
            COST.read(folder)?,
        ];
        tables.extend(RECOGNITION.read_if_there(folder)?);
        Ok(tables)
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts::charts(tables)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers::answers(tables)
    }
}
