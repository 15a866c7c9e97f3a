//! Whole-body study: training comes first, then scenes and scaling series one after the other, so that timings do not disturb each other.

use crate::inputs::object_files::file_content;
use crate::objects::SphereUnion;
use crate::studies::prelude::*;
use crate::studies::whole_body::charts::{CHARTS, answers, picture_of_body};
use crate::studies::whole_body::drive::{Drive, Posture, of_scene};
use crate::studies::whole_body::ladders::{ScalingPoint, climb, rungs};
use crate::studies::whole_body::plan::*;
use crate::studies::whole_body::recognition::learn;
use crate::studies::whole_body::rows::*;
use crate::studies::whole_body::spec::*;
use crate::whole_body::{BodyState, CoveredRobot};
use std::collections::BTreeMap;

impl Study for WholeBodyPlan {
    const ABOUT: About = About {
        table: "whole_body",
        words: "a study of a whole body of skin",
    };
    const TABLES: TableFiles =
        TableFiles::always(&[&CASES, &RECOGNITION, &SENSED, &TIMING, &STEPS]);

    const CHARTS: &'static [Chart] = CHARTS;

    type Spec = WholeBodyStudySpec;
    type Rows = WholeBodyRows;

    fn load(source: &Source) -> Result<Self> {
        source.refuse_objects("a whole body is touched by the objects that its study names")?;
        let spec = WholeBodyStudySpec::of(source)?;
        let plan = Self::new(&source.place, &source.folder, spec)?;
        Ok(Self {
            size: plan.body_size()?,
            ..plan
        })
    }

    fn facts(&self) -> Result<Facts> {
        let robot = file_content(&self.spec.whole_body.robot.within(&self.folder))?;
        let mut content = BTreeMap::from([("robot".to_owned(), robot)]);
        for scene in &self.scenes {
            let object = &scene.spec.object;
            let joints = scene.spec.joints.as_ref();
            let files = [
                ("objects", object.objects.as_ref()),
                ("spheres", object.spheres.as_ref()),
                ("mesh", object.mesh.as_ref()),
                ("joints", joints.and_then(|joints| joints.csv.as_ref())),
            ];
            for (name, path) in files {
                let Some(path) = path else { continue };
                let name = format!("{} of scene {}", name, scene.spec.name);
                content.insert(name, file_content(&path.within(&self.folder))?);
            }
        }
        Ok(Facts::new(&self.spec, content))
    }

    fn scale(&self) -> Scale {
        let n_objects = self.recognition().objects.len();
        let n_taxels = self.size.n_taxels;
        Scale {
            objects: format!("{n_objects} to tell apart, {} scenes", self.scenes.len()),
            touches: format!(
                "{} on a body of about {n_taxels:.0} taxels",
                self.recognition().n_touches()
            ),
            n_configurations: self.compressions.len() + self.scenes.len(),
            bytes: self.size.body_bytes,
            stages: vec![self.memory()],
        }
    }

    /// Returns all work items. The items of compressions and of scaling series do not depend on other compressions; scenes are sensed with all of them.
    fn work_items(&self) -> Vec<WorkItem> {
        let shared = shared_inputs(&self.spec, &Self::keys());
        let compressions = self.compressions.iter().map(|compression| {
            let name = format!("learn from {}", compression.0);
            WorkItem::of(name, 0, &(&shared, compression))
        });
        let scenes = self.scenes.iter().map(|scene| {
            let name = format!("scene {}", scene.spec.name);
            WorkItem::of(name, 0, &(&shared, &self.compressions, &scene.spec))
        });
        let rungs = self.rungs().into_iter().enumerate().map(|(number, rung)| {
            let name = format!("ladder of {:?}, {}", rung.series, rung.name).to_lowercase();
            WorkItem::of(name, number + 1, &(&shared, rung))
        });
        compressions.chain(scenes).chain(rungs).collect()
    }

    fn measure(&self, left: &PendingItems<WholeBodyRows>) -> Result<()> {
        let (covered, compressions) = (Shared::default(), Shared::default());
        let cover = || covered.get(|| self.cover(self.pitch));
        let learn = || {
            compressions.get(|| {
                let straight = self.posture(cover()?, &vec![0.0; self.robot.n_positions()])?;
                learn(self, &straight, left.progress)
            })
        };
        let n_compressions = self.compressions.len();
        for number in 0..n_compressions {
            left.finish(number, || {
                Ok((vec![learn()?[number].score.clone()], Vec::new()))
            })?;
        }
        let first_rung = n_compressions + self.scenes.len();
        left.stage(
            "scenes and ladders",
            n_compressions..first_rung + self.rungs().len(),
        );
        for (scene, number) in self.scenes.iter().zip(n_compressions..) {
            left.finish(number, || {
                let (mut drive, _) = self.begin(scene, cover()?)?;
                let driven = drive.run(self, (Series::Scene, &scene.spec.name), learn()?)?;
                Ok((Vec::new(), vec![driven]))
            })?;
        }
        for (rung, number) in self.rungs().iter().zip(first_rung..) {
            left.finish(number, || Ok((Vec::new(), vec![climb(self, rung)?])))?;
        }
        Ok(())
    }

    fn tables(&self, (recognition, driven): WholeBodyRows) -> Result<Vec<Table>> {
        let mut sensed = Vec::new();
        let (mut cases, mut times, mut steps) = (Vec::new(), Vec::new(), Vec::new());
        for of in driven {
            let touch = BodyTouch {
                touched: of
                    .n_touched
                    .map_or(of.count.touched_mean.round(), |n| n as f64),
                touched_mean: of.count.touched_mean,
            };
            steps.push((of.case.clone(), touch, of.times[0].1.clone()));
            let of_case = |(stage, time)| (of.case.clone(), stage, time);
            times.extend(of.times.into_iter().map(of_case));
            cases.push((of.case, of.count));
            sensed.extend(of.sensed);
        }
        Ok(vec![
            CASES.table(&cases)?,
            RECOGNITION.table(&recognition)?,
            SENSED.table(&sensed)?,
            TIMING.table(&times)?,
            STEPS.table(&steps)?,
        ])
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers(tables)
    }

    fn beyond(&self, tables: &[Table]) -> Result<Beyond> {
        Ok(Beyond {
            pictures: picture_of_body(self, &tables[0])?.into_iter().collect(),
            ..Beyond::default()
        })
    }
}

/// Maximum number of taxels of a skin that is made to determine its size. The size of a finer skin is extrapolated from a skin of at least a quarter of this
/// number.
const MAX_COUNTED: usize = 4_000_000;

impl WholeBodyPlan {
    /// Returns the size of the covered robot.
    ///
    /// # Errors
    /// If the robot cannot be covered.
    fn body_size(&self) -> Result<BodySize> {
        // Coarser skins come first, so that a much too fine skin is never made.
        let mut pitch = self.pitch.max(self.side);
        loop {
            let covered = self.cover(pitch);
            // A coarse skin may have no place on a small link.
            let n_taxels = covered
                .as_ref()
                .map_or(0, |covered| covered.body().n_taxels());
            if pitch > self.pitch && n_taxels < MAX_COUNTED / 4 {
                pitch = self.pitch.max(0.5 * pitch);
                continue;
            }
            let covered = covered?;
            let (body, finer) = (covered.body(), (pitch / self.pitch).powi(2));
            return Ok(BodySize {
                n_taxels: finer * body.n_taxels() as f64,
                body_bytes: finer * body.n_bytes() as f64,
                state_bytes: finer * BodyState::at_rest(body).n_bytes() as f64,
            });
        }
    }

    /// Returns the approximate memory of the states of the skin, the compressions and the scaling series.
    fn memory(&self) -> Stage {
        // Memory of a taxel of a scaling series, and of a non-zero entry of a measurement matrix.
        const LADDER_BYTES: f64 = 10.0;
        const ENTRY_BYTES: f64 = 16.0;
        let m = self.spec.whole_body.sensing.measurements as f64;
        let n = self.size.n_taxels;
        let compressions = self.compressions.iter().map(|(_, block)| {
            let entries = block.map_or(n.sqrt(), |block| (block as f64).min(n));
            4.0 * n + ENTRY_BYTES * m * entries
        });
        let rows = 8.0 * m * (self.compressions.len() * self.recognition().n_touches()) as f64;
        let ladders = self.spec.whole_body.ladders.iter();
        let ladders = ladders.flat_map(|of| of.taxels.iter().chain([&of.taxels_at_touch]));
        let largest = ladders.copied().max().unwrap_or(0) as f64;
        Stage {
            bytes: compressions.sum::<f64>() + rows + LADDER_BYTES * largest,
            items: vec![self.size.state_bytes; rayon::current_num_threads()],
        }
    }

    /// Returns the robot covered with skin, whose neighbouring taxels are `pitch` metres apart.
    pub(super) fn cover(&self, pitch: f64) -> Result<CoveredRobot> {
        let cover = match self.spec.whole_body.flat_ends {
            true => CoveredRobot::with_flat_ends,
            false => CoveredRobot::new,
        };
        cover(&self.robot, self.taxel, pitch, self.side)
    }

    /// Returns the poses of all patches and links of the robot in a posture.
    pub(super) fn posture<'a>(
        &self,
        covered: &'a CoveredRobot,
        positions: &[f64],
    ) -> Result<Posture<'a>> {
        let links = self.robot.forward(&Pose::IDENTITY, positions)?;
        let mut patches = Vec::new();
        covered.patch_poses(&links, &mut patches);
        Ok(Posture {
            body: covered.body(),
            patches,
            links,
        })
    }

    /// Returns all sizes of the scaling series; empty without a table `[whole_body.ladders]`.
    fn rungs(&self) -> Vec<ScalingPoint> {
        let ladders = self.spec.whole_body.ladders.as_ref();
        ladders.map_or_else(Vec::new, rungs)
    }

    /// Returns the object of a scene at the start of its path; error messages contain the name of the scene.
    pub(super) fn begin<'a>(
        &self,
        scene: &ScenePlan,
        covered: &'a CoveredRobot,
    ) -> Result<(Drive<'a>, SphereUnion)> {
        let begin = || {
            let object = of_scene(self, scene)?;
            let posture = self.posture(covered, &scene.positions)?;
            let mut drive = Drive::new(&posture, &object, &scene.aim)?;
            if let Some(depth_mm) = scene.spec.depth_mm {
                drive.approach(scene.aim.from, MM * depth_mm)?;
            }
            Ok((drive, object))
        };
        begin().map_err(|error: Error| error.under(format!("scene {}, ", scene.spec.name)))
    }
}
