//! Force elements between points of two bodies.
//!
//! Small angles throughout: a force acts at the undeformed point, so the moment of a preloaded
//! spring that has moved sideways or leans with the cant is left out (for the SS9 it would lower
//! the carbody's roll stiffness by 9 % and shift some 3 % of the wheel load in the 400 m curve).
//! All springs are linear unless they say otherwise, and are counted from the unloaded position.
//! The force on the first body is given; the second gets its opposite.

use super::body::{BodyId, Pose, apply_force, point_motion};
use crate::lanes::Lanes;
use nalgebra::Vector3;

/// Where an element is fixed: a body and a point relative to its centre (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor {
    /// The body.
    pub body: BodyId,
    /// Forward, right, down from the centre of the body (m).
    pub point_m: Vector3<f64>,
}

/// Positions and velocities of all bodies in a common frame, and the forces on them.
pub(super) struct Motion<'a, const L: usize> {
    pub(super) position: &'a [Pose<L>; super::BODIES_MAX],
    pub(super) velocity: &'a [Pose<L>; super::BODIES_MAX],
}

/// Forces on all bodies.
pub(super) type Forces<const L: usize> = [Pose<L>; super::BODIES_MAX];

/// Displacement of the second point from the first.
#[inline(always)]
fn between<const L: usize>(
    poses: &[Pose<L>; super::BODIES_MAX],
    first: &Anchor,
    second: &Anchor,
) -> [Lanes<L>; 3] {
    let [x1, y1, z1] = point_motion(&poses[first.body.index()], &first.point_m);
    let [x2, y2, z2] = point_motion(&poses[second.body.index()], &second.point_m);
    [x2 - x1, y2 - y1, z2 - z1]
}

#[inline(always)]
fn apply_pair<const L: usize>(
    forces: &mut Forces<L>,
    first: &Anchor,
    second: &Anchor,
    force: [Lanes<L>; 3],
) {
    apply_force(&mut forces[first.body.index()], &first.point_m, &force);
    let [x, y, z] = force;
    let opposite = [-x, -y, -z];
    apply_force(&mut forces[second.body.index()], &second.point_m, &opposite);
}

/// Springs and dampers in three directions between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Suspension {
    /// One end.
    pub first: Anchor,
    /// The other end.
    pub second: Anchor,
    /// Forward, right, down (N/m).
    pub stiffness_n_per_m: [f64; 3],
    /// Forward, right, down (N s/m).
    pub damping_n_s_per_m: [f64; 3],
    /// Total free play before a spring touches: forward, right, down (m).
    pub play_m: [f64; 3],
}

impl Suspension {
    #[inline(always)]
    pub(super) fn act<const L: usize>(&self, motion: &Motion<'_, L>, forces: &mut Forces<L>) {
        let [dx, dy, dz] = between(motion.position, &self.first, &self.second);
        let [vx, vy, vz] = between(motion.velocity, &self.first, &self.second);
        let [kx, ky, kz] = self.stiffness_n_per_m;
        let [cx, cy, cz] = self.damping_n_s_per_m;
        let [px, py, pz] = self.play_m;
        let free = |way: Lanes<L>, play| if play == 0.0 { way } else { way.beyond(0.5 * play) };
        let force =
            [free(dx, px) * kx + vx * cx, free(dy, py) * ky + vy * cy, free(dz, pz) * kz + vz * cz];
        apply_pair(forces, &self.first, &self.second, force);
    }
}

/// A rotational spring and damper between two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Torsion {
    /// One body.
    pub first: BodyId,
    /// The other body.
    pub second: BodyId,
    /// Roll, pitch, yaw (N m/rad).
    pub stiffness_n_m_per_rad: [f64; 3],
    /// Roll, pitch, yaw (N m s/rad).
    pub damping_n_m_s_per_rad: [f64; 3],
}

impl Torsion {
    #[inline(always)]
    pub(super) fn act<const L: usize>(&self, motion: &Motion<'_, L>, forces: &mut Forces<L>) {
        let (first, second) = (self.first.index(), self.second.index());
        for (axis, (stiffness, damping)) in
            self.stiffness_n_m_per_rad.into_iter().zip(self.damping_n_m_s_per_rad).enumerate()
        {
            let coordinate = super::ROLL + axis;
            let angle = motion.position[second][coordinate] - motion.position[first][coordinate];
            let rate = motion.velocity[second][coordinate] - motion.velocity[first][coordinate];
            let moment = angle * stiffness + rate * damping;
            forces[first][coordinate] += moment;
            forces[second][coordinate] -= moment;
        }
    }
}

/// Points of a bump-stop characteristic.
pub const BUMP_POINTS_MAX: usize = 12;

/// A lateral stop with a free gap and a progressive characteristic, the same to both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct BumpStop {
    /// One end.
    pub first: Anchor,
    /// The other end.
    pub second: Anchor,
    /// Deflection (m) and force (N), both rising, the first with force zero: the free gap.
    pub characteristic: heapless::Vec<(f64, f64), BUMP_POINTS_MAX>,
}

impl BumpStop {
    #[inline(always)]
    pub(super) fn act<const L: usize>(&self, motion: &Motion<'_, L>, forces: &mut Forces<L>) {
        let [_, dy, _] = between(motion.position, &self.first, &self.second);
        let force = dy.map(|deflection| self.force_n(deflection));
        apply_pair(forces, &self.first, &self.second, [Lanes::ZERO, force, Lanes::ZERO]);
    }

    /// Force at a deflection (N); beyond the last point the last slope goes on.
    pub fn force_n(&self, deflection_m: f64) -> f64 {
        let size = deflection_m.abs();
        let mut force = 0.0;
        for pair in self.characteristic.windows(2) {
            let &[(from_m, from_n), (to_m, to_n)] = pair else { continue };
            if size > from_m {
                force = from_n + (size - from_m) * (to_n - from_n) / (to_m - from_m);
            }
        }
        libm::copysign(force, deflection_m)
    }
}

/// Where a damper slot acts: along a fixed direction between two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DamperMount {
    /// One end.
    pub first: Anchor,
    /// The other end.
    pub second: Anchor,
    /// Unit vector from the first end to the second.
    pub direction: Vector3<f64>,
}

impl DamperMount {
    /// Extension (m) or its rate (m/s), positive when the ends part.
    #[inline(always)]
    pub(super) fn extension<const L: usize>(
        &self,
        poses: &[Pose<L>; super::BODIES_MAX],
    ) -> Lanes<L> {
        let [x, y, z] = between(poses, &self.first, &self.second);
        x * self.direction.x + y * self.direction.y + z * self.direction.z
    }

    /// Applies a damper force, positive in tension: it pulls the ends together.
    #[inline(always)]
    pub(super) fn pull<const L: usize>(&self, tension: Lanes<L>, forces: &mut Forces<L>) {
        let force =
            [tension * self.direction.x, tension * self.direction.y, tension * self.direction.z];
        apply_pair(forces, &self.first, &self.second, force);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vehicle::BODIES_MAX;

    fn anchor(body: usize, x: f64, y: f64, z: f64) -> Anchor {
        Anchor { body: BodyId::new(body).unwrap(), point_m: Vector3::new(x, y, z) }
    }

    #[test]
    fn a_suspension_pulls_its_ends_together_with_the_right_moments() {
        let element = Suspension {
            first: anchor(0, 0.0, 1.0, 0.5),
            second: Anchor { body: BodyId::GROUND, point_m: Vector3::zeros() },
            stiffness_n_per_m: [10.0, 20.0, 30.0],
            damping_n_s_per_m: [0.0; 3],
            play_m: [0.0; 3],
        };
        let mut position = [Pose::<1>::default(); BODIES_MAX];
        position[0][super::super::VERTICAL] = Lanes([0.1]);
        position[0][super::super::LATERAL] = Lanes([0.2]);
        let velocity = [Pose::default(); BODIES_MAX];
        let mut forces = [Pose::default(); BODIES_MAX];
        element.act(&Motion { position: &position, velocity: &velocity }, &mut forces);
        // Fy = -20 * 0.2, Fz = -30 * 0.1, Mx = y Fz - z Fy.
        assert_eq!(forces[0].map(|f| f.0[0]), [-4.0, -3.0, -3.0 + 2.0, 0.0, 0.0]);
    }

    #[test]
    fn play_leaves_a_dead_band() {
        assert_eq!(Lanes([0.004]).beyond(0.005).0, [0.0]);
        assert_eq!(Lanes([-0.006]).beyond(0.005).0, [-0.001]);
    }

    #[test]
    fn a_bump_stop_is_free_then_progressive_and_odd() {
        let stop = BumpStop {
            first: anchor(0, 0.0, 0.0, 0.0),
            second: anchor(1, 0.0, 0.0, 0.0),
            characteristic: heapless::Vec::from_slice(&[(0.02, 0.0), (0.03, 1e3), (0.04, 5e3)])
                .unwrap(),
        };
        assert_eq!(stop.force_n(0.019), 0.0);
        assert!((stop.force_n(0.025) - 500.0).abs() < 1e-9);
        assert!((stop.force_n(-0.035) + 3e3).abs() < 1e-9);
        assert!((stop.force_n(0.05) - 9e3).abs() < 1e-9);
    }
}
