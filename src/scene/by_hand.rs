//! Manual control of a scene: a program sets poses and joint positions in place of the scene file.
//!
//! A manually set pose takes effect in the next step and remains. All other motions follow the scene file.
//!
//! A manual step equals a step of the time loop bit by bit if its length, time and poses are equal. The manual step must then be
//! observed where the time loop makes a frame.

use super::plan_object::Movement;
use super::planned::Carrier;
use super::simulation::Simulation;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::inputs::range::positive;
use crate::spelling::known;
use crate::world::{Interpolation, JointTrajectory};
use ndarray::Array2;

impl Simulation<'_> {
    /// Advances the simulation by one step of `dt` seconds. The method `observe` returns the new state.
    ///
    /// ```
    /// use bubbletouch::geometry::Pose;
    /// use bubbletouch::scene::{ScenePlan, SceneSpec, Simulation, Stepping};
    /// use glam::DVec3;
    ///
    /// let spec = SceneSpec::parse("ball.toml", r#"
    /// title = "A ball over a palm"
    /// patches = [{ name = "palm", layout = { grid = { nx = 16, ny = 16, pitch_mm = 4.0 } }, stroke_mm = 5.0 }]
    /// objects = [{ name = "ball", object = "tennis" }]
    /// "#)?;
    /// let plan = ScenePlan::new("ball.toml", std::path::Path::new(""), spec)?;
    /// let mut simulation = Simulation::new(&plan, Stepping::AsNeeded);
    /// // Moves down until the force on the palm is one newton.
    /// let mut height = 0.0;
    /// while simulation.observe()?.patches[0].wrench.force.z > -1.0 {
    ///     height -= 0.1e-3;
    ///     simulation.set_object_pose("ball", Pose::from_translation(height * DVec3::Z))?;
    ///     simulation.step(0.01)?;
    /// }
    /// assert!(simulation.observe()?.patches[0].n_touched > 8);
    /// # Ok::<(), bubbletouch::Error>(())
    /// ```
    ///
    /// # Errors
    /// If `dt` is not a positive number, or a pose overflows.
    pub fn step(&mut self, dt: f64) -> Result<()> {
        if !positive(dt) {
            let allowed = "a positive number of seconds";
            return Err(Error::input("step", format!("{dt} s"), allowed));
        }
        self.begin()?;
        self.is_by_hand = true;
        self.advance(self.time + dt, dt)
    }

    /// Resets the simulation to the state before the first frame, without manual poses and joint positions. The skin keeps its drawn properties (positions of
    /// draped taxels, sensor gains). `seed` determines the noise of the readings; the plan's seed restores the original noise.
    pub fn reset(&mut self, seed: u64) {
        *self = Self::with_seed(self.plan, self.stepping, seed);
    }

    /// Returns the time since the start of the scene, seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Sets a robot's joint positions from the next step on: one number per joint coordinate, rad or m.
    ///
    /// # Errors
    /// If the scene has no robot of this name, or the number of positions is wrong. If a position is not finite or exceeds the limits of its joint.
    pub fn set_joint_positions(&mut self, robot: &str, positions: &[f64]) -> Result<()> {
        let number = self.robot(robot)?;
        let row = Array2::from_shape_vec((1, positions.len()), positions.to_vec());
        let row = row.expect("it is one row");
        let held = vec![self.time];
        let carrier = &self.plan.robots[number].robot;
        JointTrajectory::new(carrier, held, row, Interpolation::default())
            .map_err(|error| error.under(format!("robots.{robot}: ")))?;
        self.robots[number].set_positions(positions);
        Ok(())
    }

    /// Sets the pose of a robot's base, `world_from_base`, from the next step on.
    ///
    /// # Errors
    /// If the scene has no robot of this name, or the pose is not finite.
    pub fn set_robot_pose(&mut self, robot: &str, pose: Pose) -> Result<()> {
        let number = self.robot(robot)?;
        check_pose(&format!("robots.{robot}"), &pose)?;
        self.robots[number].base = Some(pose);
        Ok(())
    }

    /// Sets the pose of an object, `world_from_object`, from the next step on. A pressed object starts its travel at this pose. A free object moves from this
    /// pose to its equilibrium, even if it had escaped.
    ///
    /// # Errors
    /// If the scene has no object of this name, a robot carries the object, or the pose is not finite.
    pub fn set_object_pose(&mut self, object: &str, pose: Pose) -> Result<()> {
        let objects = self.plan.objects.iter();
        let number = known("object", object, objects.map(|object| object.name.as_str()))?;
        let key = format!("objects.{object}");
        check_pose(&key, &pose)?;
        match self.plan.objects[number].movement {
            Movement::Free { .. } => self.free.put(number, pose),
            Movement::Imposed {
                carrier: Carrier::World,
                ..
            } => self.put[number] = Some(pose),
            Movement::Imposed { .. } => {
                let given = "an object that a robot carries";
                return Err(Error::input(key, given, "the pose or joints of the robot"));
            }
        }
        Ok(())
    }

    fn robot(&self, name: &str) -> Result<usize> {
        let robots = self.plan.robots.iter();
        known("robot", name, robots.map(|robot| robot.name.as_str()))
    }
}

fn check_pose(place: &str, pose: &Pose) -> Result<()> {
    if pose.translation.is_finite() && pose.rotation.is_normalized() {
        return Ok(());
    }
    let given = format!("at {}, turned by {}", pose.translation, pose.rotation);
    Err(Error::input(
        place,
        given,
        "finite metres and a unit quaternion",
    ))
}
