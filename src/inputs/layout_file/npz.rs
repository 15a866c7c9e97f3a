//! Layouts stored as NumPy archives, in one of two forms. The first form has `positions` (n × 3, metres), `normals` (n × 3), and optionally `radii` (n, metres)
//! and `pixels` (n × 2: row, column). The second form, used for Analog Devices' DEX-01, has `poses` (n × 3 × 4) and `taxel2pixel` (n × 2), and optionally
//! `radii`. A pose is a rotation matrix, whose third column is the normal, followed by the position in metres. Other names
//! such as `points`, `centers` and `axes` are read too. The options may contain another unit than metres.

use super::{LayoutFile, LayoutOptions, Points};
use crate::error::{Error, Result};
use crate::geometry::written_rotation_matrix;
use crate::inputs::arrays::{FileArray, TableContent, member_names};
use glam::{DMat3, DVec3};
use ndarray::{Array1, Array2, Array3, ArrayD};
use ndarray_npy::{NpzWriter, WriteNpzError};
use std::io::Cursor;
use std::path::Path;

/// Names of the arrays of a layout file: one row per array. The reader accepts all names of a row; the writer uses the first name.
const NAMES: [&[&str]; 5] = [
    &["positions", "position", "points", "centers", "xyz"],
    &["normals", "normal", "axes"],
    &["radii", "radius", "taxel_radius"],
    &["pixels", "taxel2pixel"],
    &["poses"],
];
const ALLOWED: &str = "positions and normals, or poses";

/// Reads a layout of taxels from a `.npz` archive of NumPy arrays.
pub(super) fn read(path: &Path, options: LayoutOptions) -> Result<LayoutFile> {
    let place = path.display().to_string();
    let names = member_names(path)?;
    let mut found = [None; NAMES.len()];
    for (found, known) in found.iter_mut().zip(NAMES) {
        let mut same = names.iter().filter(|name| known.contains(&name.as_str()));
        *found = same.next().map(String::as_str);
        if let Some(second) = same.next() {
            let given = format!("the arrays {} and {second}", found.unwrap_or_default());
            return Err(Error::input(&place, given, "one of them"));
        }
    }
    let [positions, normals, radii, pixels, poses] = found;
    let read = |name: &str, shape: &[Option<usize>]| -> Result<ArrayD<f64>> {
        let array = FileArray::read(path, name)?.into_numbers()?;
        let fits = |(length, wanted): (&usize, &Option<usize>)| wanted.is_none_or(|w| w == *length);
        if array.ndim() == shape.len() && array.shape().iter().zip(shape).all(fits) {
            return Ok(array);
        }
        let words = |length: &Option<usize>| length.map_or("n".to_owned(), |n| n.to_string());
        let allowed: Vec<String> = shape.iter().map(words).collect();
        let given = format!("an array of shape {:?}", array.shape());
        Err(Error::input(
            format!("{place}, {name}"),
            given,
            allowed.join(" × "),
        ))
    };
    let (positions, is_flat, normals) = match (poses, positions) {
        (Some(poses), None) => {
            let (positions, normals) =
                from_poses(&place, &read(poses, &[None, Some(3), Some(4)])?)?
                    .into_iter()
                    .unzip();
            (positions, false, Some(normals))
        }
        (None, Some(positions)) => {
            let is_flat = normals.is_none()
                && FileArray::shape_of(path, positions, TableContent::Any)?.last() == Some(&2);
            let positions = match is_flat {
                true => flat(&read(positions, &[None, Some(2)])?),
                false => vectors(&read(positions, &[None, Some(3)])?),
            };
            let normals = normals.map(|normals| read(normals, &[Some(positions.len()), Some(3)]));
            let normals = normals.transpose()?.map(|normals| vectors(&normals));
            (positions, is_flat, normals)
        }
        _ => {
            let given = match names.is_empty() {
                true => "no arrays".to_owned(),
                false => format!("the arrays {}", names.join(", ")),
            };
            return Err(Error::input(place, given, ALLOWED));
        }
    };
    let n = positions.len();
    let points = Points {
        rows: (1..=n).collect(),
        positions,
        is_flat,
    };
    let given = format!("no array normals (the arrays {})", names.join(", "));
    let without_normals = (&given[..], "positions and normals, or poses, or ");
    let pixels = pixels.map(|name| -> Result<_> {
        let pixels = read(name, &[Some(n), Some(2)])?;
        let whole = |(row, number): (usize, &f64)| {
            let is_whole = *number >= 0.0 && number.fract() == 0.0 && *number < 1e9;
            is_whole.then_some(*number as usize).ok_or_else(|| {
                let place = format!("{place}, {name}, row {}", row / 2 + 1);
                Error::input(place, number, "integers from 0")
            })
        };
        let numbers = pixels.iter().enumerate().map(whole);
        let numbers = numbers.collect::<Result<Vec<usize>>>()?;
        Ok(numbers
            .chunks(2)
            .map(|pixel| [pixel[0], pixel[1]])
            .collect())
    });
    let metres = options.unit.unwrap_or_default().metres();
    let radii = radii.map(|name| {
        let radii = read(name, &[Some(n)])?.into_iter().collect::<Vec<f64>>();
        match radii
            .iter()
            .position(|radius| !(radius.is_finite() && *radius > 0.0))
        {
            Some(row) => {
                let place = format!("{place}, {name}, row {}", row + 1);
                Err(Error::input(place, radii[row], "a positive length"))
            }
            None => Ok(radii.into_iter().map(|radius| metres * radius).collect()),
        }
    });
    let read = LayoutFile {
        radii: radii.transpose()?,
        ..LayoutFile::of_points(&place, points, normals, options, without_normals)?
    };
    Ok(match pixels.transpose()? {
        Some(pixels) => read.with_pixels(pixels),
        None => read,
    })
}

/// Returns the layout as an archive of positions and normals.
pub(super) fn written(file: &LayoutFile) -> Result<Vec<u8>> {
    let rows = |vectors: &[DVec3]| {
        let numbers = vectors.iter().flat_map(|vector| vector.to_array());
        let rows = Array2::from_shape_vec((vectors.len(), 3), numbers.collect());
        rows.expect("three numbers a vector")
    };
    archive(file, "pixels", |npz| {
        npz.add_array("positions", &rows(file.layout.centers()))?;
        npz.add_array("normals", &rows(file.layout.axes()))
    })
}

/// Returns the layout as an archive of poses. The rotation of a taxel is the frame of the layout.
pub(super) fn written_as_poses(file: &LayoutFile) -> Result<Vec<u8>> {
    let (centers, layout) = (file.layout.centers(), &file.layout);
    let pose = |taxel: usize| {
        let [x, y, z] = layout.frame(taxel).transpose().to_cols_array_2d();
        let center = centers[taxel];
        [&x[..], &[center.x], &y, &[center.y], &z, &[center.z]].concat()
    };
    let numbers: Vec<f64> = (0..centers.len()).flat_map(pose).collect();
    let poses = Array3::from_shape_vec((centers.len(), 3, 4), numbers);
    let poses = poses.expect("twelve numbers a pose");
    archive(file, "taxel2pixel", |npz| npz.add_array("poses", &poses))
}

/// Returns an archive of the arrays that `add` adds, and of the radii and pixels of the layout.
fn archive(
    file: &LayoutFile,
    pixels_name: &str,
    add: impl FnOnce(&mut Archive) -> std::result::Result<(), WriteNpzError>,
) -> Result<Vec<u8>> {
    let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
    let write = || -> std::result::Result<Vec<u8>, WriteNpzError> {
        add(&mut npz)?;
        if let Some(radii) = &file.radii {
            npz.add_array("radii", &Array1::from(radii.clone()))?;
        }
        if let Some(pixels) = file.image() {
            let numbers = pixels.iter().flatten().map(|&number| number as i64);
            let pixels = Array2::from_shape_vec((pixels.len(), 2), numbers.collect());
            npz.add_array(pixels_name, &pixels.expect("two numbers a taxel"))?;
        }
        Ok(npz.finish()?.into_inner())
    };
    write().map_err(|error| Error::input("layout archive", error, "arrays that fit into a file"))
}

type Archive = NpzWriter<Cursor<Vec<u8>>>;

fn flat(array: &ArrayD<f64>) -> Vec<DVec3> {
    let rows = array.rows().into_iter();
    rows.map(|row| DVec3::new(row[0], row[1], 0.0)).collect()
}

fn vectors(array: &ArrayD<f64>) -> Vec<DVec3> {
    let numbers: Vec<f64> = array.iter().copied().collect();
    numbers.chunks(3).map(DVec3::from_slice).collect()
}

/// Returns the position and the normal of each taxel, given the poses of the taxels.
fn from_poses(place: &str, poses: &ArrayD<f64>) -> Result<Vec<(DVec3, DVec3)>> {
    let numbers: Vec<f64> = poses.iter().copied().collect();
    let pose = |(row, m): (usize, &[f64])| {
        let rotation =
            DMat3::from_cols_array(&[m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]]);
        if written_rotation_matrix(&rotation).is_none() {
            let given = match rotation.determinant() < 0.0 {
                true => "a left-handed frame",
                false => "a matrix that is no rotation",
            };
            let at = format!("{place}, poses, row {}", row + 1);
            return Err(Error::input(
                at,
                given,
                "three columns of length one, right-handed",
            ));
        }
        Ok((DVec3::new(m[3], m[7], m[11]), rotation.z_axis))
    };
    numbers.chunks(12).enumerate().map(pose).collect()
}
