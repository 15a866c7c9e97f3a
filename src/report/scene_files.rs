//! Output of a simulated scene: a recording, a table of wrenches, the complete scene file, and a summary as text tables.

use super::recording::{ForceKind, RecordedPatch, RecordingHeader, RecordingWriter};
use crate::error::Result;
use crate::files::{CsvFile, DataFolder, write_bytes};
use crate::geometry::rpy_from_rotation;
use crate::report::terminal::rows_text;
use crate::scene::{
    Carrier, Frame, FrameSink, Movement, PatchReading, PlannedPatch, PlannedSignal, PoseControl,
    ScenePlan, Summary,
};
use crate::spelling::counted;
use crate::table::short_number;
use crate::world::Motion;
use glam::DVec3;
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

/// Returns the summary of a scene as text: a table of patches with their largest values, and a table of objects with their final states.
pub fn scene_table(plan: &ScenePlan, summary: &Summary) -> String {
    let mut text = format!("{}\n", patches(plan, summary));
    for patch in &plan.patches {
        let n_left_out = patch.skin.layout().n_left_out();
        if n_left_out > 0 {
            let (name, left_out) = (patch.skin.name(), counted(n_left_out, "taxel"));
            text += &format!(
                "Patch {name}: {left_out} left out, whose axes would meet the mesh again.\n"
            );
        }
    }
    if !plan.objects.is_empty() {
        text += &format!("\n{}\n", objects(plan, summary));
    }
    text
}

fn patches(plan: &ScenePlan, summary: &Summary) -> String {
    let mut header = vec![
        "patch",
        "taxels",
        "deepest (mm)",
        "most force (N)",
        "most touched",
        "saturated",
        "grazing",
    ];
    if plan.patches.iter().any(|patch| patch.shears.is_some()) {
        header.extend(["most friction (N)", "most sticking", "most slipping"]);
    }
    let patches = plan.patches.iter().zip(&summary.patches);
    let rows = patches.map(|(patch, peaks)| {
        let mut row = vec![
            patch.skin.name().to_owned(),
            patch.skin.n_taxels().to_string(),
            short_number(1e3 * peaks.deflection),
            short_number(peaks.force),
            peaks.n_touched.to_string(),
            peaks.n_saturated.to_string(),
            peaks.n_grazing.to_string(),
        ];
        if patch.shears.is_some() {
            row.push(short_number(peaks.shear));
            row.push(peaks.n_sticking.to_string());
            row.push(peaks.n_slipping.to_string());
        }
        row
    });
    rows_text(&header, &[0], rows)
}

fn objects(plan: &ScenePlan, summary: &Summary) -> String {
    let all = plan.objects.iter().zip(&plan.models);
    let rows = all.zip(&summary.objects).map(|((object, model), summary)| {
        let parts = match model.spheres() {
            Some(union) => counted(union.n_spheres(), "sphere"),
            None => counted(model.n_triangles(), "triangle"),
        };
        let mut end = ending(&object.movement, &summary.held);
        if matches!(object.movement, Movement::Free { .. }) {
            let position = triple(1e3 * summary.pose.translation);
            let angles = triple(rpy_from_rotation(summary.pose.rotation).map(f64::to_degrees));
            end += &format!("; last at {position} mm, rotated by {angles}°");
        }
        if summary.n_unsettled > 0 {
            end += &format!("; not at rest in {}", counted(summary.n_unsettled, "frame"));
        }
        if summary.imbalance > 0.0 {
            let share = short_number(summary.imbalance);
            end += &format!("; at most {share} of its weight not balanced");
        }
        if summary.n_off > 0 {
            let frames = counted(summary.n_off, "frame");
            end += &format!("; not with the force wanted in {frames}");
        }
        vec![object.name.clone(), parts, end]
    });
    rows_text(&["object", "parts", "at the end"], &[0, 1, 2], rows)
}

/// Returns the final state of an object as text.
fn ending(movement: &Movement, held: &PoseControl) -> String {
    match held {
        PoseControl::Imposed => match movement {
            Movement::Imposed {
                carrier: Carrier::Link { .. },
                ..
            } => "where its robot carries it".to_owned(),
            Movement::Imposed {
                motion: Motion::Fixed(_),
                ..
            } => "fixed".to_owned(),
            _ => "where its motion says".to_owned(),
        },
        PoseControl::Pressed {
            travel,
            force,
            wanted,
        } => format!(
            "pressed {} mm, with {} of {} N",
            short_number(1e3 * travel),
            short_number(*force),
            short_number(*wanted)
        ),
        PoseControl::AtRest => "at rest".to_owned(),
        PoseControl::NotConverged => "not at rest".to_owned(),
        PoseControl::Escaped { time, direction } => {
            let towards = triple(*direction);
            format!("escaped at {} s towards {towards}", short_number(*time))
        }
    }
}

/// Returns three numbers as text, such as `(1.00, 0.00, -2.50)`.
fn triple(numbers: DVec3) -> String {
    // Adding 0 makes a negative zero positive.
    let [x, y, z] = numbers
        .to_array()
        .map(|number| format!("{:.2}", (1e2 * number).round() / 1e2 + 0.0));
    format!("({x}, {y}, {z})")
}
