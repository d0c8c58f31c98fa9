//! Commands within what the ram can do.
//!
//! A command that asks for more than the stroke, speed or acceleration allow is replaced by the
//! nearest one that does not. With the last command `x, v`, the wanted one `x_w, v_w` and the
//! period `T`,
//!
//! ```text
//! e   = x_w - x                              v_1 = e / T                   straight there
//! v_2 = v_w +- sqrt(2 a_max |e|)             no faster than it can brake to the wanted motion
//! |v| <= v_max,   |v| <= sqrt(2 a_max d)     d: distance to the end of the stroke
//! |v - v_last| <= a_max T
//! ```
//!
//! A wanted command that keeps all limits is passed on as it is, bit for bit. The stroke rules over
//! the acceleration: a command that begins too close to the end for its speed is braked as hard as
//! the acceleration allows.

use crate::command::Command;

/// What a ram can do, or what a bench allows it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandLimits {
    /// Largest displacement from mid-stroke, m.
    pub stroke_m: f64,
    /// Highest speed, m/s.
    pub velocity_m_per_s: f64,
    /// Highest acceleration, m/s2.
    pub acceleration_m_per_s2: f64,
}

impl CommandLimits {
    /// No limits.
    pub(crate) const NONE: Self = Self {
        stroke_m: f64::INFINITY,
        velocity_m_per_s: f64::INFINITY,
        acceleration_m_per_s2: f64::INFINITY,
    };
}

impl Default for CommandLimits {
    /// No limit.
    fn default() -> Self {
        Self::NONE
    }
}

/// A limited command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limited {
    /// The command.
    pub command: Command,
    /// Whether it differs from the wanted one.
    pub is_saturated: bool,
    /// What the wanted one asks of the ram.
    pub demand: Demand,
}

/// What a wanted command asks of a ram, in the quantities that have a limit.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Demand {
    /// Displacement from mid-stroke, with the way on which the ram can brake where it moves
    /// outward, m.
    pub stroke_m: f64,
    /// Speed, m/s.
    pub velocity_m_per_s: f64,
    /// Change of the speed in a period, m/s.
    pub speed_change_m_per_s: f64,
}

impl Demand {
    /// Nothing was asked for.
    pub(crate) const NONE: Self =
        Self { stroke_m: 0.0, velocity_m_per_s: 0.0, speed_change_m_per_s: 0.0 };

    /// Of each quantity the larger one.
    #[must_use]
    pub const fn larger(self, other: Self) -> Self {
        Self {
            stroke_m: self.stroke_m.max(other.stroke_m),
            velocity_m_per_s: self.velocity_m_per_s.max(other.velocity_m_per_s),
            speed_change_m_per_s: self.speed_change_m_per_s.max(other.speed_change_m_per_s),
        }
    }
}

impl CommandLimits {
    /// Of each limit the tighter one.
    #[must_use]
    pub const fn tighter(self, other: Self) -> Self {
        Self {
            stroke_m: self.stroke_m.min(other.stroke_m),
            velocity_m_per_s: self.velocity_m_per_s.min(other.velocity_m_per_s),
            acceleration_m_per_s2: self.acceleration_m_per_s2.min(other.acceleration_m_per_s2),
        }
    }

    /// The command next to a wanted one that keeps the limits, a period after the last.
    ///
    /// ```
    /// use firmware_core::command::Command;
    /// use firmware_core::supervision::CommandLimits;
    /// let limits = CommandLimits {
    ///     stroke_m: 50e-3, velocity_m_per_s: 0.3, acceleration_m_per_s2: 20.0,
    /// };
    /// let rest = Command::default();
    /// let wanted = Command { displacement_m: 10e-3, velocity_m_per_s: 0.0 };
    /// let next = limits.limited(rest, wanted, 1e-3);
    /// assert!(next.is_saturated && (next.command.velocity_m_per_s - 0.02).abs() < 1e-12);
    /// ```
    pub fn limited(&self, last: Command, wanted: Command, period_s: f64) -> Limited {
        debug_assert!(period_s > 0.0 && last.is_finite() && wanted.is_finite());
        debug_assert!(self.acceleration_m_per_s2 > 0.0 && self.velocity_m_per_s > 0.0);
        let demand = self.demand(last, wanted, period_s);
        if self.keeps(demand, period_s) {
            return Limited { command: wanted, is_saturated: false, demand };
        }
        let Self { stroke_m, velocity_m_per_s: v_max, acceleration_m_per_s2: a_max } = *self;
        let target_m = clamped(wanted.displacement_m, -stroke_m, stroke_m);
        let error_m = target_m - last.displacement_m;
        let straight = error_m / period_s;
        let target_v =
            if target_m == wanted.displacement_m { wanted.velocity_m_per_s } else { 0.0 };
        let closing = braked(error_m, a_max, period_s);
        let toward = if error_m >= 0.0 {
            straight.min(target_v + closing)
        } else {
            straight.max(target_v - closing)
        };
        let up = braked(stroke_m - last.displacement_m, a_max, period_s).min(v_max);
        let down = braked(stroke_m + last.displacement_m, a_max, period_s).min(v_max);
        let allowed = clamped(toward, -down, up);
        let change = a_max * period_s;
        let v = last.velocity_m_per_s;
        let velocity_m_per_s = clamped(allowed, v - change, v + change);
        let displacement_m = last.displacement_m + velocity_m_per_s * period_s;
        let command = Command { displacement_m, velocity_m_per_s };
        Limited { command, is_saturated: true, demand }
    }

    /// What a command asks of the ram, a period after the last.
    fn demand(&self, last: Command, wanted: Command, period_s: f64) -> Demand {
        let Command { displacement_m: x, velocity_m_per_s: v } = wanted;
        let step = (x - last.displacement_m) / period_s;
        let is_outward = v * x > 0.0;
        let braking_m = if is_outward { 0.5 * v * v / self.acceleration_m_per_s2 } else { 0.0 };
        let (to_wanted, to_step) = (v - last.velocity_m_per_s, step - last.velocity_m_per_s);
        Demand {
            stroke_m: x.abs() + braking_m,
            velocity_m_per_s: v.abs().max(step.abs()),
            speed_change_m_per_s: to_wanted.abs().max(to_step.abs()),
        }
    }

    /// Whether a demand is within all limits.
    fn keeps(&self, demand: Demand, period_s: f64) -> bool {
        demand.stroke_m <= self.stroke_m
            && demand.velocity_m_per_s <= self.velocity_m_per_s
            && demand.speed_change_m_per_s <= self.acceleration_m_per_s2 * period_s
    }
}

/// A value within bounds. The standard `clamp` panics where they are crossed.
fn clamped(value: f64, least: f64, most: f64) -> f64 {
    debug_assert!(least <= most, "{least} to {most}");
    value.max(least).min(most)
}

/// Speed from which a ram comes to rest within a distance, in whole periods.
fn braked(distance_m: f64, a_max: f64, period_s: f64) -> f64 {
    // A period passes before the first brake: v T + v^2 / (2 a) = d.
    let lost = a_max * period_s;
    crate::sqrt::sqrt(lost * lost + 2.0 * a_max * distance_m.abs()) - lost
}

#[cfg(test)]
mod tests {
    use super::super::random::uniform;
    use super::*;

    const LIMITS: CommandLimits =
        CommandLimits { stroke_m: 50e-3, velocity_m_per_s: 0.3, acceleration_m_per_s2: 20.0 };
    const T: f64 = 1e-3;

    /// -1 to 1.
    fn random(state: &mut u64) -> f64 {
        2.0 * uniform(state) - 1.0
    }

    #[test]
    fn no_wish_moves_the_command_beyond_its_limits() {
        let mut state = 19;
        for _ in 0..300 {
            let mut command =
                Command { displacement_m: 49e-3 * random(&mut state), velocity_m_per_s: 0.0 };
            for _ in 0..500 {
                // Steps, jumps over the stroke and far beyond it.
                let wish = if random(&mut state) > 0.9 { 1.0 } else { 60e-3 };
                let wanted = Command {
                    displacement_m: wish * random(&mut state),
                    velocity_m_per_s: random(&mut state),
                };
                let next = LIMITS.limited(command, wanted, T).command;
                let step = next.displacement_m - command.displacement_m;
                let change = next.velocity_m_per_s - command.velocity_m_per_s;
                assert!(step.abs() <= 0.3 * T * (1.0 + 1e-12), "{step}");
                assert!(change.abs() <= 20.0 * T * (1.0 + 1e-12), "{change}");
                assert!(next.displacement_m.abs() <= 50e-3 + 1e-12, "{}", next.displacement_m);
                command = next;
            }
        }
    }

    #[test]
    fn a_ram_that_moves_outward_asks_for_the_way_on_which_it_brakes() {
        let last = Command { displacement_m: 39.8e-3, velocity_m_per_s: 0.2 };
        let out = Command { displacement_m: 40e-3, velocity_m_per_s: 0.2 };
        // 0.2^2 / (2 * 20) m = 1 mm.
        let demand = LIMITS.limited(last, out, T).demand;
        assert!((demand.stroke_m - 41e-3).abs() < 1e-12, "{demand:?}");
        assert!((demand.velocity_m_per_s - 0.2).abs() < 1e-12, "{demand:?}");
        // A command beyond the limits asks for what it asks for, whatever is sent instead.
        let far = Command { displacement_m: 80e-3, velocity_m_per_s: 0.2 };
        let limited = LIMITS.limited(last, far, T);
        assert!(limited.is_saturated && limited.demand.stroke_m > 80e-3, "{limited:?}");
        assert!((limited.demand.speed_change_m_per_s - 40.0).abs() < 1e-9, "{limited:?}");
    }

    #[test]
    fn a_motion_within_the_limits_passes_bit_for_bit() {
        let mut last = Command::default();
        let w = core::f64::consts::TAU * 3.5;
        for n in 0..2000 {
            let t = f64::from(n) * T;
            // Faded in, so that it begins at rest.
            let amplitude = 3.46e-3 * (1.0 - libm::exp(-t * t));
            let grows = 3.46e-3 * 2.0 * t * libm::exp(-t * t);
            let wanted = Command {
                displacement_m: amplitude * libm::sin(w * t),
                velocity_m_per_s: amplitude * w * libm::cos(w * t) + grows * libm::sin(w * t),
            };
            let next = LIMITS.limited(last, wanted, T);
            assert_eq!((next.command, next.is_saturated), (wanted, false), "{n}");
            last = next.command;
        }
    }

    #[test]
    fn a_step_is_reached_without_overshoot() {
        let wanted = Command { displacement_m: 20e-3, velocity_m_per_s: 0.0 };
        let (mut command, mut highest) = (Command::default(), 0.0_f64);
        for _ in 0..400 {
            command = LIMITS.limited(command, wanted, T).command;
            highest = highest.max(command.displacement_m);
        }
        assert!((command.displacement_m - 20e-3).abs() < 1e-9, "{command:?}");
        assert!(highest <= 20e-3 + 1e-9 && command.velocity_m_per_s.abs() < 1e-6, "{highest}");
    }
}
