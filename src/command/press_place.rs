//! Where an object lies under the patch that `bubbletouch press` presses on it.

use bubbletouch::objects::Model;
use bubbletouch::world::{RestPose, RestPoses, Touch};
use bubbletouch::{Error, Result};

const MM: f64 = 1e-3;

#[derive(clap::Args)]
#[group(id = "Place", multiple = true)]
pub struct Place {
    /// Which stable pose the object lies in, from 0 (the likeliest) [default: as modelled, its z up]
    #[arg(long, value_name = "N")]
    rest: Option<usize>,
    /// Where the patch is over the object's middle, along x [default: 0]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    offset_x_mm: Option<f64>,
    /// The same along y [default: 0]
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    offset_y_mm: Option<f64>,
    /// How the object is turned about the vertical [default: 0]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    yaw_deg: Option<f64>,
    /// How the patch is tilted about its x axis [default: 0]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    tilt_x_deg: Option<f64>,
    /// The same about its y axis [default: 0]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    tilt_y_deg: Option<f64>,
}

impl Place {
    /// Without its depth.
    pub fn touch(&self) -> Result<Touch> {
        let number = |name: &str, value: Option<f64>| match value.unwrap_or(0.0) {
            v if v.is_finite() => Ok(v),
            v => Err(Error::input(name, v, "a finite number")),
        };
        Ok(Touch {
            rest: 0,
            offset: [
                number("--offset-x-mm", self.offset_x_mm)? * MM,
                number("--offset-y-mm", self.offset_y_mm)? * MM,
            ],
            yaw: number("--yaw-deg", self.yaw_deg)?.to_radians(),
            tilt: [
                number("--tilt-x-deg", self.tilt_x_deg)?.to_radians(),
                number("--tilt-y-deg", self.tilt_y_deg)?.to_radians(),
            ],
            depth: 0.0,
            indices: [None; 7],
        })
    }

    /// How it lies; the error names a stable pose that the object has not.
    pub fn rest(&self, model: &Model) -> Result<RestPose> {
        let Some(number) = self.rest else {
            return Ok(RestPoses::AsModelled.of(model).swap_remove(0));
        };
        let mut poses = RestPoses::Stable.of(model);
        if number >= poses.len() {
            return Err(Error::input(
                "--rest",
                number,
                format!("0 to {}, the stable poses of this object", poses.len() - 1),
            ));
        }
        Ok(poses.swap_remove(number))
    }
}
