//! Layouts in URDF files. A layout is `<sensor><tactile>` with an `<array>` or `<taxel>`s (urdf_tactile), or three prismatic joints along x, y and z for each
//! taxel (XELA's uSkin). Positions are in the frame of the link that carries the sensor.

use super::LayoutFile;
use crate::error::{Error, Result};
use crate::geometry::Pose;
use crate::world::{Joint, JointKind, Robot};
use glam::DVec3;
use std::collections::BTreeMap;

/// Reads a layout of taxels from the text of a URDF file. The name of a tactile sensor, or of the link that carries the taxels' prismatic joints, is `sensor`.
/// The name may be omitted if there is only one.
pub(super) fn read(place: &str, text: &str, sensor: Option<&str>) -> Result<LayoutFile> {
    let (robot, sensors) = Robot::with_all_sensors(place, text)?;
    let mut all = BTreeMap::new();
    // If two sensors have one name, the fault of the second sensor remains.
    for (name, sensor) in sensors {
        all.insert(
            name,
            sensor.and_then(|sensor| LayoutFile::of_sensor(place, &sensor)),
        );
    }
    let (prismatic, fault) = prismatic_taxels(place, &robot);
    for (link, taxels) in prismatic {
        all.entry(link.clone()).or_insert_with(|| {
            let file = LayoutFile::in_order(place, taxels?)?;
            Ok(LayoutFile {
                link: Some(link),
                ..file
            })
        });
    }
    let names = all.keys().map(String::as_str);
    let names = names.collect::<Vec<_>>().join(", ");
    let name = match (sensor, all.len()) {
        (_, 0) => {
            let allowed = "a <sensor> with <tactile>, or taxels of three prismatic joints";
            let none = || Error::input(place, "no tactile sensor", allowed);
            return Err(fault.unwrap_or_else(none));
        }
        (Some(name), _) => name.to_owned(),
        (None, 1) => names.clone(),
        (None, n) => {
            let given = format!("{n} tactile sensors");
            let allowed = format!("the name of one: {names}");
            return Err(Error::input(place, given, allowed));
        }
    };
    let missing = || {
        Error::input(
            place,
            format!("no sensor `{name}`"),
            format!("one of {names}"),
        )
    };
    all.remove(&name).unwrap_or_else(|| Err(missing()))
}

/// Position (metres) and normal of a taxel in the frame of its link.
type Taxel = (DVec3, DVec3);

/// Returns the taxels of each link in file order. Three prismatic joints along x, y and z connect a taxel to its link. The normal of a taxel is the axis of the
/// third joint. If one chain of prismatic joints on a link is a taxel and another chain is not, the link has an error. Also returns the first fault of a chain of
/// three joints.
fn prismatic_taxels(
    place: &str,
    robot: &Robot,
) -> (BTreeMap<String, Result<Vec<Taxel>>>, Option<Error>) {
    let joints = robot.joints();
    let is_slide = |kind: JointKind| kind == JointKind::Prismatic;
    let below = |link: usize| joints.iter().filter(move |joint| joint.parent == link);
    let mut taxels: BTreeMap<String, Vec<Taxel>> = BTreeMap::new();
    let mut faults: BTreeMap<String, Error> = BTreeMap::new();
    let mut first_fault = None;
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
        let link = robot.links()[first.parent].name.clone();
        match taxel_of_chain(&chain) {
            Ok(taxel) => taxels.entry(link).or_default().push(taxel),
            Err(given) => {
                let place = format!("{place}, joint `{}`", first.name);
                let allowed = "three joints of a taxel, along right-handed axes x, y and z";
                let fault = || Error::input(&place, &given, allowed);
                if chain.len() == 3 {
                    first_fault.get_or_insert_with(fault);
                }
                faults.entry(link).or_insert_with(fault);
            }
        }
    }
    let of_link = |(link, taxels): (String, Vec<Taxel>)| {
        let fault = faults.remove(&link);
        (link, fault.map_or(Ok(taxels), Err))
    };
    (taxels.into_iter().map(of_link).collect(), first_fault)
}

/// Returns the taxel at the end of a chain of prismatic joints, in the frame of the chain's link. If the chain moves no taxel, returns a description of the
/// chain as the error.
fn taxel_of_chain(chain: &[&Joint]) -> std::result::Result<Taxel, String> {
    if chain.len() != 3 {
        return Err(format!("a chain of {} prismatic joints", chain.len()));
    }
    let mut pose = Pose::IDENTITY;
    let mut axes = Vec::new();
    for joint in chain {
        pose = pose.compose(&joint.origin);
        axes.push(pose.rotation * joint.axis);
    }
    let [x, y, z] = [axes[0], axes[1], axes[2]];
    let is_right_angled = [x.dot(y), x.dot(z), y.dot(z)]
        .iter()
        .all(|dot| dot.abs() < 1e-6);
    match (is_right_angled, x.cross(y).dot(z) > 0.0) {
        (true, true) => Ok((pose.translation, z)),
        (true, false) => Err("a left-handed frame".to_owned()),
        (false, _) => Err("axes that are not perpendicular".to_owned()),
    }
}

/// Returns the layout as the text of a URDF file with one tactile sensor. Taxels have their z axes along the normals, and are spheres of their radii.
pub(super) fn written(file: &LayoutFile, name: &str) -> String {
    let name = escape(name);
    let link = file.link.as_deref().map_or(name.clone(), escape);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<robot name=\"{name}\">\n  <link name=\"{link}\"/>\n  <sensor name=\"{name}\">\n    <parent link=\"{link}\"/>\n    \
         <origin xyz=\"0 0 0\" rpy=\"0 0 0\"/>\n    <tactile channel=\"{name}\">\n"
    );
    let default = file.default_radius();
    let taxels = file.layout.centers().iter().zip(file.layout.axes());
    for (taxel, (center, axis)) in taxels.enumerate() {
        let DVec3 { x, y, z } = *center;
        let roll = (-axis.y).atan2(axis.x.hypot(axis.z));
        let pitch = axis.x.atan2(axis.z);
        text +=
            &format!("      <taxel idx=\"{taxel}\" xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} 0\">");
        let radius = file.radii.as_ref().map_or(default, |radii| radii[taxel]);
        text += &format!("<geometry><sphere radius=\"{radius}\"/></geometry></taxel>\n");
    }
    text + "    </tactile>\n  </sensor>\n</robot>\n"
}

/// Escapes the characters of a name that have a meaning in XML.
fn escape(name: &str) -> String {
    let name = name.replace('&', "&amp;").replace('<', "&lt;");
    name.replace('"', "&quot;")
}
