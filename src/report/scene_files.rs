//! Output files of a simulated scene: a recording, a table of wrenches, and the complete scene file.

use super::recording::{ForceKind, RecordedPatch, RecordingHeader, RecordingWriter};
use crate::error::Result;
use crate::files::{CsvFile, DataFolder, write_bytes};
use crate::scene::{Frame, FrameSink, PatchReading, PlannedPatch, PlannedSignal, ScenePlan};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Row of `wrenches.csv`: force, torque and contact counts of one patch at one time, in the patch frame. Numbers have enough digits to read back as the same
/// bits.
#[derive(Serialize)]
struct WrenchRow<'a> {
    time_s: f64,
    patch: &'a str,
    n_touched: usize,
    n_saturated: usize,
    fx_n: f64,
    fy_n: f64,
    fz_n: f64,
    /// Torque about the x axis through the patch's origin, N·m.
    tx_nm: f64,
    ty_nm: f64,
    tz_nm: f64,
    /// Centre of pressure along x, metres; empty if no taxel is in contact.
    cop_x_m: Option<f64>,
    cop_y_m: Option<f64>,
    cop_z_m: Option<f64>,
    /// Number of taxels in sticking contact; empty for a patch without friction.
    n_sticking: Option<usize>,
    n_slipping: Option<usize>,
}

const RECORDING: &str = "recording.npz";
const WRENCHES: &str = "wrenches.csv";
const SCENE: &str = "scene.toml";

/// Writer of a scene's output files in one folder: `recording.npz`, `wrenches.csv` (force and torque on each patch, in its frame) and `scene.toml`. The method
/// `finish` completes the files. If the writer is dropped before completion, no file remains.
pub struct SceneFiles {
    folder: PathBuf,
    claimed: DataFolder,
    names: Vec<String>,
    scene: String,
    recording: RecordingWriter,
    wrenches: CsvFile,
}

impl SceneFiles {
    /// Creates the output files in an existing folder.
    ///
    /// # Errors
    /// If the folder contains one of these files and no simulation wrote it. If a file cannot be written, or a name contains a slash or another invalid
    /// character.
    pub fn create(folder: &Path, plan: &ScenePlan) -> Result<Self> {
        let claimed = DataFolder::claim(folder, "simulate", [RECORDING, WRENCHES, SCENE])?;
        let header = RecordingHeader {
            patches: plan.patches.iter().map(recorded).collect(),
            objects: plan
                .objects
                .iter()
                .map(|object| object.name.clone())
                .collect(),
            about: serde_json::json!({
                "title": plan.spec.title,
                "dt_ms": plan.spec.dt_ms,
                "seed": plan.spec.seed,
                "program": concat!("bubbletouch ", env!("CARGO_PKG_VERSION")),
            }),
        };
        let names = plan
            .patches
            .iter()
            .map(|patch| patch.skin.name().to_owned());
        Ok(Self {
            folder: folder.to_owned(),
            claimed,
            names: names.collect(),
            scene: plan.spec.to_toml(),
            recording: RecordingWriter::create(&folder.join(RECORDING), header)?,
            wrenches: CsvFile::create(&folder.join(WRENCHES))?,
        })
    }

    /// Completes all output files of the scene.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(self) -> Result<()> {
        self.claimed.write_manifest()?;
        self.recording.finish()?;
        self.wrenches.commit()?;
        write_bytes(&self.folder.join(SCENE), self.scene.as_bytes())
    }
}

impl FrameSink for SceneFiles {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        self.recording.push(frame)?;
        for (name, patch) in self.names.iter().zip(&frame.patches) {
            self.wrenches.row(wrench_row(frame.time, name, patch))?;
        }
        Ok(())
    }
}

fn wrench_row<'a>(time_s: f64, name: &'a str, patch: &PatchReading) -> WrenchRow<'a> {
    let (force, torque) = (patch.wrench.force, patch.wrench.torque);
    let (center, friction) = (patch.center_of_pressure, patch.friction.as_ref());
    WrenchRow {
        time_s,
        patch: name,
        n_touched: patch.n_touched,
        n_saturated: patch.n_saturated,
        fx_n: force.x,
        fy_n: force.y,
        fz_n: force.z,
        tx_nm: torque.x,
        ty_nm: torque.y,
        tz_nm: torque.z,
        cop_x_m: center.map(|c| c.x),
        cop_y_m: center.map(|c| c.y),
        cop_z_m: center.map(|c| c.z),
        n_sticking: friction.map(|f| f.n_sticking),
        n_slipping: friction.map(|f| f.n_slipping),
    }
}

fn recorded(patch: &PlannedPatch) -> RecordedPatch {
    let layout = patch.skin.layout();
    RecordedPatch {
        name: patch.skin.name().to_owned(),
        centers: layout.centers().to_vec(),
        axes: layout.axes().to_vec(),
        grid: layout.as_grid().copied(),
        force: match patch.shears {
            Some(_) => ForceKind::Vector,
            None => ForceKind::Normal,
        },
        signal: patch.signal.as_ref().map(PlannedSignal::quantity),
    }
}
