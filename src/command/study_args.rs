//! What `run`, `plan` and `touches` have in common: a study file, and what overrides it.

use bubbletouch::random::Seed;
use bubbletouch::study::reconstruction::{
    ReconstructionPlan, ReconstructionStudySpec, is_reconstruction_study,
};
use bubbletouch::study::{Plan, StudySpec, Sweep, TouchedObject, draw_touches, load_objects};
use bubbletouch::{Error, Result};
use std::path::PathBuf;

/// The study that a bare `bubbletouch` runs; it is part of the command, so that it runs in any folder.
const QUICKSTART: &str = include_str!("../../experiments/quickstart.toml");

#[derive(Clone, clap::Args)]
pub struct StudyArgs {
    /// The study, a TOML file
    pub study: PathBuf,
    /// A folder of PLY, OBJ or STL meshes, one object a file; replaces the study's objects
    #[arg(long, value_name = "FOLDER")]
    pub objects: Option<PathBuf>,
    /// Root of all randomness; replaces the study's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads; all cores when left out. Results are the same at any number
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
}

/// A study whose objects are built and whose touches are drawn.
pub struct LoadedStudy {
    pub name: String,
    pub plan: Plan,
    pub touched: Vec<TouchedObject>,
    pub sweep: Sweep,
}

impl StudyArgs {
    pub fn quickstart() -> Self {
        Self {
            study: PathBuf::from("experiments/quickstart.toml"),
            objects: None,
            seed: None,
            threads: None,
        }
    }

    /// The name of the study: its file's name without the ending.
    pub fn name(&self) -> Result<String> {
        let stem = self.study.file_stem().and_then(|stem| stem.to_str());
        stem.map(str::to_owned)
            .ok_or_else(|| Error::input("study", self.study.display(), "a file with a name"))
    }

    /// Reads and checks the study.
    pub fn plan(&self) -> Result<Plan> {
        set_threads(self.threads)?;
        let place = self.study.display().to_string();
        if self.is_reconstruction()? {
            return Err(Error::input(
                place,
                "a study that reconstructs frames",
                "a study that recognises objects (bubbletouch run runs both kinds)",
            ));
        }
        let mut spec = StudySpec::parse(&place, &self.text()?)?;
        if let Some(seed) = self.seed {
            spec.seed = seed;
        }
        if let Some(folder) = &self.objects {
            spec.objects.meshes = Some(folder.clone());
            spec.objects.sets.clear();
        }
        Plan::new(&place, spec)
    }

    /// Whether the study reconstructs frames rather than recognising objects.
    pub fn is_reconstruction(&self) -> Result<bool> {
        Ok(is_reconstruction_study(&self.text()?))
    }

    /// Reads and checks a study that reconstructs frames.
    pub fn reconstruction_plan(&self) -> Result<ReconstructionPlan> {
        set_threads(self.threads)?;
        let place = self.study.display().to_string();
        let mut spec = ReconstructionStudySpec::parse(&place, &self.text()?)?;
        spec.seed = self.seed.unwrap_or(spec.seed);
        if let Some(folder) = &self.objects {
            spec.objects.meshes = Some(folder.clone());
            spec.objects.sets.clear();
        }
        ReconstructionPlan::new(&place, spec)
    }

    /// Reads and checks the study, builds its objects, draws its touches and lays out its cells.
    pub fn load(&self) -> Result<LoadedStudy> {
        let plan = self.plan()?;
        let objects = load_objects(&plan.spec.objects)?;
        let touched = draw_touches(objects, &plan.placement, &Seed::new(plan.spec.seed))?;
        let sweep = Sweep::new(&plan, &touched)?;
        Ok(LoadedStudy {
            name: self.name()?,
            plan,
            touched,
            sweep,
        })
    }

    fn text(&self) -> Result<String> {
        let quickstart = Self::quickstart();
        if self.study == quickstart.study && !self.study.exists() {
            return Ok(QUICKSTART.to_owned());
        }
        std::fs::read_to_string(&self.study).map_err(|error| {
            Error::input(
                self.study.display(),
                format!("cannot be read ({error})"),
                "a study in TOML",
            )
        })
    }
}

/// Sets the number of threads of everything that follows; all cores when left out.
pub fn set_threads(threads: Option<usize>) -> Result<()> {
    let Some(threads) = threads else {
        return Ok(());
    };
    if threads == 0 {
        return Err(Error::input("--threads", 0, "at least 1"));
    }
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build_global()
        .map_err(|error| {
            Error::input(
                "--threads",
                format!("{threads} ({error})"),
                "a number of threads that the system can start",
            )
        })
}
