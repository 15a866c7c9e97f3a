//! What the engine asks of a study of speed against accuracy.

use super::plan::SpeedAccuracyPlan;
use super::spec::SpeedAccuracyStudySpec;
use super::study::{CHAINS, CONTACT, SpeedAccuracyStudy};
use super::subject::load_subjects;
use super::{answers, charts};
use crate::error::Result;
use crate::kinds::{About, Facts, Kind, Source};
use crate::study::objects_content;
use crate::study::pieces::{PieceStudy, Scale};
use crate::table::{ChartSpec, Table};
use crate::toml_text;
use std::path::Path;

impl Kind for SpeedAccuracyStudy {
    const ABOUT: About = About {
        table: "speed_accuracy",
        words: "a study of what accuracy costs",
        may_change: &[
            "question",
            "expected",
            "speed_accuracy.contact.dt_ms",
            "speed_accuracy.recognition.pitch_mm",
            "speed_accuracy.recognition.tolerances_mm",
            "speed_accuracy.recognition.ensemble",
            "speed_accuracy.recognition.ratio",
            "speed_accuracy.recognition.classifier",
        ],
    };

    fn load(source: &Source) -> Result<Self> {
        let mut spec = SpeedAccuracyStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        let contact = spec.speed_accuracy.contact.as_mut();
        let scans = contact.and_then(|contact| contact.scans.as_mut());
        match (&source.objects, scans) {
            (Some(folder), Some(scans)) => scans.meshes.clone_from(folder),
            _ => source.replace_objects(&mut spec.objects),
        }
        let plan = SpeedAccuracyPlan::new(&source.place, &source.folder, spec)?;
        Ok(Self {
            subjects: load_subjects(&plan.spec.objects)?,
            scans: plan
                .scanned()
                .map_or(Ok(Vec::new()), |scans| load_subjects(&scans))?,
            packings: source.packings.clone(),
            plan,
        })
    }

    fn facts(&self) -> Result<Facts> {
        let spec = &self.plan.spec;
        let mut content = objects_content(&spec.objects)?;
        if let Some(scans) = self.plan.scanned() {
            let scans = objects_content(&scans)?.into_iter();
            content.extend(scans.map(|(name, hash)| (format!("scan {name}"), hash)));
        }
        Ok(Facts::of(toml_text::write(spec), content))
    }

    fn scale(&self) -> Scale {
        let mut touches = Vec::new();
        let mut bytes = 0.0;
        if let Some(contact) = &self.plan.parts().contact {
            touches.push(format!("{} of each object in contact", contact.touches));
        }
        if let Some(sweep) = &self.plan.recognition {
            let spec = &sweep.spec;
            let per_object = spec.training_touches + spec.test_touches;
            touches.push(format!("{per_object} of each in recognition"));
            let n_taxels = sweep.patches.iter().map(|patch| patch.grid.n_taxels());
            let n_taxels = n_taxels.max().unwrap_or(0);
            bytes = 8.0 * (spec.objects * per_object * n_taxels) as f64;
        }
        Scale {
            objects: self.subjects.len().to_string(),
            touches: touches.join(", "),
            n_configurations: self.pieces().len(),
            bytes,
            ..Scale::default()
        }
    }

    fn read(folder: &Path) -> Result<Vec<Table>> {
        let parts = [CONTACT.read(folder)?, CHAINS.read(folder)?];
        Ok(parts.into_iter().flatten().collect())
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts::charts(tables)
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers::answers(&self.plan, tables)
    }
}
