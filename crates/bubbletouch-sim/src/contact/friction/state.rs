//! Forces in three dimensions: shear springs and Coulomb friction at the tips of the taxels.
//!
//! Beside its spring (k, δ) along the axis n a taxel has a shear spring at its tip: stiffness k_t, displacement u across the
//! axis. While the taxel is in contact, the object drags the tip along. Over a step it moves from the pose X₀ to X₁ (in the
//! patch frame), the material point a that touched the taxel at the start, and the one that touches it at the end, b, with it:
//!
//! ```text
//! Δ = P ½ [(X₁ a − X₀ a) + (X₁ b − X₀ b)],   P = 1 − n nᵀ         what shears; what is along n is the spring's
//! f_t = k_t u on the tip,  |f_t| ≤ μ f_n                            stick inside of the cone, slip on it
//! ```
//!
//! `coulomb` has the step of u in closed form: the predictor u + Δ, returned to the cone of the normal force at the step's end.
//! Rolling has X₁ a − X₀ a and X₁ b − X₀ b that cancel to second order, and drags nothing.
//!
//! What drags a free object's contacts is not known before its equilibrium, which these tips hold: there b is left out, and u + Δ returned to the
//! cone radially (`equilibrium::shear_springs`); on a straight way that is the same.
//!
//! **What is normal**: the sensor's axis, f_n = f = k δ (+ c δ̇ with a damper), not the contact normal n_c. A friction across
//! the axis has no part along it, so δ and f stay as they are without friction, in closed form; no wedge can jam a taxel; and
//! the cone is one that the sensor's own readings show. The taxel slides on rigid guides, so what the inclined contact pushes
//! it aside without friction, `f (n_c + n cos) / cos`, is carried by these and does not load the shear spring. At a
//! flank at an angle θ Coulomb's cone about n_c differs by the order of μ tan θ; head-on both are the same. What u moves of the place that is
//! touched is left out, as small as μ f / k_t.
//!
//! So the force on the object is the frictionless one, −∇ Σ ½ k δ², minus Σ f_t at the contact points. For μ = 0 every u is
//! exactly zero, and the [load](FrictionState::load) is that of [`spring_load`](crate::contact::spring_load) to the bit.
//!
//! **Laws**: the cone holds after any step; no step size is unstable. The work of f_t on the object is at most what the shear
//! springs gave back, at any step size, so friction only dissipates. One step along a straight way is the same as many while f
//! stays; where f changes, and for taxels that come into contact within a step (they begin with u = 0 at its end), the
//! steps' error is of first order. A taxel out of contact, or in contact with another object, forgets u. A saturated taxel
//! carries k s as far as its spring says; what its stop carries beyond is not known, so its friction is the least that it can be; press
//! counts such taxels.

use super::coulomb::{Dragged, drag};
use super::tangential_spring::{TangentialSpring, TangentialSpringState};
use crate::contact::{DamperState, TaxelContact, Wrench};
use crate::error::Result;
use crate::geometry::Pose;
use crate::world::{Patch, Shears};
use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

/// Mode of the tangential contact of a taxel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactMode {
    /// No contact: no object presses the taxel.
    #[default]
    Free,
    /// The tip of the taxel moves with the object.
    Stick,
    /// The contact slipped during the last step because the tangential force reached the friction cone.
    Slip,
}

/// Normal force that limits friction.
#[derive(Clone, Copy, Debug)]
pub enum NormalForce<'a> {
    /// Springs alone: k δ.
    Springs,
    /// Springs and dampers, after their step to the same contact.
    Dampers(&'a DamperState),
}

impl NormalForce<'_> {
    fn of(&self, contact: &TaxelContact, stiffness: f64) -> f64 {
        match self {
            Self::Springs => stiffness * contact.deflection,
            Self::Dampers(state) => state.force[contact.taxel],
        }
    }
}

/// How many taxels did what in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactModeCounts {
    /// Pressed, and not slipped.
    pub n_sticking: usize,
    /// Slipped.
    pub n_slipping: usize,
}

/// What the taxels of some contacts do to the objects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionLoad {
    /// Springs and friction.
    pub on_object: Wrench,
    /// The part of it that is friction.
    pub friction: Wrench,
}

/// The shear springs of one patch between steps.
///
/// ```
/// use bubbletouch_sim::contact::{FrictionState, NormalForce, Workspace, press_with_contacts};
/// use bubbletouch_sim::geometry::Pose;
/// use bubbletouch_sim::objects::{Sphere, SphereUnion};
/// use bubbletouch_sim::world::{Layout, Shear, Shears, Patch, Taxel, Taxels};
/// use glam::DVec3;
///
/// let taxel = Taxel { radius: 1e-3, stiffness: 100.0, damping: 0.0, stroke: 5e-3 };
/// let palm = Patch::new("palm", Layout::disc(0.02, 2e-3)?, Taxels::Equal(taxel))?;
/// let shear = Shear { stiffness: 400.0, friction: 0.5 };
/// let mut friction = FrictionState::at_rest(&palm, Shears::Equal(shear))?;
///
/// // A ball is pressed 2 mm into the palm and then drawn 1 mm along x.
/// let ball = Sphere { center: DVec3::ZERO, radius: 0.03 };
/// let objects = [SphereUnion::new(vec![ball])?.into()];
/// let mut workspace = Workspace::new();
/// for step in 0..=10 {
///     let pose = Pose::from_translation(DVec3::new(1e-4 * f64::from(step), 0.0, 0.029));
///     press_with_contacts(&palm, &objects, &[pose], &mut workspace);
///     friction.step(&palm, workspace.contacts(), &[pose], NormalForce::Springs);
/// }
///
/// // It slides: the palm holds it back with μ times what presses it in, less where taxels came only just into contact.
/// let load = friction.load(&palm, workspace.contacts());
/// let held_back = -load.friction.force.x / load.on_object.force.z;
/// assert!(held_back > 0.48 && held_back <= 0.5);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FrictionState {
    shears: Shears,
    /// n_taxels.
    forces: Vec<DVec3>,
    /// n_taxels.
    contact_modes: Vec<ContactMode>,
    /// Taxels in contact, ascending.
    held: Vec<Held>,
    /// Those of the step before, while one is made.
    before: Vec<Held>,
    /// `patch_from_object` after the last step.
    poses: Vec<Pose>,
}

/// A tip on an object.
#[derive(Clone, Copy, Debug)]
struct Held {
    taxel: usize,
    object: usize,
    /// The material point that it touches, metres, in the object's frame.
    point: DVec3,
    /// Where that is, and where the friction acts, metres, in the patch frame.
    place: DVec3,
    acts_at: DVec3,
    /// u, metres, along x and y of the taxel's frame.
    displacement: DVec2,
}

impl FrictionState {
    /// An untouched patch.
    ///
    /// # Errors
    /// Those of [`Shears::check_on`].
    pub fn at_rest(patch: &Patch, shears: Shears) -> Result<Self> {
        shears.check_on(patch)?;
        Ok(Self {
            shears,
            forces: vec![DVec3::ZERO; patch.n_taxels()],
            contact_modes: vec![ContactMode::Free; patch.n_taxels()],
            held: Vec::new(),
            before: Vec::new(),
            poses: Vec::new(),
        })
    }

    /// The shear springs.
    pub fn shears(&self) -> &Shears {
        &self.shears
    }

    /// `force3`: n_taxels readings of a sensor with three axes, N. Each is the object's force on the tip: x and y along those of
    /// the taxel's [frame](crate::world::Layout::frame), friction and what an inclined contact pushes aside; z is what presses the
    /// taxel in (against its axis), never negative. Zero for a taxel that nothing presses.
    pub fn force3(&self) -> &[DVec3] {
        &self.forces
    }

    /// Contact modes of the last step, shape (n_taxels,).
    pub fn contact_modes(&self) -> &[ContactMode] {
        &self.contact_modes
    }

    /// The friction on one taxel's tip along x and y of its [frame](crate::world::Layout::frame), N: k_t u, at most μ f.
    pub fn friction(&self, taxel: usize) -> DVec2 {
        self.shears.at(taxel).stiffness * self.displacement(taxel)
    }

    /// u of one taxel along x and y of its [frame](crate::world::Layout::frame), metres; zero out of contact.
    pub fn displacement(&self, taxel: usize) -> DVec2 {
        self.held(taxel)
            .map_or(DVec2::ZERO, |held| held.displacement)
    }

    fn held(&self, taxel: usize) -> Option<&Held> {
        let found = self.held.binary_search_by_key(&taxel, |held| held.taxel);
        found.ok().map(|index| &self.held[index])
    }

    /// Tangential springs of the taxels in contact, ascending by taxel; they hold free objects in the next step.
    pub fn tangential_springs(&self) -> impl Iterator<Item = TangentialSpring> {
        self.held.iter().map(|held| TangentialSpring {
            taxel: held.taxel,
            object: held.object,
            point: held.point,
            place: held.place,
            displacement: held.displacement,
            shear: *self.shears.at(held.taxel),
            force: self.forces[held.taxel].z,
        })
    }

    /// From now on an object is held by these contacts (ascending) alone, at this pose, as if it had just been put there.
    pub fn put(
        &mut self,
        patch: &Patch,
        contacts: &[TaxelContact],
        (object, patch_from_object): (usize, &Pose),
    ) {
        self.held.retain(|held| held.object != object);
        let to_object = patch_from_object.inverse();
        for contact in contacts.iter().filter(|contact| contact.object == object) {
            let taxel = contact.taxel;
            if let Err(at) = self.held.binary_search_by_key(&taxel, |held| held.taxel) {
                let force = patch.taxels().at(taxel).stiffness * contact.deflection;
                self.forces[taxel] = DVec3::new(0.0, 0.0, force);
                let held = Held {
                    taxel,
                    object,
                    point: to_object.transform_point(contact.point),
                    place: contact.point,
                    acts_at: contact.point,
                    displacement: DVec2::ZERO,
                };
                self.held.insert(at, held);
            }
        }
    }

    /// A step to the end of which the patch was pressed with these contacts (ascending, as a press gives them) by objects at
    /// these poses; from where they were after the step before. The first step, as any first contact, shears nothing.
    ///
    /// # Panics
    /// If a contact has a taxel or an object that there is not.
    pub fn step(
        &mut self,
        patch: &Patch,
        contacts: &[TaxelContact],
        patch_from_objects: &[Pose],
        normal: NormalForce,
    ) -> ContactModeCounts {
        self.step_with(patch, contacts, patch_from_objects, normal, &[])
    }

    /// The same where tips hold free objects as their [equilibrium](crate::contact::equilibrium) says (ascending by taxel): what it put to rest with the
    /// [tangential springs](Self::tangential_springs) of the step before.
    ///
    /// # Panics
    /// If a contact has a taxel or an object that there is not.
    pub fn step_with(
        &mut self,
        patch: &Patch,
        contacts: &[TaxelContact],
        patch_from_objects: &[Pose],
        normal: NormalForce,
        held_at_rest: &[TangentialSpringState],
    ) -> ContactModeCounts {
        std::mem::swap(&mut self.held, &mut self.before);
        self.held.clear();
        for held in &self.before {
            self.forces[held.taxel] = DVec3::ZERO;
            self.contact_modes[held.taxel] = ContactMode::Free;
        }
        let mut counts = ContactModeCounts::default();
        let mut before = self.before.iter().peekable();
        for contact in contacts {
            let taxel = contact.taxel;
            while before.next_if(|held| held.taxel < taxel).is_some() {}
            let held = before.next_if(|held| held.taxel == taxel);
            let force = normal.of(contact, patch.taxels().at(taxel).stiffness);
            if force <= 0.0 {
                continue;
            }
            let held = held.filter(|held| held.object == contact.object);
            let frame = patch.layout().frame(taxel);
            let end = &patch_from_objects[contact.object];
            let point = end.inverse().transform_point(contact.point);
            let at_rest = held_at_rest.binary_search_by_key(&taxel, |tip| tip.taxel);
            let at_rest = at_rest.ok().map(|at| &held_at_rest[at]);
            let at_rest = at_rest.filter(|tip| tip.object == contact.object);
            let dragged = match (at_rest, held, self.poses.get(contact.object)) {
                (Some(tip), ..) => Dragged {
                    displacement: tip.displacement,
                    has_slipped: tip.has_slipped,
                },
                (None, Some(held), Some(start)) => {
                    let moved = |p| end.transform_point(p) - start.transform_point(p);
                    let motion = 0.5 * (moved(held.point) + moved(point));
                    let limit = self.shears.at(taxel).reach(force);
                    drag(held.displacement, across(&frame, motion), limit)
                }
                _ => Dragged::default(),
            };
            self.held.push(Held {
                taxel,
                object: contact.object,
                point,
                place: contact.point,
                acts_at: at_rest.map_or(contact.point, |tip| tip.place),
                displacement: dragged.displacement,
            });
            let friction = self.shears.at(taxel).stiffness * dragged.displacement;
            let aside = across(&frame, force * contact.gradient());
            self.forces[taxel] = (aside + friction).extend(force);
            self.contact_modes[taxel] = dragged.contact_mode();
            counts.n_slipping += usize::from(dragged.has_slipped);
            counts.n_sticking += usize::from(!dragged.has_slipped);
        }
        self.poses.clear();
        self.poses.extend_from_slice(patch_from_objects);
        counts
    }

    /// Adds up what the taxels do to the objects after a step: those of all its contacts, or of those with one object.
    pub fn load<'a>(
        &self,
        patch: &Patch,
        contacts: impl IntoIterator<Item = &'a TaxelContact>,
    ) -> FrictionLoad {
        let (mut springs, mut friction) = (Wrench::default(), Wrench::default());
        for contact in contacts {
            let taxel = contact.taxel;
            springs = springs + contact.push(self.forces[taxel].z);
            if let Some(held) = self.held(taxel) {
                let force = self.shears.at(taxel).stiffness * held.displacement;
                let force = patch.layout().frame(taxel) * force.extend(0.0);
                friction = friction + Wrench::at(held.acts_at, -force);
            }
        }
        FrictionLoad {
            on_object: springs + friction,
            friction,
        }
    }
}

impl Dragged {
    fn contact_mode(&self) -> ContactMode {
        match self.has_slipped {
            true => ContactMode::Slip,
            false => ContactMode::Stick,
        }
    }
}

/// The part of a vector in the patch frame that is across a taxel's axis, along x and y of the taxel's frame.
fn across(frame: &DMat3, vector: DVec3) -> DVec2 {
    (frame.transpose() * vector).xy()
}
