//! Three-axis contact forces: shear springs and Coulomb friction at the taxels.
//!
//! In addition to the spring (k, δ) along its axis n, a taxel has a shear spring with stiffness k_t and displacement u perpendicular to the axis. While the
//! taxel is in contact, the object drags the end of the shear spring. During a step the object moves from the pose X₀ to X₁ (patch frame). Let a and b be
//! the material points of the object that touch the taxel at the start and at the end of the step:
//!
//! ```text
//! Δ = P ½ [(X₁ a − X₀ a) + (X₁ b − X₀ b)],   P = 1 − n nᵀ         tangential motion; the spring carries the motion along n
//! f_t = k_t u on the tip,  |f_t| ≤ μ f_n                            stick inside the cone, slip on it
//! ```
//!
//! The module `coulomb` solves the step of u in closed form: the predictor u + Δ is returned to the friction cone at the step's end.
//! If the object rolls, X₁ a − X₀ a and X₁ b − X₀ b cancel to second order, so rolling drags nothing.
//!
//! For a free object the motion is unknown before its equilibrium, which depends on the shear springs. The step of a free object therefore omits b and returns
//! u + Δ radially to the cone (module `shear_springs`). On a straight path both rules give equal u.
//!
//! **Normal direction**: the sensor's axis, f_n = f = k δ (+ c δ̇ with a damper), not the contact normal n_c. Friction perpendicular to the axis
//! has no component along it, so δ and f keep their frictionless closed form and no wedge can jam a taxel. The cone then refers
//! to the force that the sensor measures. The taxel slides on rigid guides. The lateral frictionless force of an inclined
//! contact, `f (n_c + n cos) / cos`, is carried by these guides and does not load the shear spring. On a
//! flank at an angle θ, Coulomb's cone about n_c differs by the order of μ tan θ; head-on both cones are equal. The shift of the contact point by
//! u is neglected; it is of the order of μ f / k_t.
//!
//! The force on the object is therefore the frictionless one, −∇ Σ ½ k δ², minus Σ f_t at the contact points. For μ = 0 every u is exactly zero, and the total
//! load is bitwise equal to `spring_load`.
//!
//! **Laws**: the friction cone holds after any step, and no step size is unstable. The work of f_t on the object is at most the energy released by the shear
//! springs, at any step size, so friction only dissipates. While f is constant, one step along a straight path equals many steps. If f changes, the error of a
//! step is of first order. Taxels that come into contact within a step also have a first-order error, because their u is zero at the step's end. If a taxel
//! leaves contact or touches another object, u is reset to zero. For a saturated taxel the normal force is the spring's k s. The additional force of the stop
//! is unknown, so the friction is a lower bound; a press counts such taxels.

use super::coulomb::{Dragged, drag};
use super::tangential_spring::{TangentialSpring, TangentialSpringState};
use crate::contact::{DamperState, TaxelContact, Wrench};
use crate::error::Result;
use crate::geometry::Pose;
use crate::world::{Patch, Shears};
use glam::{DMat3, DVec2, DVec3, Vec3Swizzles};

/// State of the tangential contact of a taxel: free, stick or slip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactMode {
    /// No contact: no object presses the taxel.
    #[default]
    Free,
    /// The contact sticks: the end of the shear spring moves with the object.
    Stick,
    /// The contact slipped during the last step because the tangential force reached the friction cone.
    Slip,
}

/// Selection of the normal force that limits the friction.
#[derive(Clone, Copy, Debug)]
pub enum NormalForce<'a> {
    /// Spring forces only: stiffness times deflection.
    Springs,
    /// Forces of springs and dampers; the damper state must have been advanced to the contacts of this step.
    Dampers(&'a DamperState),
}

impl NormalForce<'_> {
    fn at_contact(&self, contact: &TaxelContact, stiffness: f64) -> f64 {
        match self {
            Self::Springs => stiffness * contact.deflection,
            Self::Dampers(state) => state.force[contact.taxel],
        }
    }
}

/// Numbers of sticking and slipping taxels after a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ContactModeCounts {
    /// Number of taxels in contact that did not slip.
    pub n_sticking: usize,
    /// Number of taxels that slipped during the step.
    pub n_slipping: usize,
}

/// Sum of the forces that the taxels of a patch exert on objects.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionLoad {
    /// Force and torque of the taxels' springs and of the friction together.
    pub on_object: Wrench,
    /// Force and torque of the friction alone.
    pub friction: Wrench,
}

/// Shear springs of one patch with friction, carried from one time step to the next.
///
/// A shear spring depends on the path of its contact. The state therefore contains the contacts of the last step, with their material points on the objects,
/// which no other state of deflections needs.
///
/// ```
/// use bubbletouch_sim::contact::{FrictionState, NormalForce, Press, Until, Workspace};
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
///     Press::new(&palm, &objects, &[pose], Until::Pose).with_contacts().run(&mut workspace)?;
///     friction.step(&palm, workspace.contacts(), &[pose], NormalForce::Springs);
/// }
///
/// // The ball slides: the friction is μ times the normal force, and less for taxels that have just come into contact.
/// let load = friction.load(&palm, workspace.contacts());
/// let held_back = -load.friction.force.x / load.on_object.force.z;
/// assert!(held_back > 0.48 && held_back <= 0.5);
/// # Ok::<(), bubbletouch_sim::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct FrictionState {
    shears: Shears,
    /// Readings of three-axis sensors on the taxels, newtons, shape (n_taxels,).
    forces: Vec<DVec3>,
    /// Contact mode of each taxel, shape (n_taxels,).
    contact_modes: Vec<ContactMode>,
    /// Present contacts of all taxels, ascending by taxel.
    held: Vec<TaxelContactState>,
    /// Contacts at the previous time step, ascending by taxel; used only during a step.
    before: Vec<TaxelContactState>,
    /// Poses of the objects in the patch frame (`patch_from_object`) after the last step.
    poses: Vec<Pose>,
}

/// Tangential contact between a taxel and an object.
#[derive(Clone, Copy, Debug)]
struct TaxelContactState {
    taxel: usize,
    object: usize,
    /// Material point of the object that the taxel touches, metres, in the object's frame.
    point: DVec3,
    /// Position of the material point, and position of the point where the friction acts; metres, in the patch frame.
    place: DVec3,
    acts_at: DVec3,
    /// Tangential displacement of the shear spring, metres, along x and y of the taxel's frame.
    displacement: DVec2,
}

impl FrictionState {
    /// Creates the state of an untouched patch: no taxel is in contact.
    ///
    /// # Errors
    /// If the shear springs do not fit the patch.
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

    /// Returns the properties of the shear springs.
    pub fn shears(&self) -> &Shears {
        &self.shears
    }

    /// Returns the readings of three-axis sensors (`force3`), N, shape (n_taxels,): the force of the object on each taxel. The components x and y lie along the
    /// axes of the taxel's frame; they are friction plus the lateral force of an inclined contact. The component z is the force against the taxel's axis, never
    /// negative. The reading is zero if nothing presses the taxel.
    pub fn force3(&self) -> &[DVec3] {
        &self.forces
    }

    /// Writes the lateral readings in single precision. The slice `out` has two values per taxel: x of all taxels, followed by y of all taxels.
    pub fn write_lateral(&self, out: &mut [f32]) {
        let (x, y) = out.split_at_mut(self.forces.len());
        for ((force, x), y) in self.forces.iter().zip(x).zip(y) {
            (*x, *y) = (force.x as f32, force.y as f32);
        }
    }

    /// Returns the contact mode of each taxel in the last step, shape (n_taxels,).
    pub fn contact_modes(&self) -> &[ContactMode] {
        &self.contact_modes
    }

    /// Returns the friction force on one taxel along x and y of the taxel's frame, N. The force is the tangential stiffness times the displacement, and its
    /// length is at most the friction coefficient times the normal force.
    pub fn friction(&self, taxel: usize) -> DVec2 {
        self.shears.at(taxel).stiffness * self.displacement(taxel)
    }

    /// Returns the shear displacement of one taxel along x and y of the taxel's frame, metres; zero if the taxel is not in contact.
    pub fn displacement(&self, taxel: usize) -> DVec2 {
        self.held(taxel)
            .map_or(DVec2::ZERO, |held| held.displacement)
    }

    fn held(&self, taxel: usize) -> Option<&TaxelContactState> {
        let found = self.held.binary_search_by_key(&taxel, |held| held.taxel);
        found.ok().map(|index| &self.held[index])
    }

    /// Returns the tangential springs of the taxels in contact, ascending by taxel. The springs act on free objects in the next step.
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

    /// Replaces the contacts of one object by the given contacts (ascending by taxel) at the given pose; the displacements of their shear springs are zero.
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
                let held = TaxelContactState {
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

    /// Advances the shear springs by one time step, from the poses of the previous step to `patch_from_objects`. `contacts` are the contacts of a press at
    /// the step's end, ascending by taxel. At the first step, and at any first contact, the shear displacement is zero.
    ///
    /// # Panics
    /// If the taxel or object of a contact does not exist.
    pub fn step(
        &mut self,
        patch: &Patch,
        contacts: &[TaxelContact],
        patch_from_objects: &[Pose],
        normal: NormalForce,
    ) -> ContactModeCounts {
        self.step_with(patch, contacts, patch_from_objects, normal, &[])
    }

    /// Advances the shear springs by one time step with free objects in equilibrium. `held_at_rest` (ascending by taxel) contains the springs' states in the
    /// equilibrium that was solved with the springs of the previous step.
    ///
    /// # Panics
    /// If the taxel or object of a contact does not exist.
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
            let force = normal.at_contact(contact, patch.taxels().at(taxel).stiffness);
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
            self.held.push(TaxelContactState {
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

    /// Returns the sum of the forces that taxels exert on objects after a time step. The sum is over the given contacts: all contacts, or the contacts of one
    /// object.
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

/// Returns the components of a vector (patch frame) along the axes x and y of a taxel's frame, which are perpendicular to the taxel's axis.
fn across(frame: &DMat3, vector: DVec3) -> DVec2 {
    (frame.transpose() * vector).xy()
}
