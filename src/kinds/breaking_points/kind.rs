//! What the engine asks of a study of breaking points.

use super::plan::BreakingPointsPlan;
use super::spec::BreakingPointsSpec;
use super::study::{ACCURACY, BREAKS, BreakingPointsStudy, N_OBJECTS, SUMMARY, TIMING, n_read};
use super::value::object_specs;
use super::{answers, charts};
use crate::error::Result;
use crate::kinds::{About, Facts, Kind, Source};
use crate::study::object_files::objects_content;
use crate::study::pieces::Scale;
use crate::table::{ChartSpec, Table};
use crate::toml_text;
use std::collections::BTreeMap;
use std::path::Path;

impl Kind for BreakingPointsStudy {
    const ABOUT: About = About {
        table: "breaking_points",
        words: "a study of where recognition breaks",
        may_change: &["question", "expected", "breaking_points"],
    };

    fn load(source: &Source) -> Result<Self> {
        let mut spec = BreakingPointsSpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        source.replace_objects(&mut spec.objects);
        Ok(Self {
            plan: BreakingPointsPlan::new(&source.place, spec)?,
            packings: source.packings.clone(),
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        let values = self.plan.ways.iter().flat_map(|way| &way.values);
        let mut content = BTreeMap::new();
        for objects in object_specs(values.flat_map(|value| value.plans())) {
            content.extend(objects_content(objects)?);
        }
        Ok(Facts::of(toml_text::write(spec), content))
    }

    fn scale(&self) -> Scale {
        let values = || self.plan.ways.iter().flat_map(|way| &way.values);
        let touches = values().map(|value| value.learned.placement.per_object.unwrap_or(1));
        let most_read = values().map(n_read).max().unwrap_or(0);
        Scale {
            objects: "those of each value".to_owned(),
            touches: format!(
                "up to {} of each object at each value",
                touches.max().unwrap_or(0)
            ),
            n_configurations: values()
                .map(|value| value.learned.spec.recognition.classifier.values().len())
                .sum(),
            // Frames in single precision.
            item_bytes: 4.0 * (N_OBJECTS * most_read) as f64,
            ..Scale::default()
        }
    }

    fn read(folder: &Path) -> Result<Vec<Table>> {
        Ok(vec![
            ACCURACY.read(folder)?,
            SUMMARY.read(folder)?,
            BREAKS.read(folder)?,
            TIMING.read(folder)?,
        ])
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts::charts(&self.plan.ways, tables)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers::answers(&self.plan.ways, tables)
    }
}
