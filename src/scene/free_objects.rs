//! Free objects of a scene, which move to a common equilibrium on skin, planes and other objects.

use super::frame::{ObjectReading, PoseControl};
use super::plan::ScenePlan;
use super::plan_object::Movement;
use super::skin_state::{PlacedObjects, SkinState};
use crate::contact::equilibrium::{
    Equilibrium, EquilibriumSolver, FreeObject, Ground, Obstacle, Outcome, PlacedSkin,
    RigidContact, TangentialSpring, TangentialSpringState, TaxelLoad, Touched,
};
use crate::contact::{OUT_OF_REACH, Press, Until, Workspace};
use crate::error::Result;
use crate::geometry::Pose;

/// Free objects of a scene, which move under gravity and contact forces until a common equilibrium.
#[derive(Clone, Debug)]
pub(super) struct FreeObjects<'p> {
    plan: &'p ScenePlan,
    all: Vec<Free>,
    /// Numbers (indices in the scene) of the free objects that took part in the last equilibrium.
    there: Vec<usize>,
    /// Numbers (indices in the scene) of the imposed and pressed objects, which are obstacles for free objects.
    obstacles: Vec<usize>,
    balancer: EquilibriumSolver,
    /// Deflections of each patch that imposed and pressed objects cause, metres; empty if none of these objects touches the patch.
    pushed: Vec<Vec<f64>>,
    workspace: Workspace,
}

/// Free object with its mass properties and state.
#[derive(Clone, Debug)]
struct Free {
    object: usize,
    mass: f64,
    center_of_mass: glam::DVec3,
    reading: ObjectReading,
    /// Whether a program has set the pose of the object and the object has not reached an equilibrium since then.
    is_put: bool,
}

impl<'p> FreeObjects<'p> {
    /// Creates the free objects of a scene at their initial poses.
    pub fn new(plan: &'p ScenePlan) -> Self {
        let objects = plan.objects.iter().enumerate();
        let is_free =
            |object: usize| matches!(plan.objects[object].movement, Movement::Free { .. });
        let all = objects.filter_map(|(object, planned)| match planned.movement {
            Movement::Imposed { .. } => None,
            Movement::Free {
                start,
                mass,
                center_of_mass,
            } => Some(Free {
                object,
                mass,
                center_of_mass,
                reading: at_start(start),
                is_put: true,
            }),
        });
        Self {
            plan,
            all: all.collect(),
            there: Vec::new(),
            obstacles: (0..plan.objects.len())
                .filter(|&object| !is_free(object))
                .collect(),
            balancer: EquilibriumSolver::new(),
            pushed: vec![Vec::new(); plan.patches.len()],
            workspace: Workspace::new(),
        }
    }

    /// Places the object with this scene number at a pose. In the next step, the object moves from this pose to its equilibrium.
    pub fn put(&mut self, object: usize, pose: Pose) {
        for free in self.all.iter_mut().filter(|free| free.object == object) {
            free.reading = at_start(pose);
            free.is_put = true;
        }
    }

    /// Computes the common equilibrium of all objects that have not escaped; returns whether the solver converged. The time since the last call is `dt`,
    /// infinite at the start.
    pub fn solve_equilibrium(
        &mut self,
        skins: &mut [SkinState],
        objects: &mut PlacedObjects,
        [time, dt]: [f64; 2],
    ) -> Result<bool> {
        if self.all.is_empty() {
            return Ok(true);
        }
        for free in &self.all {
            objects.poses[free.object] = OUT_OF_REACH;
        }
        self.push_by_others(skins, objects)?;
        self.attach_tangential_springs(skins, objects)?;
        let is_there = |free: &&mut Free| !matches!(free.reading.held, PoseControl::Escaped { .. });
        let mut there: Vec<&mut Free> = self.all.iter_mut().filter(is_there).collect();
        let own = |tip: TangentialSpring| {
            let object = there.iter().position(|free| free.object == tip.object)?;
            Some(TangentialSpring { object, ..tip })
        };
        let tips: Vec<Vec<TangentialSpring>> = skins
            .iter()
            .map(|skin| skin.tangential_springs().filter_map(own).collect())
            .collect();
        let skins = skins.iter().zip(&self.pushed).zip(&tips);
        let skins = skins.map(|((skin, pushed), tips)| PlacedSkin {
            patch: &skin.patch.skin,
            world_from_patch: skin.pose,
            pushed,
            before: (skin.patch.remembers() && dt.is_finite()).then(|| (skin.deflection(), dt)),
            tangential_springs: tips,
        });
        let models = objects.models;
        let bodies = there
            .iter()
            .map(|free| FreeObject::new(&models[free.object], free.mass, free.center_of_mass));
        let bodies = bodies.collect::<Result<Vec<_>>>()?;
        let starts: Vec<Pose> = there.iter().map(|free| free.reading.pose).collect();
        let obstacles = self.obstacles.iter().map(|&object| Obstacle {
            shape: (&models[object]).into(),
            pose: objects.poses[object],
        });
        let ground = Ground {
            skins: skins.collect(),
            planes: self.plan.planes.clone(),
            obstacles: obstacles.collect(),
        };
        let balances = self
            .balancer
            .solve_all(&bodies, &ground, self.plan.gravity, &starts)?;
        self.there = there.iter().map(|free| free.object).collect();
        for (free, balance) in there.iter_mut().zip(balances) {
            free.reading = reading(balance, time);
            if balance.is_there() {
                objects.poses[free.object] = balance.pose;
            }
        }
        Ok(there
            .iter()
            .all(|free| free.reading.held != PoseControl::NotConverged))
    }

    /// Returns the forces between free objects and the taxels of a patch, in taxel order.
    pub fn on_patch(&self, patch: usize) -> impl Iterator<Item = &TaxelLoad> {
        let loads = self.balancer.loads().iter();
        loads.filter(move |load| load.skin == patch)
    }

    /// Returns the tangential springs by which a patch with friction holds free objects, in taxel order, with the scene numbers of the objects.
    pub fn tips_on(&self, patch: usize) -> Vec<TangentialSpringState> {
        let tips = self.balancer.tangential_springs().iter();
        let own = tips
            .filter(|tip| tip.skin == patch)
            .map(|tip| TangentialSpringState {
                object: self.there[tip.object],
                ..*tip
            });
        own.collect()
    }

    /// Returns the contacts of free objects with planes and with other objects, identified by their numbers in the scene.
    pub fn touches(&self) -> impl Iterator<Item = RigidContact> {
        self.balancer.touches().iter().map(|touch| RigidContact {
            object: self.there[touch.object],
            other: match touch.other {
                Touched::Obstacle(number, sphere) => {
                    Touched::Object(self.obstacles[number], sphere)
                }
                Touched::Object(number, sphere) => Touched::Object(self.there[number], sphere),
                plane => plane,
            },
            ..*touch
        })
    }

    /// Attaches tangential springs at the present poses to objects that were just placed, and to objects that a patch with friction touches for the first time.
    /// Friction therefore also acts in the step in which a contact begins.
    fn attach_tangential_springs(
        &mut self,
        skins: &mut [SkinState],
        objects: &PlacedObjects,
    ) -> Result<()> {
        let has_friction = skins.iter().any(|skin| skin.patch.has_friction());
        for free in &mut self.all {
            let is_put = std::mem::take(&mut free.is_put);
            if !has_friction || matches!(free.reading.held, PoseControl::Escaped { .. }) {
                continue;
            }
            let mut only = objects.clone();
            only.poses.fill(OUT_OF_REACH);
            only.poses[free.object] = free.reading.pose;
            for skin in skins.iter_mut() {
                let is_held = skin
                    .tangential_springs()
                    .any(|spring| spring.object == free.object);
                if is_put || !is_held {
                    skin.put((free.object, &only), &mut self.workspace)?;
                }
            }
        }
        Ok(())
    }

    /// Computes the deflections of each patch that are caused by imposed and pressed objects.
    fn push_by_others(&mut self, skins: &[SkinState], objects: &PlacedObjects) -> Result<()> {
        for (skin, pushed) in skins.iter().zip(&mut self.pushed) {
            pushed.clear();
            if objects.can_reach(skin) {
                let poses: Vec<Pose> = objects.seen_by(skin).collect();
                let patch = &skin.patch.skin;
                Press::new(patch, objects.models, &poses, Until::Pose)
                    .with_contacts()
                    .run(&mut self.workspace)?;
                pushed.extend_from_slice(self.workspace.deflections());
            }
        }
        Ok(())
    }

    /// Writes the pose and equilibrium of each free object into `readings`, at the object's number in the scene.
    pub fn read(&self, readings: &mut [ObjectReading]) {
        for free in &self.all {
            readings[free.object] = free.reading;
        }
    }
}

fn at_start(pose: Pose) -> ObjectReading {
    ObjectReading {
        pose,
        held: PoseControl::AtRest,
        balance: None,
    }
}

fn reading(balance: Equilibrium, time: f64) -> ObjectReading {
    ObjectReading {
        pose: balance.pose,
        held: match balance.outcome {
            Outcome::AtRest => PoseControl::AtRest,
            Outcome::NotConverged => PoseControl::NotConverged,
            Outcome::Escaped { direction } => PoseControl::Escaped { time, direction },
        },
        balance: balance.is_there().then_some(balance),
    }
}
