//! Studies of what accuracy costs.

use super::piece_kind::PieceKind;
use super::study_args::StudyArgs;
use bubbletouch::Result;
use bubbletouch::report::page::StudyAbout;
use bubbletouch::report::speed_accuracy::{speed_accuracy_summary, write_speed_accuracy};
use bubbletouch::study::objects_content;
use bubbletouch::study::speed_accuracy::SpeedAccuracyStudy;
use bubbletouch::study::speed_accuracy::table::SpeedAccuracyTables;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub struct SpeedAccuracyKind(SpeedAccuracyStudy);

impl PieceKind for SpeedAccuracyKind {
    type Study = SpeedAccuracyStudy;

    fn load(args: &StudyArgs, packings: PathBuf) -> Result<Self> {
        let plan = args.speed_accuracy_plan()?;
        Ok(Self(SpeedAccuracyStudy::new(plan, Some(packings))?))
    }

    fn study(&self) -> &SpeedAccuracyStudy {
        &self.0
    }

    fn to_toml(&self) -> String {
        self.0.plan.spec.to_toml()
    }

    fn asked(&self) -> (&str, &str) {
        let spec = &self.0.plan.spec;
        (&spec.question, &spec.expected)
    }

    fn seed(&self) -> u64 {
        self.0.plan.spec.seed
    }

    fn content(&self) -> Result<BTreeMap<String, String>> {
        objects_content(&self.0.plan.spec.objects)
    }

    fn write(
        &self,
        tables: &SpeedAccuracyTables,
        folder: &Path,
        _about: &StudyAbout,
    ) -> Result<()> {
        write_speed_accuracy(folder, tables).map(drop)
    }

    fn words(&self, tables: &SpeedAccuracyTables, width: usize) -> String {
        let mut words = speed_accuracy_summary(tables, width);
        let contact = self.0.plan.contact.as_ref();
        let peers = contact.and_then(|contact| contact.peers.as_ref());
        if let Some(path) = peers.filter(|path| !path.exists()) {
            words += &format!("Without other programs: there is no {}\n", path.display());
        }
        words
    }
}
