//! Pose of an object below the patch that `bubbletouch press` presses on the object.

use bubbletouch::objects::Model;
use bubbletouch::world::{RestPose, RestPoses, Touch};
use bubbletouch::{Error, Result};

const MM: f64 = 1e-3;

#[derive(clap::Args)]
#[group(id = "Place", multiple = true)]
pub struct Place {
    /// Lay the object in stable pose N, 0 the likeliest [default: as modelled]
    #[arg(long, value_name = "N", help_heading = "Press")]
    rest: Option<usize>,
    /// Shift the patch along x from the object's middle
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    offset_x_mm: f64,
    /// Shift the patch along y from the object's middle
    #[arg(long, value_name = "MM", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    offset_y_mm: f64,
    /// Turn the object about the vertical
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    yaw_deg: f64,
    /// Tilt the patch about its x axis
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    tilt_x_deg: f64,
    /// Tilt the patch about its y axis
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, default_value_t = 0.0, value_parser = finite, help_heading = "Press")]
    tilt_y_deg: f64,
}

fn finite(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "expected a finite number".to_owned())
}

impl Place {
    /// Without its depth.
    pub fn touch(&self) -> Touch {
        Touch {
            rest: 0,
            offset: [self.offset_x_mm, self.offset_y_mm].map(|mm| mm * MM),
            yaw: self.yaw_deg.to_radians(),
            tilt: [self.tilt_x_deg, self.tilt_y_deg].map(f64::to_radians),
            depth: 0.0,
            indices: [None; 7],
        }
    }

    /// Returns the stable pose in which the object lies; returns an error if the object does not have the requested pose.
    pub fn rest(&self, model: &Model) -> Result<RestPose> {
        let Some(number) = self.rest else {
            return Ok(RestPoses::AsModelled.poses(model).swap_remove(0));
        };
        let mut poses = RestPoses::Stable.poses(model);
        if number >= poses.len() {
            let last = poses.len() - 1;
            let allowed = format!("0 to {last}, the stable poses of this object");
            return Err(Error::input("--rest", number, allowed));
        }
        Ok(poses.swap_remove(number))
    }
}
