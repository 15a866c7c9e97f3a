//! Placement of touches: poses of a patch that approaches an object on a table from above.

use crate::arrays::view;
use crate::errors::{bad_input, guarded};
use crate::model::model_of;
use bubbletouch::world::{RestPoses, Touch};
use ndarray::{Array1, Array2};
use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;

/// Argument with groups of `width` numbers, such as offsets (x, y): one group for all touches, or one group per touch.
struct Groups {
    values: Vec<f64>,
    width: usize,
    is_one: bool,
}

impl Groups {
    fn new(place: &str, given: Option<&Bound<PyAny>>, width: usize) -> PyResult<Self> {
        let Some(given) = given else {
            return Ok(Self {
                values: vec![0.0; width],
                width,
                is_one: true,
            });
        };
        let one = if width == 1 { vec![] } else { vec![width] };
        let is_each = |shape: &[usize]| shape.len() == one.len() + 1 && shape[1..] == one[..];
        let allowed = match width {
            1 => "a number, or (n,)".to_owned(),
            _ => format!("({width},), or (n, {width})"),
        };
        let is_shape = |shape: &[usize]| shape == one || is_each(shape);
        view(place, given, &allowed, is_shape, |array| {
            let values: Vec<f64> = array.iter().copied().collect();
            match values.iter().find(|value| !value.is_finite()) {
                Some(bad) => Err(bad_input(place, bad, "finite numbers")),
                None => Ok(Self {
                    is_one: array.ndim() == one.len(),
                    values,
                    width,
                }),
            }
        })
    }

    fn len(&self) -> usize {
        self.values.len() / self.width
    }

    fn at(&self, number: usize) -> &[f64] {
        let number = if self.is_one { 0 } else { number };
        &self.values[number * self.width..][..self.width]
    }
}

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
    object: &Bound<'py, PyAny>,
    offset: Option<&Bound<'py, PyAny>>,
    yaw: Option<&Bound<'py, PyAny>>,
    tilt: Option<&Bound<'py, PyAny>>,
    rest: Option<i64>,
) -> PyResult<Bound<'py, PyAny>> {
    guarded(|| {
        let model = model_of("object", object)?;
        let offset = Groups::new("offset", offset, 2)?;
        let yaw = Groups::new("yaw", yaw, 1)?;
        let tilt = Groups::new("tilt", tilt, 2)?;
        let many = [&offset, &yaw, &tilt].map(|groups| (!groups.is_one).then_some(groups.len()));
        let mut lengths = many.into_iter().flatten();
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
                offset: [offset.at(number)[0], offset.at(number)[1]],
                yaw: yaw.at(number)[0],
                tilt: [tilt.at(number)[0], tilt.at(number)[1]],
                depth: 0.0,
                indices: [None; 7],
            };
            touch.patch_from_object(&rest).to_array()
        };
        Ok(match n {
            None => Array1::from_iter(pose(0)).into_pyarray(py).into_any(),
            Some(n) => {
                let values: Vec<f64> = (0..n).flat_map(pose).collect();
                let poses = Array2::from_shape_vec((n, 7), values).expect("seven numbers a pose");
                poses.into_pyarray(py).to_dyn().clone().into_any()
            }
        })
    })
}
