//! Placement of touches: poses of a patch that approaches an object on a table from above.

use crate::arrays::{Object, Rows, to_column, to_matrix};
use crate::errors::{bad_input, guarded};
use crate::model::model_of;
use bubbletouch::world::{RestPoses, Touch};
use pyo3::prelude::*;

/// Returns object poses for Patch.press: the object lies on a table under a patch that faces down.
///
/// The object stands with its own z axis up or, with `rest`, in the stable pose of that number (0: the most probable). Its bounding box is centred
/// at x = y = 0 and turned by `yaw` about the vertical. The axis of the patch goes through `offset` (x, y) at the height of the object's top. The
/// axis is tilted by `tilt` about the patch's x axis, then about its y axis.
///
/// offset: metres, (2,) or (n, 2).
/// tilt: radians, (2,) or (n, 2).
/// yaw: radians, one number or (n,).
///
/// Returns (7,) if all arguments are single values, otherwise (n, 7). Raises ValueError if an argument is invalid.
#[pyfunction]
#[pyo3(signature = (object, *, offset=None, yaw=None, tilt=None, rest=None))]
pub fn touch_poses<'py>(
    py: Python<'py>,
    object: &Object<'py>,
    offset: Option<&Object<'py>>,
    yaw: Option<&Object<'py>>,
    tilt: Option<&Object<'py>>,
    rest: Option<i64>,
) -> PyResult<Object<'py>> {
    guarded(|| {
        let model = model_of("object", object)?;
        let offset = by_touch::<2>("offset", offset)?;
        let yaw = by_touch::<1>("yaw", yaw)?;
        let tilt = by_touch::<2>("tilt", tilt)?;
        let mut lengths = [offset.n(), yaw.n(), tilt.n()].into_iter().flatten();
        let n = lengths.next();
        if let Some(other) = lengths.find(|other| Some(*other) != n) {
            let given = format!("{} of one and {other} of another", n.unwrap_or(1));
            return Err(bad_input(
                "touch_poses",
                given,
                "as many offsets, yaws and tilts",
            ));
        }
        let mut rests = py.detach(|| match rest {
            None => RestPoses::AsModelled.poses(model),
            Some(_) => RestPoses::Stable.poses(model),
        });
        let number = usize::try_from(rest.unwrap_or(0)).unwrap_or(usize::MAX);
        if number >= rests.len() {
            let allowed = format!("0 to {}, the stable poses of this object", rests.len() - 1);
            return Err(bad_input("rest", rest.unwrap_or(0), allowed));
        }
        let rest = rests.swap_remove(number);
        let pose = |number: usize| {
            let touch = Touch {
                rest: 0,
                offset: offset.at(number),
                yaw: yaw.at(number)[0],
                tilt: tilt.at(number),
                depth: 0.0,
                indices: [None; 7],
            };
            touch.patch_from_object(&rest).to_array()
        };
        Ok(match n {
            None => to_column(py, pose(0)).into_any(),
            Some(n) => to_matrix(py, (0..n).map(pose).collect()).into_any(),
        })
    })
}

/// Reads an argument with N numbers for all touches, or for each touch; the default is zero.
fn by_touch<const N: usize>(place: &str, given: Option<&Object>) -> PyResult<Rows<N>> {
    given.map_or(Ok(Rows::common([0.0; N])), |given| Rows::read(place, given))
}
