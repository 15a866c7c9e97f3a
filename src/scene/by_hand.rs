//! Scenes by hand: what a program moves itself, step by step, in place of what the scene's file says.
//!
//! What is set goes there in the next step, and stays; everything else goes on as the scene says. A step by hand of the same length, at the
//! same time and to the same places as one of the [time loop](Simulation::next_frame) is the same step, bit by bit, if it is observed
//! where the loop makes a frame.

use super::plan_object::Movement;
use super::simulation::Simulation;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::inputs::check::positive;
use crate::spelling::known;
use crate::world::{Interpolation, JointTrajectory};
use ndarray::Array2;

impl Simulation<'_> {
    /// Makes a step of `dt` seconds, which [`observe`](Self::observe) then reports.
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
    /// // Down until the palm is pushed with a newton.
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
    /// A step that is not a positive number of seconds; a pose beyond all numbers.
    pub fn step(&mut self, dt: f64) -> Result<()> {
        if !positive(dt) {
            let allowed = "a positive number of seconds";
            return Err(Error::input("step", format!("{dt} s"), allowed));
        }
        self.begin()?;
        self.is_by_hand = true;
        self.advance(self.time + dt, dt)
    }

    /// Back to before the first frame, and nothing is set by hand any more. What the skin is made of stays (where draped taxels are, the
    /// gains of its sensors); the noise of its readings is that of `seed`: with the plan's, all is as it was.
    pub fn reset(&mut self, seed: u64) {
        *self = Self::with_seed(self.plan, self.stepping, seed);
    }

    /// Seconds since the start.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// From the next step on a robot's joints are here: one number a [coordinate](crate::world::Robot::coordinates), rad and m.
    ///
    /// # Errors
    /// A name that no robot of the scene has; another number of positions; one that is not finite or beyond the limits of its joint.
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

    /// From the next step on a robot's base is here, `world_from_base`.
    ///
    /// # Errors
    /// A name that no robot of the scene has; a pose that is not finite.
    pub fn set_robot_pose(&mut self, robot: &str, pose: Pose) -> Result<()> {
        let number = self.robot(robot)?;
        check_pose(&format!("robots.{robot}"), &pose)?;
        self.robots[number].base = Some(pose);
        Ok(())
    }

    /// From the next step on an object is here, `world_from_object`. One that is pushed for a force starts its way from here; a free one
    /// comes to rest from here, also if it had escaped.
    ///
    /// # Errors
    /// A name that no object of the scene has; an object that a robot carries; a pose that is not finite.
    pub fn set_object_pose(&mut self, object: &str, pose: Pose) -> Result<()> {
        let objects = self.plan.objects.iter();
        let number = known("object", object, objects.map(|object| object.name.as_str()))?;
        let key = format!("objects.{object}");
        check_pose(&key, &pose)?;
        match self.plan.objects[number].movement {
            Movement::Imposed(_) => self.put[number] = Some(pose),
            Movement::Free { .. } => self.free.put(number, pose),
            Movement::Carried(_) => {
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
