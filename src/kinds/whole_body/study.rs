//! Runs a study of a whole body: learn, then the scenes and the ladders one after the other, so that nothing else is timed.

use super::charts::{answers, charts};
use super::drawn::whole_body_picture;
use super::drive::{Drive, Driven, PosedBody};
use super::ladders::{Rung, climb, rungs};
use super::objects::of_scene;
use super::path::Path;
use super::picture::picture_body;
use super::plan::{ScenePlan, WholeBodyPlan};
use super::recognition::{Compression, learn, name_of};
use super::rows::{
    BodyCase, BodyCount, BodyRecognition, BodySensed, BodyStep, BodyTime, Series, Stage,
    WholeBodyRows,
};
use super::spec::WholeBodyStudySpec;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::kinds::{About, Facts, Kind, Source};
use crate::objects::SphereUnion;
use crate::report::study_folder::NamedPicture;
use crate::study::pieces::{NamedPiece, PieceRows, PieceStudy, PiecesLeft, Scale, Shared};
use crate::study::time_left::Piece;
use crate::study::{MM, file_content};
use crate::table::{ChartSpec, File, Table};
use crate::whole_body::CoveredRobot;

const CASES: File<(BodyCase, BodyCount)> = File::new("whole_body.csv", "Scenes and rungs", "");
const RECOGNITION: File<BodyRecognition> = File::new(
    "recognition.csv",
    "Recognition",
    "A linear SVM, trained and tested on simulated touches.",
);
const SENSED: File<BodySensed> = File::new("sensed.csv", "What scenes are taken for", "");
const TIMING: File<(BodyCase, BodyTime)> = File::new(
    "timing.csv",
    "From touch to answer",
    "Medians over steps, on this machine.",
)
.of_times();
const STEPS: File<(BodyCase, BodyStep)> = File::new(
    "steps.csv",
    "Steps of the skin",
    "Medians over steps of a moving object; of ladders, a cushion of spheres, half of them on its far side.",
)
.summary()
.of_times();

/// Stages of a run.
const LEARN: u8 = 0;
const PLAY: u8 = 1;
const CLIMB: u8 = 2;

/// Seconds by the clock, about: of a touch that is learned from or tested, and of a step of a scene or a rung.
const TOUCH_S: f64 = 1e-3;
const STEP_S: f64 = 5e-4;

impl Kind for WholeBodyPlan {
    const ABOUT: About = About {
        table: "whole_body",
        words: "a study of a whole body of skin",
        may_change: &[
            "question",
            "expected",
            "whole_body.scenes",
            "whole_body.ladders.taxels",
            "whole_body.ladders.touched_at_taxels",
            "whole_body.ladders.touched",
            "whole_body.ladders.spheres",
        ],
    };

    fn load(source: &Source) -> Result<Self> {
        source.refuse_objects("a whole body is touched by the objects that its study names")?;
        let mut spec = WholeBodyStudySpec::parse(&source.place, &source.text)?;
        spec.seed = source.seed(spec.seed);
        Self::new(&source.place, &source.folder, spec)
    }

    fn facts(&self) -> Result<Facts> {
        let robot = file_content(&self.robot_file)?;
        Ok(Facts::of(&self.spec, [("robot".to_owned(), robot)].into()))
    }

    fn scale(&self) -> Scale {
        // A taxel's place and what its compressions keep of it.
        const TAXEL_BYTES: f64 = 150.0;
        // Of a body, about, square metres.
        const AREA: f64 = 2.0;
        let n_objects = self.recognition().objects.len();
        let n_taxels = AREA / (self.pitch * self.pitch);
        Scale {
            objects: format!("{n_objects} to tell apart, {} scenes", self.scenes.len()),
            touches: format!(
                "{} on a body of about {n_taxels:.0} taxels",
                self.recognition().n_touches()
            ),
            n_configurations: self.compressions.len() + self.scenes.len(),
            bytes: TAXEL_BYTES * n_taxels,
            ..Scale::default()
        }
    }

    fn read(folder: &std::path::Path) -> Result<Vec<Table>> {
        Ok(vec![
            CASES.read(folder)?,
            RECOGNITION.read(folder)?,
            SENSED.read(folder)?,
            TIMING.read(folder)?,
            STEPS.read(folder)?,
        ])
    }

    fn charts(&self, tables: &[Table]) -> Vec<ChartSpec> {
        charts(tables)
    }

    fn pictures(&self, tables: &[Table]) -> Result<Vec<NamedPicture>> {
        let Some(scene) = picture_body(self, &tables[0])? else {
            return Ok(Vec::new());
        };
        let drawn = whole_body_picture(&scene)?;
        Ok(vec![NamedPicture {
            name: "touched".to_owned(),
            title: format!("The scene {}, and the pressure on each patch", scene.scene),
            png: drawn.png()?,
            size: (drawn.width, drawn.height),
        }])
    }

    fn answers(&self, tables: &[Table]) -> Vec<String> {
        answers(tables)
    }
}

impl PieceStudy for WholeBodyPlan {
    type Rows = WholeBodyRows;

    /// Compressions and scenes need all that is learned; rungs need nothing.
    fn pieces(&self) -> Vec<NamedPiece> {
        let n_steps = self.n_steps() as f64;
        let compressions = self.compression_names().into_iter();
        let learn_s = TOUCH_S * self.recognition().n_touches() as f64 / compressions.len() as f64;
        let learn = Piece::one_by_one(LEARN, learn_s);
        let compressions = compressions.map(|name| NamedPiece::new(name, 0, learn));
        let play = Piece::one_by_one(PLAY, STEP_S * n_steps);
        let scenes = self.scenes.iter();
        let scenes = scenes.map(|scene| NamedPiece::new(scene_name(scene), 0, play).made_of(scene));
        let climb = Piece::one_by_one(CLIMB, STEP_S * n_steps);
        let rungs = self.rungs().into_iter().enumerate();
        let rungs = rungs.map(|(number, rung)| {
            NamedPiece::new(rung_name(&rung), number + 1, climb).made_of(rung)
        });
        compressions.chain(scenes).chain(rungs).collect()
    }

    fn measure(&self, left: &PiecesLeft<WholeBodyRows>) -> Result<()> {
        let (covered, compressions) = (Shared::default(), Shared::default());
        let cover = || {
            let cover = || CoveredRobot::new(&self.robot, self.taxel, self.pitch, self.side);
            covered.get(cover)
        };
        let learn = || {
            compressions.get(|| {
                let straight = vec![0.0; self.robot.n_positions()];
                let straight = Posture::new(self, cover()?, &straight)?;
                learn(self, &straight.posed, &straight.links, left.progress)
            })
        };
        for (number, name) in self.compression_names().iter().enumerate() {
            left.finish(name, || {
                Ok(WholeBodyRows {
                    recognition: vec![learn()?[number].score.clone()],
                    ..WholeBodyRows::default()
                })
            })?;
        }
        let scenes = left.of(&self.scenes, |scene| scene_name(scene));
        left.progress.stage("scenes", scenes.len() as u64);
        for scene in scenes {
            left.finish(&scene_name(scene), || play(self, scene, cover()?, learn()?))?;
        }
        let rungs = left.of(self.rungs(), rung_name);
        left.progress.stage("ladders", rungs.len() as u64);
        rungs.iter().try_for_each(|rung| {
            left.finish(&rung_name(rung), || {
                let (case, driven) = climb(self, rung)?;
                Ok(WholeBodyRows::of(&case, driven))
            })
        })
    }

    fn tables(&self, rows: WholeBodyRows) -> Result<Vec<Table>> {
        Ok(vec![
            CASES.of(&rows.cases)?,
            RECOGNITION.of(&rows.recognition)?,
            SENSED.of(&rows.sensed)?,
            TIMING.of(&rows.timing)?,
            STEPS.of(&steps(&rows))?,
        ])
    }
}

impl PieceRows for WholeBodyRows {
    fn append(&mut self, next: Self) {
        self.cases.extend(next.cases);
        self.sensed.extend(next.sensed);
        self.recognition.extend(next.recognition);
        self.timing.extend(next.timing);
    }
}

impl WholeBodyRows {
    /// What happened in a case, and what it cost.
    fn of(case: &BodyCase, driven: Driven) -> Self {
        let times = driven.times.into_iter();
        Self {
            cases: vec![(case.clone(), driven.count)],
            timing: times.map(|time| (case.clone(), time)).collect(),
            ..Self::default()
        }
    }
}

/// Of each case the step of the skin with all threads.
fn steps(rows: &WholeBodyRows) -> Vec<(BodyCase, BodyStep)> {
    let of_case = |(case, count): &(BodyCase, BodyCount)| {
        // The press is there once more with one thread.
        let is_it = |(of, time): &&(BodyCase, BodyTime)| of == case && time.stage == Stage::Press;
        let (_, time) = rows.timing.iter().find(is_it)?;
        let step = BodyStep {
            touched: round_to_two(count.touched_mean),
            touched_mean: count.touched_mean,
            us_median: time.us_median,
            us_p05: time.us_p05,
            us_p95: time.us_p95,
            steps_per_s: time.steps_per_s,
        };
        Some((case.clone(), step))
    };
    rows.cases.iter().filter_map(of_case).collect()
}

/// To two digits: a touch of 10,008 taxels is one of 10,000.
fn round_to_two(value: f64) -> f64 {
    let unit = 10f64.powf(value.max(1.0).log10().floor() - 1.0);
    (value / unit).round() * unit
}

fn scene_name(scene: &ScenePlan) -> String {
    format!("scene {}", scene.spec.name)
}

fn rung_name(rung: &Rung) -> String {
    format!("ladder of {:?}, {}", rung.series, rung.name).to_lowercase()
}

impl WholeBodyPlan {
    /// What each compression is called as a work item.
    fn compression_names(&self) -> Vec<String> {
        let compressions = self.compressions.iter();
        let name = |&(ensemble, block)| format!("learn from {}", name_of(ensemble, block));
        compressions.map(name).collect()
    }

    fn rungs(&self) -> Vec<Rung> {
        let ladders = self.spec.whole_body.ladders.as_ref();
        ladders.map_or_else(Vec::new, rungs)
    }
}

/// Where everything of a robot is.
pub(super) struct Posture<'a> {
    pub links: Vec<Pose>,
    pub posed: PosedBody<'a>,
}

impl<'a> Posture<'a> {
    pub fn new(plan: &WholeBodyPlan, covered: &'a CoveredRobot, positions: &[f64]) -> Result<Self> {
        let links = plan.robot.forward(&Pose::IDENTITY, positions)?;
        let mut poses = Vec::new();
        covered.patch_poses(&links, &mut poses);
        let posed = PosedBody {
            body: covered.body(),
            poses,
        };
        Ok(Self { links, posed })
    }
}

/// Brings an object to where its scene begins.
pub(super) fn begin<'a>(
    scene: &ScenePlan,
    posture: &Posture<'a>,
    object: &SphereUnion,
) -> Result<Drive<'a>> {
    let path = Path {
        world_from_link: posture.links[scene.aim.link],
        ..scene.path
    };
    let mut drive = Drive::new(&posture.posed, object, path);
    if let Some(depth_mm) = scene.spec.depth_mm {
        drive.approach(scene.aim.from, MM * depth_mm)?;
    }
    Ok(drive)
}

/// Plays a scene; the error names it.
fn play(
    plan: &WholeBodyPlan,
    scene: &ScenePlan,
    covered: &CoveredRobot,
    compressions: &[Compression],
) -> Result<WholeBodyRows> {
    let in_scene = |error: Error| error.under(format!("scene {}, ", scene.spec.name));
    let object = of_scene(&scene.spec, plan.surface_error).map_err(in_scene)?;
    let posture = Posture::new(plan, covered, &scene.positions)?;
    let mut drive = begin(scene, &posture, &object).map_err(in_scene)?;
    let case = BodyCase {
        series: Series::Scene,
        name: scene.spec.name.clone(),
        n_taxels: covered.body().n_taxels(),
        n_patches: covered.body().patches().len(),
        n_spheres: drive.n_spheres(),
    };
    let driven = drive.run(plan.n_steps(), plan.dt, compressions)?;
    let sensed = compressions.iter().zip(&driven.sensed);
    let sensed = sensed.map(|(compression, (sum, decisions))| {
        let most = decisions.iter().copied().max().unwrap_or(0);
        let label = decisions.iter().position(|&n| n == most).unwrap_or(0);
        BodySensed {
            scene: scene.spec.name.clone(),
            compression: compression.score.compression.clone(),
            measurement_sum_mm: *sum,
            decision: plan.recognition().objects[label].clone(),
            decision_share: most as f64 / driven.count.n_steps as f64,
        }
    });
    Ok(WholeBodyRows {
        sensed: sensed.collect(),
        ..WholeBodyRows::of(&case, driven)
    })
}
