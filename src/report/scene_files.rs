//! A scene as files: a recording, a table of wrenches, and the scene as it was resolved.

use super::recording::contact_table::{ContactTable, PatchContact};
use super::recording::{
    ForceKind, Forces, PatchFrame, RecordedPatch, RecordingHeader, RecordingWriter,
};
use crate::contact::GripCounts;
use crate::error::Result;
use crate::files::write_bytes;
use crate::geometry::Pose;
use crate::scene::{Frame, FrameSink, PlannedPatch, ScenePlan};
use std::path::{Path, PathBuf};

/// The files of a scene in the making: `recording.npz`, `wrenches.csv` (in the frame of each patch, on the patch) and `scene.toml`
/// in one folder. [`finish`](Self::finish) puts them in place; dropped before, it leaves nothing behind.
pub struct SceneFiles {
    folder: PathBuf,
    names: Vec<String>,
    scene: String,
    recording: RecordingWriter,
    wrenches: ContactTable,
}

impl SceneFiles {
    /// Starts the files in a folder that is there.
    ///
    /// The error is a name that a recording cannot have (such as one with a slash), or why nothing can be written.
    pub fn create(folder: &Path, plan: &ScenePlan) -> Result<Self> {
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
            names: names.collect(),
            scene: plan.spec.to_toml(),
            recording: RecordingWriter::create(
                &folder.join("recording.npz"),
                header,
                plan.n_frames,
            )?,
            wrenches: ContactTable::create(&folder.join("wrenches.csv"))?,
        })
    }

    /// Puts all files in place.
    pub fn finish(self) -> Result<()> {
        self.recording.finish()?;
        self.wrenches.commit()?;
        write_bytes(&self.folder.join("scene.toml"), self.scene.as_bytes())
    }
}

impl FrameSink for SceneFiles {
    fn frame(&mut self, frame: &Frame) -> Result<()> {
        let patches = frame.patches.iter().map(|patch| PatchFrame {
            deflection: &patch.deflection,
            force: match &patch.friction {
                Some(friction) => Forces::Vector(&friction.force3),
                None => Forces::Normal(&patch.force),
            },
            pose: patch.pose,
        });
        let patches: Vec<PatchFrame> = patches.collect();
        let poses: Vec<Pose> = frame.objects.iter().map(|object| object.pose).collect();
        self.recording.push(frame.time, &patches, &poses)?;
        for (name, patch) in self.names.iter().zip(&frame.patches) {
            let contact = PatchContact {
                patch: name,
                n_touched: patch.n_touched,
                n_saturated: patch.n_saturated,
                force: patch.wrench.force,
                torque: patch.wrench.torque,
                center_of_pressure: patch.center_of_pressure,
                grips: patch.friction.as_ref().map(|friction| GripCounts {
                    n_sticking: friction.n_sticking,
                    n_slipping: friction.n_slipping,
                }),
            };
            self.wrenches.row(frame.time, &contact)?;
        }
        Ok(())
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
    }
}
