//! Source of a study: its text and the options that override it.

use crate::error::{Error, Result};
use crate::files::SetName;
use crate::inputs::check::Check;
use crate::inputs::objects_spec::ObjectsSpec;
use crate::studies::recognition::spec::recorded::RecordedSpec;
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Text of a study, and the command-line options that change the study.
#[derive(Clone, Debug, Default)]
pub struct Source {
    /// Name of the study in error messages: the path of its file.
    pub place: String,
    /// Content of the study file, TOML.
    pub text: String,
    /// Folder to which paths in the study file are relative.
    pub folder: PathBuf,
    /// Path of meshes or of an object file that the command line gives; `None` keeps the objects of the study.
    pub objects: Option<PathBuf>,
    /// Random seed from the command line; `None` keeps the study's seed.
    pub seed: Option<u64>,
    /// Cache folder for packings (sphere models of meshes); `None` if packings are not cached.
    pub packings: Option<PathBuf>,
    /// Folder to which results are written. Temporary data that exceed the memory are also stored there.
    pub results: PathBuf,
    /// Maximum memory that a run may use, bytes; `None` for no limit.
    pub memory: Option<u64>,
}

impl Source {
    /// Creates the source of a study from its text. No command-line options change the study.
    pub fn of_text(place: &str, text: &str) -> Self {
        Self {
            place: place.to_owned(),
            text: text.to_owned(),
            ..Self::default()
        }
    }

    /// Reads the study that is stored in a result folder. No command-line options change the study.
    ///
    /// # Errors
    /// If the folder has no study or the study cannot be read.
    pub fn of_results(folder: &Path) -> Result<Self> {
        let path = folder.join("study.toml");
        let allowed = "the study of a folder that bubbletouch run wrote";
        let text = std::fs::read_to_string(&path);
        let text = text.map_err(|e| Error::unreadable(&path, allowed, e))?;
        Ok(Self::of_text(&path.display().to_string(), &text))
    }

    /// Returns the checker of the study's keys.
    pub fn check(&self) -> Check<'_> {
        Check { place: &self.place }
    }

    /// Returns the seed from the command line if it is given, otherwise the seed of the study, `of_study`.
    ///
    /// # Errors
    /// If the seed is no integer of TOML, because the resolved study could not be read again.
    pub fn seed(&self, of_study: u64) -> Result<u64> {
        match self.seed {
            Some(seed) if i64::try_from(seed).is_err() => Err(Error::input(
                "--seed",
                seed,
                "a number below 2⁶³, as in a study file",
            )),
            seed => Ok(seed.unwrap_or(of_study)),
        }
    }

    /// Replaces the objects of a study if a command-line option gives other objects.
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

    /// Replaces the folder of the recorded frames if a command-line option gives another folder. Returns the absolute path of this folder.
    pub fn replace_recorded(&self, recorded: &mut RecordedSpec) -> Option<PathBuf> {
        let folder = self.objects.as_ref()?;
        let folder = std::path::absolute(folder).unwrap_or_else(|_| folder.clone());
        recorded.change_files(|_, file| *file = folder.join(&*file));
        Some(folder)
    }

    /// Returns an error if a command-line option replaces the objects; `why` states what the study has in place of objects.
    ///
    /// # Errors
    /// If an option replaces the objects.
    pub fn refuse_objects(&self, why: &str) -> Result<()> {
        let given = self.objects.as_ref().map(|path| path.display());
        refuse("--objects", given, why)
    }

    /// Checks that no command-line option replaces the seed; `why` explains why the study has no seed.
    ///
    /// # Errors
    /// If an option replaces the seed.
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
