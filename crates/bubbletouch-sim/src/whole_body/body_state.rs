//! A body from step to step.

use super::body_patch::WholeBody;
use super::patch_state::PatchState;
use crate::contact::Instructions;
use crate::geometry::Pose;
use crate::objects::{Sphere, SphereClusters};

/// Deflected taxels at the last step from which on threads share the work. Less is done before a second thread is awake.
pub const WORTH_THREADS: usize = 4000;

/// What touches a body, between steps; it is reused, so a step allocates nothing once the largest touch has been seen.
#[derive(Clone, Debug, Default)]
pub struct BodyState {
    patches: Vec<PatchState>,
    world_from_patches: Vec<Pose>,
    /// Around each patch, ρ in it, in the world frame, metres.
    balls: Vec<Sphere>,
    /// Around each object at this step, in the world frame, metres.
    object_balls: Vec<Sphere>,
    /// Patches with something to do in this step; ascending.
    busy: Vec<u32>,
    /// How long this step was, seconds.
    dt: f64,
    instructions: Instructions,
    contact: BodyContact,
}

/// What a step did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BodyContact {
    /// Taxels with a deflection above zero.
    pub n_touched: usize,
    /// Taxels at their stroke that an object would push further.
    pub n_saturated: usize,
    /// Patches with a deflected taxel.
    pub n_patches: usize,
    /// Pairs of a sphere and a patch for which rows, rings or tiles were looked at: what is left of those of all spheres of the
    /// objects near a patch.
    pub n_evaluated: usize,
    /// The other ones of those pairs, left out with their clusters or by their distance from the whole patch.
    pub n_rejected: usize,
}

impl BodyState {
    /// An untouched body, all its patches with their frames in the world's.
    pub fn at_rest(body: &WholeBody) -> Self {
        let mut state = Self {
            patches: body.patches().iter().map(PatchState::at_rest).collect(),
            ..Self::default()
        };
        state.place(body, &vec![Pose::IDENTITY; body.patches().len()]);
        state
    }

    /// Has the steps computed by some other than the best instructions, to compare them.
    pub fn use_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// Moves the patches to `world_from_patch` poses, one each. A body that stands still is placed once.
    ///
    /// # Panics
    /// If there are not as many poses as patches.
    pub fn place(&mut self, body: &WholeBody, world_from_patches: &[Pose]) {
        let patches = body.patches();
        assert_eq!(world_from_patches.len(), patches.len(), "one pose a patch");
        self.world_from_patches.clear();
        self.world_from_patches
            .extend_from_slice(world_from_patches);
        self.balls.clear();
        self.balls
            .extend(patches.iter().zip(world_from_patches).map(|(patch, pose)| {
                let Sphere { center, radius } = patch.ball();
                Sphere {
                    center: pose.transform_point(center),
                    radius: radius + patch.taxel().radius,
                }
            }));
    }

    /// Goes `dt` seconds (positive; of no effect on taxels without dampers) to where the objects are at `world_from_object`
    /// poses, one each.
    ///
    /// Nothing that is not near an object, or still deflected, is looked at. The result does not depend on the number of threads.
    ///
    /// # Panics
    /// If there are not as many poses as objects, or if the state is another body's.
    pub fn press(
        &mut self,
        body: &WholeBody,
        objects: &[SphereClusters],
        world_from_objects: &[Pose],
        dt: f64,
    ) -> BodyContact {
        let n_objects = objects.len();
        assert_eq!(n_objects, world_from_objects.len(), "one pose an object");
        assert_eq!(
            self.patches.len(),
            body.patches().len(),
            "a state of this body"
        );
        self.dt = dt;
        self.find_busy(objects, world_from_objects);
        let (poses, balls, object_balls) =
            (&self.world_from_patches, &self.balls, &self.object_balls);
        let instructions = self.instructions;
        let step = |number: u32, state: &mut PatchState| {
            let number = number as usize;
            let placed = objects.iter().zip(world_from_objects).zip(object_balls);
            let near = placed
                .filter(|(_, ball)| are_near(ball, &balls[number]))
                .map(|((object, pose), _)| (object, pose.seen_from(&poses[number])));
            state.step(&body.patches()[number], near, dt, instructions);
        };
        let share = self.contact.n_touched >= WORTH_THREADS;
        step_each(&self.busy, 0, &mut self.patches, share, &step);
        self.count()
    }

    /// The deflected taxels of the last step, ascending: number and deflection, metres.
    pub fn touched(&self, body: &WholeBody) -> impl Iterator<Item = (usize, f64)> {
        self.touched_of_patches(body).flat_map(|(first, touched)| {
            let touched = touched.iter();
            touched.map(move |&(taxel, deflection)| (first + taxel as usize, deflection))
        })
    }

    /// The same patch by patch: the number of its first taxel, and how far from there each of the touched ones is numbered.
    pub(crate) fn touched_of_patches(
        &self,
        body: &WholeBody,
    ) -> impl Iterator<Item = (usize, &[(u32, f64)])> {
        self.busy.iter().map(|&number| {
            let patch = number as usize;
            (body.firsts()[patch], self.patches[patch].touched())
        })
    }

    /// The forces on the deflected taxels, ascending: number and newtons; 0 on one that relaxes freely.
    ///
    /// They are those of [`DamperState`](crate::contact::DamperState): kδ without a damper, else the constant force that takes
    /// the taxel there within the last step, which tends to kδ + cδ̇.
    pub fn forces(&self, body: &WholeBody) -> impl Iterator<Item = (usize, f64)> {
        self.busy.iter().flat_map(|&number| {
            let (patch, first) = (number as usize, body.firsts()[number as usize]);
            let forces = self.patches[patch].forces(&body.patches()[patch], self.dt);
            forces.map(move |(taxel, force)| (first + taxel as usize, force))
        })
    }

    /// How many patches the last step looked at: those near an object, and those on which something was still deflected.
    pub fn n_visited(&self) -> usize {
        self.busy.len()
    }

    /// Bytes that it holds of each patch and taxel.
    pub fn n_bytes(&self) -> usize {
        let patches = self.patches.iter().map(PatchState::n_bytes).sum::<usize>();
        patches + self.patches.len() * (size_of::<Pose>() + size_of::<Sphere>() + size_of::<u32>())
    }

    /// All deflections of one patch, n_taxels, metres, in the order of its layout.
    ///
    /// # Panics
    /// If there is no such patch.
    pub fn deflections(&self, patch: usize) -> &[f64] {
        self.patches[patch].deflections()
    }

    fn find_busy(&mut self, objects: &[SphereClusters], world_from_objects: &[Pose]) {
        self.object_balls.clear();
        self.object_balls
            .extend(objects.iter().zip(world_from_objects).map(in_world));
        self.busy.clear();
        self.busy.reserve(self.patches.len());
        for (number, (state, ball)) in self.patches.iter().zip(&self.balls).enumerate() {
            let is_near = |object: &Sphere| are_near(object, ball);
            if !state.is_at_rest() || self.object_balls.iter().any(is_near) {
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

/// The ball around an object that is at a pose.
fn in_world((object, pose): (&SphereClusters, &Pose)) -> Sphere {
    let Sphere { center, radius } = object.ball();
    Sphere {
        center: pose.transform_point(center),
        radius,
    }
}

/// Whether two balls overlap.
fn are_near(a: &Sphere, b: &Sphere) -> bool {
    let reach = a.radius + b.radius;
    a.center.distance_squared(b.center) <= reach * reach
}

/// Calls `step` with each number and its state, of which `states` begins with that of `first`; halves are shared by threads.
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
