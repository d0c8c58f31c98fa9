//! A compensator as a linear filter at 1 kHz: the command of a rig from the wanted motion.
//!
//! ```text
//! a0 u[k] = b0 x[k] + b1 x[k-1] + ... - a1 u[k-1] - a2 u[k-2] - ...
//! ```
//! The filter acts on the wanted displacement. A rig takes the velocity of its command too; a
//! linear filter commutes with the derivative, so the velocity of the command is the same filter on
//! the wanted velocity, which the vehicle knows exactly. Before the first cycle all is zero: a ram
//! begins in the middle of its stroke. Transposed direct form II.
//!
//! Limits: what adapts is no linear filter.

use firmware_core::command::Command;

/// Most coefficients of either list.
pub const COEFFICIENTS_MAX: usize = 512;
/// Samples after which a filter that is stable has forgotten its start, at most.
const SETTLING: usize = 60_000;
/// Share of its largest answer to an impulse that a filter keeps that does not fade.
const FADED: f64 = 1e-3;

/// A linear filter of the wanted motion.
#[derive(Debug, Clone, PartialEq)]
pub struct DiscreteFilter {
    /// Weights of wanted displacements, the present one first, over `a0`.
    b: Vec<f64>,
    /// Weights of past commands, that of the last cycle first, over `a0`.
    a: Vec<f64>,
}

/// What a filter remembers: of displacement and of velocity.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct FilterState(Vec<[f64; 2]>);

impl DiscreteFilter {
    /// A filter from its coefficients `b0, b1, ...` and `a0, a1, ...`; none where they are no
    /// filter: no number, too many of them, `a0` zero, or an answer to an impulse that does not
    /// fade.
    ///
    /// ```
    /// use vehicle_studies::trip::DiscreteFilter;
    /// // Extrapolates linearly over 5 cycles.
    /// assert!(DiscreteFilter::new(&[6.0, -5.0], &[1.0]).is_some());
    /// // Grows by a tenth in each cycle.
    /// assert_eq!(DiscreteFilter::new(&[1.0], &[1.0, -1.1]), None);
    /// ```
    pub fn new(b: &[f64], a: &[f64]) -> Option<Self> {
        let (a0, past) = a.split_first()?;
        let scaled = |values: &[f64]| values.iter().map(|value| value / a0).collect::<Vec<f64>>();
        let filter = Self { b: scaled(b), a: scaled(past) };
        let all_finite = filter.b.iter().chain(&filter.a).all(|value| value.is_finite());
        let fits = !b.is_empty() && b.len().max(a.len()) <= COEFFICIENTS_MAX && all_finite;
        (fits && filter.fades()).then_some(filter)
    }

    /// Whether its answer to an impulse fades.
    fn fades(&self) -> bool {
        if self.a.is_empty() {
            return true;
        }
        let mut state = self.start();
        let mut impulse = |k: usize| {
            let displacement_m = if k == 0 { 1.0 } else { 0.0 };
            let command = Command { displacement_m, velocity_m_per_s: 0.0 };
            self.step(&mut state, command).displacement_m.abs()
        };
        let half = SETTLING / 2;
        let most = |from: usize, of: &mut dyn FnMut(usize) -> f64| {
            // A maximum would lose what is no number.
            (from..from + half).map(of).fold(0.0, |most: f64, y| if y <= most { most } else { y })
        };
        let early = most(0, &mut impulse);
        let late = most(half, &mut impulse);
        early.is_finite() && late.is_finite() && late <= FADED * early
    }

    /// Nothing remembered.
    pub(super) fn start(&self) -> FilterState {
        FilterState(vec![[0.0; 2]; self.b.len().max(self.a.len() + 1)])
    }

    /// The command of a cycle.
    pub(super) fn step(&self, state: &mut FilterState, wanted: Command) -> Command {
        let memory = &mut state.0;
        debug_assert!(memory.len() > self.a.len(), "the state of another filter");
        let inputs = [wanted.displacement_m, wanted.velocity_m_per_s];
        let b0 = self.b.first().copied().unwrap_or(0.0);
        let first = memory.first().copied().unwrap_or_default();
        let outputs = [b0 * inputs[0] + first[0], b0 * inputs[1] + first[1]];
        for place in 1..memory.len() {
            let b = self.b.get(place).copied().unwrap_or(0.0);
            let a = self.a.get(place - 1).copied().unwrap_or(0.0);
            let next = memory.get(place).copied().unwrap_or_default();
            memory[place - 1] = std::array::from_fn(|n| b * inputs[n] - a * outputs[n] + next[n]);
        }
        if let Some(last) = memory.last_mut() {
            *last = [0.0; 2];
        }
        let [displacement_m, velocity_m_per_s] = outputs;
        Command { displacement_m, velocity_m_per_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn answers(filter: &DiscreteFilter, inputs: &[f64]) -> Vec<f64> {
        let mut state = filter.start();
        let of = |x: &f64| Command { displacement_m: *x, velocity_m_per_s: 2.0 * x };
        let commands = inputs.iter().map(|x| filter.step(&mut state, of(x)));
        let commands: Vec<Command> = commands.collect();
        for command in &commands {
            assert_eq!(command.velocity_m_per_s, 2.0 * command.displacement_m);
        }
        commands.iter().map(|command| command.displacement_m).collect()
    }

    #[test]
    fn the_equation_is_that_of_the_page() {
        let filter = DiscreteFilter::new(&[1.0, 2.0, 4.0], &[2.0, -1.0]).unwrap();
        let (x, mut expected) = ([1.0, 0.0, 3.0, -1.0, 0.5], Vec::new());
        for k in 0..x.len() {
            let at = |values: &[f64], back: usize| {
                k.checked_sub(back).and_then(|n| values.get(n)).copied().unwrap_or(0.0)
            };
            let sum = at(&x, 0) + 2.0 * at(&x, 1) + 4.0 * at(&x, 2) + at(&expected, 1);
            expected.push(sum / 2.0);
        }
        assert_eq!(answers(&filter, &x), expected);
    }

    #[test]
    fn what_does_not_fade_or_is_no_number_is_no_filter() {
        assert!(DiscreteFilter::new(&[1.0], &[1.0, -0.999]).is_some());
        for (b, a) in [
            (&[][..], &[1.0][..]),
            (&[1.0], &[]),
            (&[1.0], &[0.0]),
            (&[f64::NAN], &[1.0]),
            (&[1.0], &[1.0, -1.0]),
            (&[1.0], &[1.0, 0.0, 1.0]),
            (&[1.0], &[1.0, f64::INFINITY]),
            (&[1.0; COEFFICIENTS_MAX + 1], &[1.0]),
        ] {
            assert_eq!(DiscreteFilter::new(b, a), None, "{b:?} {a:?}");
        }
    }
}
