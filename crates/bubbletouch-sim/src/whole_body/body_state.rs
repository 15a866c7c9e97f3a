//! State of a whole body, carried from step to step.

use super::body_patch::WholeBody;
use super::patch_state::PatchState;
use crate::contact::Instructions;
use crate::error::Result;
use crate::geometry::{Pose, check_poses};
use crate::objects::{Sphere, SphereClusters};
use crate::sensing::Columns;
use crate::text::in_range::positive;

/// Number of taxels deflected in the last step above which several threads compute a step. If smaller, the work ends before a second thread has started.
pub const WORTH_THREADS: usize = 4000;

/// Deflections of the taxels of a whole body, carried from one time step to the next. Reuse avoids allocations once the largest touch has been computed.
#[derive(Clone, Debug, Default)]
pub struct BodyState {
    patches: Vec<PatchState>,
    world_from_patches: Vec<Pose>,
    /// Bounding ball of each patch, enlarged by the taxels' radius, in the world frame, metres.
    balls: Vec<Sphere>,
    /// Bounding ball of each object at the present time step, in the world frame, metres.
    object_balls: Vec<Sphere>,
    /// Indices of the patches that the present time step must evaluate, ascending.
    busy: Vec<u32>,
    /// Duration of the last time step, seconds.
    dt: f64,
    instructions: Instructions,
    contact: BodyContact,
}

/// Summary of one time step of a whole body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyContact {
    /// Number of taxels with a deflection above zero.
    pub n_touched: usize,
    /// Number of saturated taxels, which an object pushes beyond the end of their stroke.
    pub n_saturated: usize,
    /// Number of patches with at least one deflected taxel.
    pub n_patches: usize,
    /// Number of pairs of a sphere and a patch for which rows, rings or tiles of taxels were evaluated. The candidates are all spheres of objects near a
    /// patch.
    pub n_evaluated: usize,
    /// Number of candidate pairs (sphere and patch) that were excluded by the bounding ball of a cluster or by their distance from the whole patch.
    pub n_rejected: usize,
}

impl BodyState {
    /// Creates the state of an untouched body whose patch frames coincide with the world frame.
    pub fn at_rest(body: &WholeBody) -> Self {
        let mut state = Self {
            patches: body.patches().iter().map(PatchState::at_rest).collect(),
            ..Self::default()
        };
        let poses = vec![Pose::IDENTITY; body.patches().len()];
        state.place(body, &poses).expect("valid poses");
        state
    }

    /// Selects the vector instructions for later time steps, for comparisons.
    pub fn use_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// Moves the patches to the poses `world_from_patches`, one per patch. A fixed body needs this only once.
    ///
    /// # Errors
    /// If there is not one pose for each patch, or a pose is not finite or has no unit quaternion.
    pub fn place(&mut self, body: &WholeBody, world_from_patches: &[Pose]) -> Result<()> {
        let patches = body.patches();
        check_poses("patch", patches.len(), world_from_patches)?;
        self.world_from_patches.clear();
        self.world_from_patches
            .extend_from_slice(world_from_patches);
        self.balls.clear();
        self.balls
            .extend(patches.iter().zip(world_from_patches).map(|(patch, pose)| {
                let ball = patch.ball();
                Sphere {
                    radius: ball.radius + patch.taxel().radius,
                    ..ball.placed(pose)
                }
            }));
        Ok(())
    }

    /// Advances the deflections by `dt` seconds (positive; irrelevant for taxels without dampers) to the objects' poses `world_from_objects`, one per object.
    ///
    /// Only patches near an object or with deflected taxels are evaluated. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// If there is not one pose for each object, a pose is not finite or has no unit quaternion, or `dt` is not positive. If the state belongs to a body with
    /// another number of patches.
    pub fn press(
        &mut self,
        body: &WholeBody,
        objects: &[SphereClusters],
        world_from_objects: &[Pose],
        dt: f64,
    ) -> Result<BodyContact> {
        check_poses("object", objects.len(), world_from_objects)?;
        check_poses("patch", body.patches().len(), &self.world_from_patches)?;
        positive("time step", dt, "s")?;
        self.dt = dt;
        self.find_busy(objects, world_from_objects);
        let (poses, balls, object_balls) =
            (&self.world_from_patches, &self.balls, &self.object_balls);
        let instructions = self.instructions;
        let step = |number: u32, state: &mut PatchState| {
            let number = number as usize;
            let placed = objects.iter().zip(world_from_objects).zip(object_balls);
            let near = placed
                .filter(|(_, ball)| ball.meets(&balls[number]))
                .map(|((object, pose), _)| (object, pose.seen_from(&poses[number])));
            state.step(&body.patches()[number], near, dt, instructions);
        };
        let share = self.contact.n_touched >= WORTH_THREADS;
        step_each(&self.busy, 0, &mut self.patches, share, &step);
        Ok(self.count())
    }

    /// Returns the taxels that were deflected in the last step, ascending, as pairs of index and deflection (metres).
    pub fn touched(&self, body: &WholeBody) -> impl Iterator<Item = (usize, f64)> {
        self.touched_of_patches(body).flat_map(|(first, touched)| {
            let touched = touched.iter();
            touched.map(move |&(taxel, deflection)| (first + taxel as usize, deflection))
        })
    }

    /// Computes the measurements of the last deflections, as [`Columns::measure_touched`] does for the [touched](Self::touched) taxels. The loop is compiled
    /// with this crate, also for callers that are compiled without optimisation.
    ///
    /// # Panics
    /// If a touched taxel has no column, or `measurements` does not have length m.
    pub fn measure(&self, body: &WholeBody, columns: &Columns, measurements: &mut [f64]) {
        columns.measure_touched(self.touched(body), measurements);
    }

    /// Returns the sum of the deflections of the last step, metres. The loop is compiled with this crate, also for callers without optimisation.
    pub fn total_deflection(&self, body: &WholeBody) -> f64 {
        self.touched(body).map(|(_, deflection)| deflection).sum()
    }

    /// Returns the deflected taxels patch by patch: the index of the patch's first taxel, and the touched taxels with indices relative to this taxel.
    pub(crate) fn touched_of_patches(
        &self,
        body: &WholeBody,
    ) -> impl Iterator<Item = (usize, &[(u32, f64)])> {
        self.busy.iter().map(|&number| {
            let patch = number as usize;
            (body.firsts()[patch], self.patches[patch].touched())
        })
    }

    /// Returns the forces on the deflected taxels, ascending, as pairs of index and force (newtons). The force is 0 for a taxel that relaxes freely.
    ///
    /// The forces equal the forces of `DamperState`. Without a damper, the force is the stiffness times the deflection. With a damper, it is the constant
    /// force that moves the taxel to its deflection within the last time step.
    pub fn forces(&self, body: &WholeBody) -> impl Iterator<Item = (usize, f64)> {
        self.busy.iter().flat_map(|&number| {
            let (patch, first) = (number as usize, body.firsts()[number as usize]);
            let forces = self.patches[patch].forces(&body.patches()[patch], self.dt);
            forces.map(move |(taxel, force)| (first + taxel as usize, force))
        })
    }

    /// Returns the number of patches that the last time step evaluated: patches near an object or with deflected taxels.
    pub fn n_visited(&self) -> usize {
        self.busy.len()
    }

    /// Returns the memory that the state uses in bytes.
    pub fn n_bytes(&self) -> usize {
        let patches = self.patches.iter().map(PatchState::n_bytes).sum::<usize>();
        patches + self.patches.len() * (size_of::<Pose>() + size_of::<Sphere>() + size_of::<u32>())
    }

    /// Returns all deflections of one patch, metres, shape (n_taxels,), in the order of its layout.
    ///
    /// # Panics
    /// If the patch does not exist.
    pub fn deflections(&self, patch: usize) -> &[f64] {
        self.patches[patch].deflections()
    }

    fn find_busy(&mut self, objects: &[SphereClusters], world_from_objects: &[Pose]) {
        self.object_balls.clear();
        let placed = objects.iter().zip(world_from_objects);
        self.object_balls
            .extend(placed.map(|(object, pose)| object.ball().placed(pose)));
        self.busy.clear();
        self.busy.reserve(self.patches.len());
        for (number, (state, ball)) in self.patches.iter().zip(&self.balls).enumerate() {
            if !state.is_at_rest() || self.object_balls.iter().any(|it| it.meets(ball)) {
                self.busy.push(number as u32);
            }
        }
    }

    fn count(&mut self) -> BodyContact {
        self.contact = BodyContact::default();
        for &number in &self.busy {
            let patch = &self.patches[number as usize];
            self.contact.n_touched += patch.touched().len();
            self.contact.n_saturated += patch.n_saturated();
            self.contact.n_evaluated += patch.n_evaluated;
            self.contact.n_rejected += patch.n_rejected;
            self.contact.n_patches += usize::from(!patch.touched().is_empty());
        }
        self.contact
    }
}

/// Calls `step` with the index of each listed state and the state itself; `first` is the index of the first element of `states`. Threads share the work by
/// recursive halving.
fn step_each(
    numbers: &[u32],
    first: u32,
    states: &mut [PatchState],
    share: bool,
    step: &(impl Fn(u32, &mut PatchState) + Sync),
) {
    if !share || numbers.len() < 2 {
        for &number in numbers {
            step(number, &mut states[(number - first) as usize]);
        }
        return;
    }
    let (left, right) = numbers.split_at(numbers.len() / 2);
    let middle = right[0];
    let (left_states, right_states) = states.split_at_mut((middle - first) as usize);
    rayon::join(
        || step_each(left, first, left_states, share, step),
        || step_each(right, middle, right_states, share, step),
    );
}
