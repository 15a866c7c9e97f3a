//! The loop: one frame after the other, each handed on as soon as it is made; by hand, step by step ([`by_hand`](super::by_hand)).

use super::frame::{Frame, FrameSink, FrictionReading, Held, ObjectReading, PatchReading};
use super::free_objects::FreeObjects;
use super::plan::ScenePlan;
use super::plan_object::Movement;
use super::plan_patch::PlannedPatch;
use super::pressed_objects::PressedObjects;
use super::robot_state::RobotState;
use super::skin_state::{Detail, PlacedObjects, SkinState};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::random::Seed;
use crate::signal::Scratch;

/// Whether to step where nothing is remembered from step to step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// Frames alone, if no damper and no free object needs the steps between; then, only of patches with dampers.
    AsNeeded,
    /// All patches at all steps: the same frames, slower. For tests.
    Always,
}

/// A scene on its way.
#[derive(Clone, Debug)]
pub struct Simulation<'p> {
    pub(super) plan: &'p ScenePlan,
    pub(super) stepping: Stepping,
    pub(super) robots: Vec<RobotState>,
    skins: Vec<SkinState>,
    objects: PlacedObjects,
    /// Where imposed objects were put by hand, `world_from_object`; the others follow their motions.
    pub(super) put: Vec<Option<Pose>>,
    pressed: PressedObjects,
    pub(super) free: FreeObjects,
    /// One a patch: what the noise of its readings is drawn from.
    noise: Vec<Seed>,
    frame: Frame,
    scratch: Scratch,
    /// Seconds.
    pub(super) time: f64,
    /// Whether steps are made by hand, and no longer by the scene's clock.
    pub(super) is_by_hand: bool,
    /// How long the last step was, until the patches have felt it: whoever reads them decides how.
    unfelt: Option<f64>,
    n_read: usize,
    pub(super) n_steps: usize,
    n_unsettled: usize,
}

impl<'p> Simulation<'p> {
    /// A scene before its first frame.
    pub fn new(plan: &'p ScenePlan, stepping: Stepping) -> Self {
        Self::with_seed(plan, stepping, plan.spec.seed)
    }

    /// The same with noise of another seed than the plan's.
    pub(super) fn with_seed(plan: &'p ScenePlan, stepping: Stepping, seed: u64) -> Self {
        let signals = Seed::new(seed).named("signal");
        let skins = plan.patches.iter();
        let imposed = ObjectReading {
            pose: Pose::IDENTITY,
            held: Held::Imposed,
            balance: None,
        };
        let frame = Frame {
            time: 0.0,
            patches: skins.clone().map(untouched).collect(),
            objects: vec![imposed; plan.objects.len()],
            touches: Vec::new(),
        };
        Self {
            stepping,
            robots: plan.robots.iter().map(RobotState::of).collect(),
            noise: skins
                .clone()
                .map(|patch| signals.named(patch.skin.name()))
                .collect(),
            skins: skins.map(SkinState::of).collect(),
            put: vec![None; plan.objects.len()],
            objects: PlacedObjects {
                poses: vec![Pose::IDENTITY; plan.objects.len()],
                balls: plan.objects.iter().map(|object| object.ball).collect(),
            },
            pressed: PressedObjects::of(plan),
            free: FreeObjects::of(plan),
            frame,
            scratch: Scratch::default(),
            time: 0.0,
            is_by_hand: false,
            unfelt: None,
            n_read: 0,
            n_steps: 0,
            n_unsettled: 0,
            plan,
        }
    }

    /// Makes all frames that are left, and hands each to all sinks.
    ///
    /// # Errors
    /// The error is one of theirs, or of [`next_frame`](Self::next_frame).
    pub fn run(&mut self, sinks: &mut [&mut dyn FrameSink]) -> Result<()> {
        while let Some(frame) = self.next_frame()? {
            for sink in sinks.iter_mut() {
                sink.frame(frame)?;
            }
        }
        Ok(())
    }

    /// Goes to the next frame of the scene's clock; `None` after the last.
    ///
    /// # Errors
    /// A pose beyond all numbers; a scene that has been [stepped](Self::step) by hand.
    pub fn next_frame(&mut self) -> Result<Option<&Frame>> {
        let plan = self.plan;
        if self.is_by_hand {
            let given = "asked for after steps by hand";
            return Err(Error::input("next frame", given, "more steps, or a reset"));
        }
        if self.n_read == plan.n_frames {
            return Ok(None);
        }
        let time = plan.time(self.n_read);
        if self.n_read > 0 {
            let before = plan.time(self.n_read - 1);
            let n_steps = self.n_substeps();
            let dt = 1.0 / (plan.output_rate * n_steps as f64);
            for step in 1..n_steps {
                let share = step as f64 / n_steps as f64;
                self.advance(before + share * (time - before), dt)?;
            }
            self.advance(time, dt)?;
        }
        self.observe().map(Some)
    }

    /// What everything is like now: before any step, as if it had stood like this for long, which is the scene's first frame. What
    /// sensors read is drawn once: asked for again, the frame is the same.
    ///
    /// # Errors
    /// A pose beyond all numbers.
    pub fn observe(&mut self) -> Result<&Frame> {
        self.begin()?;
        if let Some(dt) = self.unfelt.take() {
            self.read(dt);
            self.n_read += 1;
            self.frame.time = self.time;
        }
        Ok(&self.frame)
    }

    /// Steps that were made, frames included.
    pub fn n_steps(&self) -> usize {
        self.n_steps
    }

    /// Steps, frames included, in which free objects were not at rest.
    pub fn n_unsettled(&self) -> usize {
        self.n_unsettled
    }

    fn n_substeps(&self) -> usize {
        let are_needed = self.stepping == Stepping::Always || self.plan.needs_steps();
        if are_needed { self.plan.n_substeps } else { 1 }
    }

    /// Stands as at the start, if nothing has been done yet.
    pub(super) fn begin(&mut self) -> Result<()> {
        match self.n_steps {
            0 => self.advance(0.0, f64::INFINITY),
            _ => Ok(()),
        }
    }

    /// One step: to where everything is at a time, `dt` seconds after the last one.
    pub(super) fn advance(&mut self, time: f64, dt: f64) -> Result<()> {
        if let Some(dt) = self.unfelt.take() {
            self.feel(dt);
        }
        self.go_to(time, dt)?;
        self.time = time;
        self.unfelt = Some(dt);
        Ok(())
    }

    /// Everything goes to where it is at a time, `dt` seconds after the last one.
    fn go_to(&mut self, time: f64, dt: f64) -> Result<()> {
        let plan = self.plan;
        self.n_steps += 1;
        for (state, robot) in self.robots.iter_mut().zip(&plan.robots) {
            state.place(robot, time)?;
        }
        let objects = self.objects.poses.iter_mut().zip(&plan.objects);
        for ((pose, object), put) in objects.zip(&self.put) {
            match &object.movement {
                Movement::Imposed(motion) => *pose = put.unwrap_or_else(|| motion.pose_at(time)),
                Movement::Carried(mount) => *pose = mount.place(&self.robots, &[]),
                Movement::Free { .. } => {}
            }
        }
        for (skin, patch) in self.skins.iter_mut().zip(&plan.patches) {
            skin.pose = patch.mount.place(&self.robots, &self.objects.poses);
        }
        let objects = &mut self.objects;
        self.pressed.push(plan, &self.skins, objects, [time, dt]);
        for (number, skin) in self.skins.iter_mut().enumerate() {
            skin.hold(self.pressed.contacts_on(plan, number));
        }
        let is_settled = self
            .free
            .settle(plan, &mut self.skins, &mut self.objects, [time, dt])?;
        self.n_unsettled += usize::from(!is_settled);
        Ok(())
    }

    /// Patches feel a step of which nobody is told.
    fn feel(&mut self, dt: f64) {
        let plan = self.plan;
        for (number, (skin, patch)) in self.skins.iter_mut().zip(&plan.patches).enumerate() {
            if patch.remembers() || self.stepping == Stepping::Always {
                let tips = self.free.tips_on(number);
                skin.feel(
                    patch,
                    &plan.models,
                    &self.objects,
                    (dt, &tips),
                    Detail::Deflections,
                );
            }
        }
    }

    /// How much of the scene's time has passed, by which sensors drift.
    fn share(&self) -> f64 {
        let n_frames = match self.is_by_hand {
            true => self.time * self.plan.output_rate,
            false => self.n_read as f64,
        };
        (n_frames / (self.plan.n_frames_uncut - 1).max(1) as f64).min(1.0)
    }

    /// Patches feel a step, and the frame is made.
    fn read(&mut self, dt: f64) {
        let plan = self.plan;
        let share = self.share();
        let patches = self.skins.iter_mut().zip(&plan.patches);
        let patches = patches.zip(&mut self.frame.patches).enumerate();
        for (number, ((skin, patch), reading)) in patches {
            let loads: Vec<_> = self.free.on_patch(number).collect();
            let carried = (&loads[..], &self.free.tips_on(number)[..]);
            skin.step_and_read(patch, &plan.models, &self.objects, dt, carried, reading);
            if let Some(signal) = &patch.signal {
                let name = self.noise[number].numbered(self.n_read as u64);
                signal.read(reading, &name, share, &mut self.scratch);
            }
        }
        for (reading, &pose) in self.frame.objects.iter_mut().zip(&self.objects.poses) {
            reading.pose = pose;
        }
        self.pressed.read(&mut self.frame.objects);
        self.free.read(&mut self.frame.objects);
        self.frame.touches.clear();
        self.frame.touches.extend(self.free.touches());
    }
}

fn untouched(patch: &PlannedPatch) -> PatchReading {
    let n_taxels = patch.skin.n_taxels();
    PatchReading {
        deflection: vec![0.0; n_taxels],
        force: vec![0.0; n_taxels],
        force3: vec![glam::DVec3::ZERO; n_taxels],
        friction: patch.shears.as_ref().map(|_| FrictionReading::default()),
        ..PatchReading::default()
    }
}
