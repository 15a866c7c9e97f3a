//! Time loop of a scene, in which every frame is passed to a receiver immediately after its computation. The module `by_hand` contains manual steps.

use super::frame::{Frame, FrameSink, FrictionReading, ObjectReading, PatchReading, PoseControl};
use super::free_objects::FreeObjects;
use super::plan::ScenePlan;
use super::plan_object::Movement;
use super::planned::PlannedPatch;
use super::pressed_objects::PressedObjects;
use super::robot_state::RobotState;
use super::skin_state::{Detail, PlacedObjects, SkinState};
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::random::Seed;
use crate::signal::SignalWorkspace;

/// Rule that selects the time steps to compute between two frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stepping {
    /// Computes only the time steps and patches on which later frames depend. Steps between frames are skipped if no later frame depends on them; otherwise
    /// only patches with dampers or friction are computed.
    AsNeeded,
    /// Computes all patches in all time steps. The frames are equal but take longer to compute; used in tests.
    Always,
}

/// Simulation of a scene, which computes its frames one after the other.
#[derive(Clone, Debug)]
pub struct Simulation<'p> {
    pub(super) plan: &'p ScenePlan,
    pub(super) stepping: Stepping,
    pub(super) robots: Vec<RobotState<'p>>,
    skins: Vec<SkinState<'p>>,
    objects: PlacedObjects<'p>,
    /// Pose `world_from_object` of each imposed object that a program set; `None` for objects that follow their motions.
    pub(super) put: Vec<Option<Pose>>,
    pressed: PressedObjects<'p>,
    pub(super) free: FreeObjects<'p>,
    /// Seed of the sensor noise of each patch.
    noise: Vec<Seed>,
    frame: Frame,
    scratch: SignalWorkspace,
    /// Time since the start of the scene, seconds.
    pub(super) time: f64,
    /// Whether a program makes the time steps, in place of the clock of the scene.
    pub(super) is_by_hand: bool,
    /// Duration of the last step, seconds, if the deflections of its patches have not been computed yet. The required computations depend on whether a frame is
    /// read next.
    pending_dt: Option<f64>,
    n_read: usize,
    pub(super) n_steps: usize,
    n_unsettled: usize,
}

impl<'p> Simulation<'p> {
    /// Creates a simulation in its state before the first frame.
    pub fn new(plan: &'p ScenePlan, stepping: Stepping) -> Self {
        Self::with_seed(plan, stepping, plan.spec.seed)
    }

    /// Creates a simulation with a given seed of the sensor noise, in place of the seed of the scene.
    pub(super) fn with_seed(plan: &'p ScenePlan, stepping: Stepping, seed: u64) -> Self {
        let signals = Seed::new(seed).named("signal");
        let skins = plan.patches.iter();
        let imposed = ObjectReading {
            pose: Pose::IDENTITY,
            held: PoseControl::Imposed,
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
            robots: plan.robots.iter().map(RobotState::new).collect(),
            noise: skins
                .clone()
                .map(|patch| signals.named(patch.skin.name()))
                .collect(),
            skins: skins.map(SkinState::new).collect(),
            put: vec![None; plan.objects.len()],
            objects: PlacedObjects {
                models: &plan.models,
                poses: vec![Pose::IDENTITY; plan.objects.len()],
                balls: plan.objects.iter().map(|object| object.ball).collect(),
            },
            pressed: PressedObjects::new(plan),
            free: FreeObjects::new(plan),
            frame,
            scratch: SignalWorkspace::default(),
            time: 0.0,
            is_by_hand: false,
            pending_dt: None,
            n_read: 0,
            n_steps: 0,
            n_unsettled: 0,
            plan,
        }
    }

    /// Computes all remaining frames and passes each frame to all sinks.
    ///
    /// # Errors
    /// If a sink fails, a pose overflows, or the scene has been stepped manually.
    pub fn run(&mut self, sinks: &mut [&mut dyn FrameSink]) -> Result<()> {
        while let Some(frame) = self.next_frame()? {
            for sink in sinks.iter_mut() {
                sink.frame(frame)?;
            }
        }
        Ok(())
    }

    /// Computes the next frame of the scene. Returns `None` after the last frame.
    ///
    /// # Errors
    /// If a pose overflows, or the scene has been stepped manually.
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

    /// Returns the current frame. Before any step, this is the first frame of the scene, in its steady state. Sensor noise is drawn once per frame, so a second
    /// call returns an equal frame.
    ///
    /// # Errors
    /// If a pose overflows.
    pub fn observe(&mut self) -> Result<&Frame> {
        self.begin()?;
        if let Some(dt) = self.pending_dt.take() {
            self.read(dt)?;
            self.n_read += 1;
            self.frame.time = self.time;
        }
        Ok(&self.frame)
    }

    /// Returns the number of time steps computed so far, including the steps that produced frames.
    pub fn n_steps(&self) -> usize {
        self.n_steps
    }

    /// Returns the number of steps, including frames, in which the free objects did not reach an equilibrium.
    pub fn n_unsettled(&self) -> usize {
        self.n_unsettled
    }

    fn n_substeps(&self) -> usize {
        let are_needed = self.stepping == Stepping::Always || self.plan.needs_steps();
        if are_needed { self.plan.n_substeps } else { 1 }
    }

    /// Computes the initial state of the scene if no step has been made before.
    pub(super) fn begin(&mut self) -> Result<()> {
        match self.n_steps {
            0 => self.advance(0.0, f64::INFINITY),
            _ => Ok(()),
        }
    }

    /// Advances the simulation to `time`, which is `dt` seconds after the last step.
    pub(super) fn advance(&mut self, time: f64, dt: f64) -> Result<()> {
        if let Some(dt) = self.pending_dt.take() {
            self.update_deflections(dt)?;
        }
        self.move_to_time(time, dt)?;
        self.time = time;
        self.pending_dt = Some(dt);
        Ok(())
    }

    /// Moves robots, objects and patches to their poses at `time`; `dt` is the time since the last step, seconds.
    fn move_to_time(&mut self, time: f64, dt: f64) -> Result<()> {
        let plan = self.plan;
        self.n_steps += 1;
        for robot in &mut self.robots {
            robot.place(time)?;
        }
        let objects = self.objects.poses.iter_mut().zip(&plan.objects);
        for ((pose, object), put) in objects.zip(&self.put) {
            if let Movement::Imposed { carrier, motion } = &object.movement {
                let at = || carrier.place(&motion.pose_at(time), &self.robots, &[]);
                *pose = put.unwrap_or_else(at);
            }
        }
        for skin in &mut self.skins {
            let objects = &self.objects.poses;
            skin.pose = skin
                .patch
                .carrier
                .place(&skin.patch.at, &self.robots, objects);
        }
        let objects = &mut self.objects;
        self.pressed.push(&self.skins, objects, [time, dt])?;
        for (number, skin) in self.skins.iter_mut().enumerate() {
            skin.hold(self.pressed.contacts_on(number));
        }
        let skins = &mut self.skins;
        let is_settled = self.free.solve_equilibrium(skins, objects, [time, dt])?;
        self.n_unsettled += usize::from(!is_settled);
        Ok(())
    }

    /// Updates the deflections of the patches after a time step at which no frame is written.
    fn update_deflections(&mut self, dt: f64) -> Result<()> {
        for (number, skin) in self.skins.iter_mut().enumerate() {
            if skin.patch.remembers() || self.stepping == Stepping::Always {
                let tips = self.free.tips_on(number);
                skin.update_deflections(&self.objects, (dt, &tips), Detail::Deflections)?;
            }
        }
        Ok(())
    }

    /// Returns the elapsed fraction of the scene's duration, 0 to 1; the drift of the sensors depends on this fraction.
    fn share(&self) -> f64 {
        let n_frames = match self.is_by_hand {
            true => self.time * self.plan.output_rate,
            false => self.n_read as f64,
        };
        (n_frames / (self.plan.n_frames_uncut - 1).max(1) as f64).min(1.0)
    }

    /// Computes all patches after a step of `dt` seconds, and writes the results to the frame.
    fn read(&mut self, dt: f64) -> Result<()> {
        let plan = self.plan;
        let share = self.share();
        let patches = self.skins.iter_mut().zip(&mut self.frame.patches);
        for (number, (skin, reading)) in patches.enumerate() {
            let loads: Vec<_> = self.free.on_patch(number).collect();
            let carried = (&loads[..], &self.free.tips_on(number)[..]);
            skin.step_and_read(&self.objects, dt, carried, reading)?;
            skin.keep_stopped(|object| {
                let object = &plan.objects[object];
                object.press.is_none() && !matches!(object.movement, Movement::Free { .. })
            });
            if let Some(signal) = &skin.patch.signal {
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
        Ok(())
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
