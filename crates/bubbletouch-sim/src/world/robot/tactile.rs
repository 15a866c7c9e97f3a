//! Tactile sensors of a URDF file (`<sensor>` with `<tactile>`). The sensors are not read; each one is reported in a note.

use super::xml::Element;
use roxmltree::Node;

/// Adds a note for each tactile sensor of the robot.
pub(super) fn note_tactile_sensors(robot: Element) {
    let all = robot.node.descendants();
    for node in all.filter(|node| node.tag_name().name() == "tactile") {
        let above = |tag: &str| {
            let mut ancestors = node.ancestors();
            ancestors.find(|node| node.tag_name().name() == tag)
        };
        let sensor = above("sensor");
        let named = sensor.and_then(|sensor| sensor.attribute("name"));
        let parent = sensor.and_then(parent_link);
        let link = above("link").and_then(|link| link.attribute("name"));
        let gazebo = above("gazebo").and_then(|element| element.attribute("reference"));
        let on = parent.or(link).or(gazebo);
        let element = Element { node, ..robot };
        robot.lines.note(
            element
                .refuse(
                    format!(
                        "tactile sensor `{}` on link `{}`, which is not read",
                        named.unwrap_or("without a name"),
                        on.unwrap_or("without a name"),
                    ),
                    "[[patches]] of a scene with this robot and link",
                )
                .to_string(),
        );
    }
}

/// Returns the name of the link in `<parent link="…"/>` of a sensor.
fn parent_link<'a>(sensor: Node<'a, 'a>) -> Option<&'a str> {
    let mut children = sensor.children();
    let parent = children.find(|node| node.tag_name().name() == "parent")?;
    parent.attribute("link")
}
