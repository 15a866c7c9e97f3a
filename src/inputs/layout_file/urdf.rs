//! Layouts in URDF files, in one of two forms: `<sensor><tactile>` with an `<array>` or `<taxel>`s (urdf_tactile), or three prismatic joints along x, y and z
//! for each taxel (XELA's uSkin). Positions are in the frame of the link that carries the sensor.

use super::LayoutFile;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{JointKind, Robot};
use glam::DVec3;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// Reads a layout of taxels from the text of a URDF file. The name of a tactile sensor, or of the link that carries the taxels' prismatic joints, is `sensor`.
/// The name may be omitted if there is only one.
pub(super) fn read(place: &str, text: &str, sensor: Option<&str>) -> Result<LayoutFile> {
    let robot = Robot::from_urdf(place, text)?;
    let mut all = BTreeMap::new();
    for sensor in robot.tactile_sensors() {
        all.insert(sensor.name.clone(), LayoutFile::of_sensor(place, sensor)?);
    }
    for (link, taxels) in prismatic_taxels(&robot) {
        if let Entry::Vacant(place_of_link) = all.entry(link.clone()) {
            let file = LayoutFile {
                link: Some(link),
                ..LayoutFile::in_order(place, taxels)?
            };
            place_of_link.insert(file);
        }
    }
    let names = all
        .keys()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .join(", ");
    let name = match (sensor, all.len()) {
        (_, 0) => {
            let allowed = "a <sensor> with <tactile>, or taxels of three prismatic joints";
            return Err(Error::input(place, "no tactile sensor", allowed));
        }
        (Some(name), _) => name.to_owned(),
        (None, 1) => names.clone(),
        (None, n) => {
            let given = format!("{n} tactile sensors");
            return Err(Error::input(
                place,
                given,
                format!("the name of one: {names}"),
            ));
        }
    };
    all.remove(&name).ok_or_else(|| {
        let given = format!("no sensor `{name}`");
        Error::input(place, given, format!("one of {names}"))
    })
}

/// Position (metres) and normal of a taxel in the frame of its link.
type Taxel = (DVec3, DVec3);

/// Returns the taxels of each link in file order; a taxel is connected to its link by three prismatic joints along x, y and z. The normal of a taxel is the
/// axis of the third joint.
fn prismatic_taxels(robot: &Robot) -> BTreeMap<String, Vec<Taxel>> {
    let joints = robot.joints();
    let is_slide = |kind: JointKind| kind == JointKind::Prismatic;
    let below = |link: usize| joints.iter().filter(move |joint| joint.parent == link);
    let mut all: BTreeMap<String, Vec<Taxel>> = BTreeMap::new();
    for first in joints.iter().filter(|joint| is_slide(joint.kind)) {
        // The parent link of the first prismatic joint of a chain is not moved by another prismatic joint.
        if joints
            .iter()
            .any(|joint| joint.child == first.parent && is_slide(joint.kind))
        {
            continue;
        }
        let mut chain = vec![first];
        while let Some(next) =
            below(chain[chain.len() - 1].child).find(|joint| is_slide(joint.kind))
        {
            chain.push(next);
        }
        let [x, y, z] = chain[..] else { continue };
        let mut pose = Pose::IDENTITY;
        let mut axes = Vec::new();
        for joint in [x, y, z] {
            pose = pose.compose(&joint.origin);
            axes.push(pose.rotation * joint.axis);
        }
        let is_right_angled = axes[0].dot(axes[1]).abs() < 1e-6
            && axes[0].dot(axes[2]).abs() < 1e-6
            && axes[1].dot(axes[2]).abs() < 1e-6;
        if is_right_angled {
            let link = robot.links()[x.parent].name.clone();
            all.entry(link)
                .or_default()
                .push((pose.translation, axes[2]));
        }
    }
    all
}
