//! The indentation kernel of a skin patch of any layout: each taxel along its own axis, only those that a sphere reaches.

use super::grid_lines::GridLines;
use super::instructions::{Instructions, for_instructions};
use super::near_spheres::{PlacedUnion, needed_along, needed_of_leaf};
use super::placed_sphere::View;
use super::skin_mesh::MeshAt;
use super::taxel_contact::TaxelContact;
use crate::geometry::Pose;
use crate::mesh::Triangle;
use crate::objects::{MeshModel, Model, Sphere, SphereUnion};
use crate::world::{EvenGrid, LEAF, PlacedTaxel, SkinPatch};
use glam::DVec3;

/// What a press did, beside its deflections and contacts in the [`SkinWorkspace`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SkinContact {
    /// Taxels with a deflection above zero.
    pub n_touched: usize,
    /// Taxels at their stroke that an object would push further.
    pub n_saturated: usize,
    /// Taxels whose contact is grazing: see [`GRAZING`](super::GRAZING).
    pub n_grazing: usize,
}

/// Scratch of one thread; it is reused, so a press allocates nothing once the largest patch has been seen.
#[derive(Clone, Debug, Default)]
pub struct SkinWorkspace {
    /// n_taxels, metres.
    deflections: Vec<f64>,
    /// n_taxels: object and part; of untouched taxels whatever was there.
    deciding: Vec<[u32; 2]>,
    /// The touched taxels, ascending at the end of a press.
    touched: Vec<u32>,
    /// Spheres of an object that are near.
    near: Vec<u32>,
    /// Of the last even grid.
    lines: GridLines,
    /// Of the touched taxels, in the same order.
    contacts: Vec<TaxelContact>,
    /// What goes on pushing its taxel, behind the substrate too; see [`hold`](Self::hold).
    held: Vec<TaxelContact>,
    /// Of the objects on the way to a force.
    pub(super) poses: Vec<Pose>,
}

impl SkinWorkspace {
    /// An empty workspace.
    pub fn new() -> Self {
        Self::default()
    }

    /// Deflections of the last press: n_taxels, metres, in the order of the layout.
    pub fn deflections(&self) -> &[f64] {
        &self.deflections
    }

    /// The touched taxels of the last press, ascending.
    pub fn contacts(&self) -> &[TaxelContact] {
        &self.contacts
    }

    /// From now on each of these parts pushes its taxel behind the substrate too, until other parts are held: on its way through the
    /// front of a patch an object goes on pressing what it has pressed.
    pub(crate) fn hold<'a>(&mut self, contacts: impl IntoIterator<Item = &'a TaxelContact>) {
        self.held.clear();
        self.held.extend(contacts);
    }

    /// Holds what pushes the taxels of the last press.
    pub(super) fn hold_touched(&mut self) {
        self.held.clone_from(&self.contacts);
    }

    /// Whether any part is held.
    pub(crate) fn holds_any(&self) -> bool {
        !self.held.is_empty()
    }

    /// Makes room for a patch; only what the last press touched is wiped.
    fn clear(&mut self, n_taxels: usize) {
        for &taxel in &self.touched {
            self.deflections[taxel as usize] = 0.0;
        }
        self.touched.clear();
        self.touched.reserve(n_taxels);
        self.contacts.clear();
        self.contacts.reserve(n_taxels);
        self.deflections.resize(n_taxels, 0.0);
        self.deciding.resize(n_taxels, [0; 2]);
    }

    /// Pushes a taxel as far as a part of an object needs; of parts that need the same the first counts.
    #[inline(always)]
    fn push(&mut self, taxel: u32, needed: f64, deciding: [u32; 2]) {
        let number = taxel as usize;
        let deflection = &mut self.deflections[number];
        if needed > *deflection {
            if *deflection == 0.0 {
                self.touched.push(taxel);
            }
            *deflection = needed;
            self.deciding[number] = deciding;
        }
    }
}

/// Presses a patch on objects, right where they are: poses are `patch_from_object`, one an object.
///
/// Each sphere counts as the contact stage's title page says, for each taxel by itself. A mesh counts with all triangles but
/// those that touch the taxel only behind its substrate (lower than −s − ρ along its axis), unless the substrate is inside
/// of the mesh there: so what a forearm rests on does not press on its other side. What has gone far past the stroke lies there, too,
/// unless it is known how it came ([`press_skin_to_force`](super::press_skin_to_force)). A single part decides each touched
/// taxel; where two need the same, the object that comes first, and of a union the first of its spheres.
///
/// ```
/// use bubbletouch::contact::{SkinWorkspace, press_skin, spring_load};
/// use bubbletouch::geometry::Pose;
/// use bubbletouch::objects::{Sphere, SphereUnion};
/// use bubbletouch::world::{Layout, SkinPatch, Taxel, Taxels};
/// use glam::DVec3;
///
/// // A fingertip: half a ball of 8 mm with a taxel every 1.5 mm.
/// let layout = Layout::sphere_cap(8e-3, std::f64::consts::FRAC_PI_2, 1.5e-3)?;
/// let taxel = Taxel { radius: 0.5e-3, stiffness: 100.0, damping: 0.0, stroke: 2e-3 };
/// let fingertip = SkinPatch::new("fingertip", layout, Taxels::Equal(taxel))?;
///
/// // A marble comes half a millimetre too near, from the side.
/// let marble = Sphere { center: DVec3::ZERO, radius: 8e-3 };
/// let objects = [SphereUnion::new(vec![marble])?.into()];
/// let pose = Pose::from_translation(16e-3 * DVec3::new(0.6, 0.0, 0.8));
/// let mut workspace = SkinWorkspace::new();
/// let counts = press_skin(&fingertip, &objects, &[pose], &mut workspace);
/// assert!(counts.n_touched > 3 && counts.n_saturated == 0);
///
/// // The marble is pushed back the way it came.
/// let load = spring_load(&fingertip, workspace.contacts());
/// let force = load.on_object.force;
/// assert!(force.normalize().dot(DVec3::new(0.6, 0.0, 0.8)) > 0.95);
/// # Ok::<(), bubbletouch::Error>(())
/// ```
///
/// # Panics
/// If there are not as many poses as objects.
pub fn press_skin(
    patch: &SkinPatch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut SkinWorkspace,
) -> SkinContact {
    push(patch, objects, patch_from_objects, workspace);
    finish(patch, objects, patch_from_objects, workspace)
}

/// The deflections of [`press_skin`] alone, for steps of which nobody wants to know what touches what: the workspace then has no
/// contacts.
///
/// # Panics
/// If there are not as many poses as objects.
pub fn deflect_skin(
    patch: &SkinPatch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut SkinWorkspace,
) {
    push(patch, objects, patch_from_objects, workspace);
    for &taxel in &workspace.touched {
        let deflection = &mut workspace.deflections[taxel as usize];
        *deflection = deflection.min(patch.taxels().at(taxel as usize).stroke);
    }
}

/// Pushes each taxel as far as an object needs, without a stop.
fn push(
    patch: &SkinPatch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut SkinWorkspace,
) {
    assert_eq!(
        objects.len(),
        patch_from_objects.len(),
        "one pose an object"
    );
    workspace.clear(patch.n_taxels());
    for (number, (object, pose)) in objects.iter().zip(patch_from_objects).enumerate() {
        match object {
            Model::Spheres(union) => {
                let placed = PlacedUnion::new(union, pose);
                let mut near = std::mem::take(&mut workspace.near);
                let is_near = |ball: &Sphere| patch.tree().is_near(ball.center, ball.radius);
                placed.gather(is_near, &mut near);
                match patch.even_grid() {
                    Some(grid) => {
                        push_along_rows(grid, (number, union, &near), pose, workspace);
                    }
                    None => push_by_spheres(
                        Instructions::Best,
                        patch,
                        (number, &placed, &near),
                        workspace,
                    ),
                }
                workspace.near = near;
            }
            Model::Mesh(mesh) => push_by_mesh(patch, number, mesh, pose, workspace),
        }
    }
    push_held(patch, objects, patch_from_objects, workspace);
}

/// Pushes the taxels by the parts that are held, wherever they are along their axes.
fn push_held(
    patch: &SkinPatch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut SkinWorkspace,
) {
    let held = std::mem::take(&mut workspace.held);
    for contact in &held {
        let taxel = PlacedTaxel::of(patch.layout(), patch.taxels(), contact.taxel);
        let pose = &patch_from_objects[contact.object];
        let needed = match &objects[contact.object] {
            Model::Spheres(union) => {
                let Sphere { center, radius } = union.spheres()[contact.part];
                let from = taxel.center - pose.transform_point(center);
                let [across_x, across_y] = taxel.across;
                needed_along(
                    from,
                    [across_x, across_y, taxel.axis],
                    taxel.radius + radius,
                )[0]
            }
            Model::Mesh(mesh) => {
                let stop = MeshAt::new(mesh, pose).stop_by(&taxel, contact.part);
                stop.map_or(0.0, |stop| -stop.height)
            }
        };
        let deciding = [contact.object, contact.part].map(|number| number as u32);
        workspace.push(taxel.number, needed, deciding);
    }
    workspace.held = held;
}

/// The same as [`push_by_spheres`] to the bit, for taxels in rows: no search, and no look at spheres that are above all of them.
fn push_along_rows(
    grid: &EvenGrid,
    (object, union, near): (usize, &SphereUnion, &[u32]),
    pose: &Pose,
    workspace: &mut SkinWorkspace,
) {
    let SkinWorkspace {
        deflections,
        deciding,
        touched,
        lines,
        ..
    } = workspace;
    lines.lay(&grid.grid);
    let view = View::new(grid.radius, lines, pose);
    let mut is_near = false;
    for &number in near {
        let Some(placed) = view.place(&union.spheres()[number as usize], 0.0) else {
            continue;
        };
        if placed.center.z < grid.behind {
            continue;
        }
        is_near = true;
        let mark = [object as u32, number];
        placed.raise_and_mark(lines, deflections, mark, deciding);
    }
    if !is_near {
        return;
    }
    touched.clear();
    let numbers = deflections.iter().enumerate();
    touched.extend(numbers.filter_map(|(number, &d)| (d > 0.0).then_some(number as u32)));
}

for_instructions! {
    /// Pushes the taxels by the near spheres of an object.
    fn push_by_spheres(
        patch: &SkinPatch,
        placed: (usize, &PlacedUnion, &[u32]),
        workspace: &mut SkinWorkspace,
    ) = push_by_each
}

#[inline(always)]
fn push_by_each(
    patch: &SkinPatch,
    (object, placed, near): (usize, &PlacedUnion, &[u32]),
    workspace: &mut SkinWorkspace,
) {
    for &number in near {
        let sphere = placed.at(number);
        let deciding = [object as u32, number];
        patch.tree().each_leaf(
            |node| node.is_near(sphere.center, sphere.radius),
            |leaf| {
                let [needed, heights] = needed_of_leaf(leaf, &sphere);
                let pushes = |k: usize| (needed[k] > 0.0) & (heights[k] >= leaf.behind[k]);
                if (0..LEAF).fold(false, |any, k| any | pushes(k)) {
                    for k in (0..LEAF).filter(|&k| pushes(k)) {
                        workspace.push(leaf.numbers[k], needed[k], deciding);
                    }
                }
            },
        );
    }
}

fn push_by_mesh(
    patch: &SkinPatch,
    object: usize,
    mesh: &MeshModel,
    pose: &Pose,
    workspace: &mut SkinWorkspace,
) {
    let mesh = MeshAt::new(mesh, pose);
    let (center, radius) = mesh.ball();
    patch.tree().each_near(center, radius, |taxel| {
        if let Some(stop) = mesh.stop(taxel) {
            let deciding = [object as u32, stop.triangle as u32];
            workspace.push(taxel.number, -stop.height, deciding);
        }
    });
}

/// Stops the touched taxels at their strokes, and says what each of them touches.
fn finish(
    patch: &SkinPatch,
    objects: &[Model],
    patch_from_objects: &[Pose],
    workspace: &mut SkinWorkspace,
) -> SkinContact {
    workspace.touched.sort_unstable();
    let mut counts = SkinContact::default();
    for &number in &workspace.touched {
        let taxel = number as usize;
        let [object, part] = workspace.deciding[taxel].map(|number| number as usize);
        let (center, axis) = (
            patch.layout().centers()[taxel],
            patch.layout().axes()[taxel],
        );
        let properties = patch.taxels().at(taxel);
        let needed = workspace.deflections[taxel];
        let pushed = center - needed * axis;
        let pose = &patch_from_objects[object];
        let (point, normal) = nearest_point(&objects[object], part, pose, pushed);
        let normal = normal.normalize_or(-axis);
        let contact = TaxelContact {
            taxel,
            object,
            part,
            deflection: needed.min(properties.stroke),
            needed,
            normal,
            cosine: (-normal.dot(axis)).max(0.0),
            point,
        };
        workspace.deflections[taxel] = contact.deflection;
        counts.n_touched += 1;
        counts.n_saturated += usize::from(contact.is_saturated(properties));
        counts.n_grazing += usize::from(contact.is_grazing());
        workspace.contacts.push(contact);
    }
    counts
}

/// The point of an object's part that is nearest to a place, and the direction from there to the place; in the patch frame.
fn nearest_point(object: &Model, part: usize, pose: &Pose, place: DVec3) -> (DVec3, DVec3) {
    match object {
        Model::Spheres(union) => {
            let Sphere { center, radius } = union.spheres()[part];
            let center = pose.transform_point(center);
            let away = place - center;
            (center + radius * away.normalize_or_zero(), away)
        }
        Model::Mesh(mesh) => {
            let corners = mesh.mesh().triangle(part).0;
            let triangle = Triangle(corners.map(|corner| pose.transform_point(corner)));
            let (point, _) = triangle.closest(place);
            (point, place - point)
        }
    }
}
