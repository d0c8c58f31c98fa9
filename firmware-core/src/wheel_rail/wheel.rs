//! The force between one wheel and its rail.
//!
//! Wheel-local axes: x forward, outward from the track centre, down; the left wheel is the mirror
//! image of the right one. With shift `u` of the wheel outward against the rail, drop `w` of the
//! wheel against the rail at the tape circle, and roll `phi` (outward side down), the table is read
//! at `u - phi R` (R: depth of the rail's centre of curvature; turning an arc moves its centre),
//! the touching height falls by `phi` times the distance of that centre, and the contact angle by
//! `phi`: exact to first order for arcs. Then, per zone,
//! ```text
//! delta = (w - touch) cos g        N = k delta^1.5
//! xi  = (V + W r - (psi' + V/R_c) y) / V
//! eta = ((y' - phi' r) cos g - (z' + phi' y) sin g + W psi r / cos g) / V
//! spin = (W sin g + (psi' + V/R_c) cos g) / V
//! ```
//! with the spin `W = -V/r0 + theta'` of the wheelset and rail velocities subtracted. Track
//! irregularity moves the rail, not its material, so it enters the geometry and no velocity. Two
//! zones may be in contact at once, each with its own approach; none means lift-off. Left out: the
//! change of geometry with yaw (second order), contact damping, wheel and rail bending.

use super::creep::{CreepForce, CreepLaw, Creepage, Patch};
use super::hertz::Material;
use super::table::{ContactTable, ZoneTable};
use crate::number::Number;

/// What a wheel runs on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Surface {
    /// Real profiles, from the vehicle's contact table.
    Profiles,
    /// The cone of classical bogie models: constant wheel load, linear flange.
    Conical(Conical),
}

/// A conical wheel under constant load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conical {
    /// Change of rolling radius per lateral shift.
    pub conicity: f64,
    /// Wheel load (N).
    pub load_n: f64,
    /// Shift at which the flange spring begins (m).
    pub flange_gap_m: f64,
    /// Flange spring (N/m).
    pub flange_n_per_m: f64,
}

/// Motion of a wheel against its rail, in wheel-local axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelMotion<N = f64> {
    /// Shift of the wheel's tape circle outward against the rail (m).
    pub shift_m: N,
    /// Drop of the wheel's tape circle against the rail (m).
    pub drop_m: N,
    /// Roll of the wheelset, outward side down (rad).
    pub roll_rad: N,
    /// Yaw of the wheelset, forward towards outward (rad).
    pub yaw_rad: N,
    /// Velocity of the wheelset's centre less that of the rail, outward (m/s).
    pub lateral_m_per_s: N,
    /// Velocity of the wheelset's centre less that of the rail, down (m/s).
    pub vertical_m_per_s: N,
    /// Roll rate (rad/s).
    pub roll_rad_per_s: N,
    /// Spin about the axle, `-V/r0` plus the pitch rate (rad/s).
    pub spin_rad_per_s: N,
    /// Yaw rate, with that of the track frame (rad/s).
    pub yaw_rad_per_s: N,
    /// Running speed (m/s).
    pub speed_m_per_s: N,
}

/// Force and moment on the wheelset from one wheel, in wheel-local axes about the axle's centre.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelForce<N = f64> {
    /// Forward (N).
    pub longitudinal_n: N,
    /// Outward (N); on the rail it is the opposite.
    pub lateral_n: N,
    /// Down (N); on the rail it is the opposite.
    pub vertical_n: N,
    /// Outward side down (N m).
    pub roll_n_m: N,
    /// About the axle (N m).
    pub pitch_n_m: N,
    /// Forward towards outward (N m).
    pub yaw_n_m: N,
    /// Normal force of the tread (N).
    pub tread_n: N,
    /// Normal force of the flange (N).
    pub flange_n: N,
    /// Power lost in both patches (W).
    pub wear_w: N,
    /// Rolling of the tread; zero where it does not touch.
    pub tread: Rolling<N>,
    /// Rolling of the flange; zero where it does not touch.
    pub flange: Rolling<N>,
}

/// What creeps in one patch and what holds against it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rolling<N = f64> {
    /// Velocity of the wheel against the rail over the running speed.
    pub creepage: Creepage<N>,
    /// Tangential force on the wheel and moment about the normal.
    pub force: CreepForce<N>,
}

impl<N: Number> WheelForce<N> {
    /// Writes one place out of four, number by number: a value of its own would be copied.
    #[inline(always)]
    pub fn write_place(&self, place: usize, into: &mut WheelForce) {
        into.longitudinal_n = self.longitudinal_n.get(place);
        into.lateral_n = self.lateral_n.get(place);
        into.vertical_n = self.vertical_n.get(place);
        into.roll_n_m = self.roll_n_m.get(place);
        into.pitch_n_m = self.pitch_n_m.get(place);
        into.yaw_n_m = self.yaw_n_m.get(place);
        into.tread_n = self.tread_n.get(place);
        into.flange_n = self.flange_n.get(place);
        into.wear_w = self.wear_w.get(place);
        self.tread.write_place(place, &mut into.tread);
        self.flange.write_place(place, &mut into.flange);
    }
}

impl<N: Number> Rolling<N> {
    #[inline(always)]
    fn write_place(&self, place: usize, into: &mut Rolling) {
        into.creepage.longitudinal = self.creepage.longitudinal.get(place);
        into.creepage.lateral = self.creepage.lateral.get(place);
        into.creepage.spin_per_m = self.creepage.spin_per_m.get(place);
        into.force.longitudinal_n = self.force.longitudinal_n.get(place);
        into.force.lateral_n = self.force.lateral_n.get(place);
        into.force.spin_moment_n_m = self.force.spin_moment_n_m.get(place);
    }
}

/// What does not change while running: the geometry of a wheel and its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wheel {
    /// Distance of the tape circle from the track centre (m).
    pub tape_m: f64,
    /// Nominal rolling radius (m).
    pub radius_m: f64,
    /// Coefficient of friction.
    pub friction: f64,
    /// Steel of wheel and rail.
    pub material: Material,
    /// What it runs on.
    pub surface: Surface,
    /// The creep law.
    pub creep: CreepLaw,
}

impl Wheel {
    /// The force on the wheelset, of one wheel or of four equal ones. A wheel on profiles needs a
    /// table: without one a debug build stops, and in a release build the wheel carries nothing.
    #[inline(always)]
    pub fn force<N: Number>(
        &self,
        table: Option<&ContactTable>,
        motion: &WheelMotion<N>,
    ) -> WheelForce<N> {
        let mut force = WheelForce::default();
        match (self.surface, table) {
            (Surface::Profiles, Some(table)) => {
                (force.tread_n, force.tread) = self.zone(&table.tread, motion, &mut force);
                (force.flange_n, force.flange) = self.zone(&table.flange, motion, &mut force);
            }
            (Surface::Conical(cone), _) => self.cone(cone, motion, &mut force),
            (Surface::Profiles, None) => {
                debug_assert!(false, "a wheel on profiles needs a contact table");
            }
        }
        force
    }

    /// Adds one zone and gives its normal force and its rolling.
    #[inline(always)]
    fn zone<N: Number>(
        &self,
        zone: &ZoneTable,
        motion: &WheelMotion<N>,
        sum: &mut WheelForce<N>,
    ) -> (N, Rolling<N>) {
        let Some(touch) = self.touch(zone, motion) else { return Default::default() };
        let rolling = self.add_patch(&touch, motion, sum);
        (touch.patch.normal_n, rolling)
    }

    /// Where and how hard a zone touches the rail; none where it is lifted off.
    #[inline(always)]
    pub fn touch<N: Number>(&self, zone: &ZoneTable, motion: &WheelMotion<N>) -> Option<Touch<N>> {
        // Where the rolled wheel meets the rail.
        let shift = motion.shift_m - motion.roll_rad * zone.rail_radius_m(motion.shift_m);
        let place = zone.between(shift);
        // Cheap refusal: a millimetre covers what roll can add.
        let is_refused = place.touch_m().is_above(motion.drop_m + N::splat(1e-3));
        if N::all(is_refused) {
            return None;
        }
        let shape = place.shape();
        let touch_m = shape.touch_m - motion.roll_rad * shape.rail_centre_m;
        let slope = shape.slope - motion.roll_rad;
        let one = N::splat(1.0);
        let cosine = one / (one + slope * slope).sqrt();
        let sine = slope * cosine;
        let approach_m = (motion.drop_m - touch_m) * cosine;
        let is_lifted = N::or(is_refused, approach_m.is_at_most(N::splat(0.0)));
        if N::all(is_lifted) {
            return None;
        }
        // Without approach no force: what is lifted off adds nothing below.
        let approach_m = N::choose(is_lifted, N::splat(0.0), approach_m);
        let root = approach_m.sqrt();
        let patch = Patch {
            normal_n: shape.hertz_n_per_m15 * approach_m * root,
            along_m: shape.along_per_sqrt_m * root,
            across_m: shape.across_per_sqrt_m * root,
            c11: shape.c11,
            c22: shape.c22,
            c23: shape.c23,
            shear_modulus_pa: N::splat(self.material.shear_modulus_pa),
            friction: N::splat(self.friction),
        };
        let arm_m = N::splat(self.tape_m) + shape.lateral_m;
        let radius_m = N::splat(self.radius_m) + shape.radius_deviation_m;
        Some(Touch { patch, sine, cosine, arm_m, radius_m, is_lifted })
    }

    #[inline(always)]
    fn cone<N: Number>(&self, cone: Conical, motion: &WheelMotion<N>, sum: &mut WheelForce<N>) {
        let of = N::splat;
        let patch = Patch {
            normal_n: of(cone.load_n),
            along_m: of(0.0),
            across_m: of(0.0),
            c11: of(0.0),
            c22: of(0.0),
            c23: of(0.0),
            shear_modulus_pa: of(self.material.shear_modulus_pa),
            friction: of(self.friction),
        };
        let touch = Touch {
            patch,
            sine: of(0.0),
            cosine: of(1.0),
            arm_m: of(self.tape_m),
            radius_m: of(self.radius_m) + of(cone.conicity) * motion.shift_m,
            is_lifted: of(0.0).is_above(of(0.0)),
        };
        sum.tread = self.add_patch(&touch, motion, sum);
        sum.tread_n = of(cone.load_n);
        let beyond_m = (motion.shift_m - of(cone.flange_gap_m)).at_least(0.0);
        sum.flange_n = of(cone.flange_n_per_m) * beyond_m;
        sum.lateral_n -= sum.flange_n;
    }

    /// The tangential force of a patch, and all of it as force and moment.
    #[inline(always)]
    fn add_patch<N: Number>(
        &self,
        touch: &Touch<N>,
        motion: &WheelMotion<N>,
        sum: &mut WheelForce<N>,
    ) -> Rolling<N> {
        let Touch { patch, sine, cosine, arm_m, radius_m, is_lifted } = *touch;
        let tangent = sine / cosine;
        let creepage = touch.creepage(motion);
        let creep: CreepForce<N> = self.creep.force(&patch, creepage);
        let outward = creep.lateral_n * cosine - patch.normal_n * sine;
        let down = -creep.lateral_n * sine - patch.normal_n * cosine;
        // The contact leads or trails the axle in a yawed wheelset.
        let lead_m = motion.yaw_rad * (radius_m * tangent - arm_m);
        sum.longitudinal_n += creep.longitudinal_n;
        sum.lateral_n += outward;
        sum.vertical_n += down;
        sum.roll_n_m += arm_m * down - radius_m * outward;
        sum.pitch_n_m += radius_m * creep.longitudinal_n + creep.spin_moment_n_m * sine;
        sum.yaw_n_m +=
            lead_m * outward - arm_m * creep.longitudinal_n + creep.spin_moment_n_m * cosine;
        sum.wear_w -= motion.speed_m_per_s
            * (creep.longitudinal_n * creepage.longitudinal
                + creep.lateral_n * creepage.lateral
                + creep.spin_moment_n_m * creepage.spin_per_m);
        let touching = |value: N| N::choose(is_lifted, N::splat(0.0), value);
        Rolling {
            creepage: Creepage {
                longitudinal: touching(creepage.longitudinal),
                lateral: touching(creepage.lateral),
                spin_per_m: touching(creepage.spin_per_m),
            },
            force: CreepForce {
                longitudinal_n: touching(creep.longitudinal_n),
                lateral_n: touching(creep.lateral_n),
                spin_moment_n_m: touching(creep.spin_moment_n_m),
            },
        }
    }
}

/// One zone on its rail: the patch, and where on the wheelset it lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch<N: Number = f64> {
    /// The patch with its normal force.
    pub patch: Patch<N>,
    /// Sine of the contact angle against the track; positive pushes the wheel inward.
    pub sine: N,
    /// Its cosine.
    pub cosine: N,
    /// Outward distance from the middle of the wheelset (m).
    pub arm_m: N,
    /// Rolling radius (m).
    pub radius_m: N,
    /// Where the wheel is off the rail after all; of a single wheel always false.
    pub is_lifted: N::Truth,
}

impl<N: Number> Touch<N> {
    /// Creepages of the patch.
    #[inline(always)]
    pub fn creepage(&self, motion: &WheelMotion<N>) -> Creepage<N> {
        let Self { sine, cosine, arm_m, radius_m, .. } = *self;
        let spin = motion.spin_rad_per_s;
        let per_speed = N::splat(1.0) / motion.speed_m_per_s;
        Creepage {
            longitudinal: (motion.speed_m_per_s + spin * radius_m - motion.yaw_rad_per_s * arm_m)
                * per_speed,
            lateral: ((motion.lateral_m_per_s - motion.roll_rad_per_s * radius_m) * cosine
                - (motion.vertical_m_per_s + motion.roll_rad_per_s * arm_m) * sine
                + spin * motion.yaw_rad * radius_m / cosine)
                * per_speed,
            spin_per_m: (spin * sine + motion.yaw_rad_per_s * cosine) * per_speed,
        }
    }
}
