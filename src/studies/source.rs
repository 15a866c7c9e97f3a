//! Where a study comes from, and what overrides it.

use crate::error::{Error, Result};
use crate::files::SetName;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// A study's text, and what was asked for beside it.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// What errors call it: its file.
    pub place: String,
    /// TOML.
    pub text: String,
    /// The folder that paths in it are relative to.
    pub folder: PathBuf,
    /// Meshes or a file of objects that replace its objects.
    pub objects: Option<PathBuf>,
    /// Root of all randomness that replaces its own.
    pub seed: Option<u64>,
    /// Where packed meshes are kept from run to run.
    pub packings: Option<PathBuf>,
    /// Where its results go: what memory cannot hold is put there while it runs.
    pub results: PathBuf,
    /// Most bytes to hold; `None`: no ceiling.
    pub memory: Option<u64>,
}

impl Source {
    /// A text on its own, with nothing that overrides it.
    pub fn of_text(place: &str, text: &str) -> Self {
        Self {
            place: place.to_owned(),
            text: text.to_owned(),
            ..Self::default()
        }
    }

    /// The study of a folder of results, with nothing that overrides it.
    ///
    /// # Errors
    /// There is none, or it cannot be read.
    pub fn of_results(folder: &Path) -> Result<Self> {
        let path = folder.join("study.toml");
        let allowed = "the study of a folder that bubbletouch run wrote";
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|e| Error::unreadable(&path, allowed, e))?;
        Ok(Self::of_text(&path.display().to_string(), &text))
    }

    /// The study's seed, or the one that replaces it.
    pub fn seed(&self, of_study: u64) -> u64 {
        self.seed.unwrap_or(of_study)
    }

    /// Puts the objects that were asked for in the place of the study's.
    pub fn replace_objects(&self, objects: &mut ObjectsSpec) {
        let Some(given) = &self.objects else {
            return;
        };
        objects.sets.clear();
        if given.extension().is_some_and(|ending| ending == "toml") {
            objects.sets.push(SetName::File(given.clone().into()));
            objects.meshes = None;
        } else {
            objects.meshes = Some(given.clone().into());
        }
    }

    /// Looks for recorded frames in the folder that was asked for.
    pub fn replace_recorded(&self, recorded: &mut RecordedSpec) {
        let Some(folder) = &self.objects else {
            return;
        };
        for file in recorded.files_mut() {
            *file = folder.join(&*file);
        }
    }

    /// An error if objects were asked for; `why` says what the study has instead.
    ///
    /// # Errors
    /// They were.
    pub fn refuse_objects(&self, why: &str) -> Result<()> {
        let given = self.objects.as_ref().map(|path| path.display());
        refuse("--objects", given, why)
    }

    /// An error if a seed was asked for; `why` says why there is none.
    ///
    /// # Errors
    /// It was.
    pub fn refuse_seed(&self, why: &str) -> Result<()> {
        refuse("--seed", self.seed, why)
    }
}

fn refuse(option: &str, given: Option<impl Display>, why: &str) -> Result<()> {
    given.map_or(Ok(()), |given| {
        Err(Error::input(
            option,
            given,
            format!("no such option: {why}"),
        ))
    })
}
