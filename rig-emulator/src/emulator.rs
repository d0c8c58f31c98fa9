//! An emulated rig: delay line, drive with fixture and damper, load cell, displacement sensors.
//!
//! ```text
//! command -> delay line -> drive (ideal, servo, rths-benchmark) -> noise -> reading
//! ```
//!
//! **Delay.** The pure delay is a time: `delay_cycles` counts cycles of 1 ms, and a rig in a faster
//! loop keeps as many more commands. A command is the position of the eyes at the instant at which
//! the cycle begins; the reading is taken at its end. With velocity the reference runs on over the
//! cycle and the ram is behind it by the drive and the whole cycles of pure delay: 0.5 ms on the
//! default rig. Without velocity the reference stands still until the next command, which costs the
//! cycle as well: 1.16 ms on the default rig.
//!
//! Displacement is kept at the ram and across the eyes: their difference is the fixture. Noise is
//! added by the sensors and counted in cycles ([`Noise`]). The load cell has gain and offset, and
//! its channel may be late: between two cycles the force is interpolated, which suits what
//! changes little in a cycle. The sensors have no other dynamics.

use crate::benchmark::{Benchmark, BenchmarkState};
use crate::ideal::Ideal;
use crate::mechanics::Mechanics;
use crate::noise::Noise;
use crate::servo::{Servo, ServoState};
use firmware_core::damper::DamperState;
use nodes::rig::{RamState, Reading, Reference, Target};
use scenario::rig::{DELAY_CYCLES_MAX, DisplacementSensor, Drive, RigSetup, SensorSetup};
use scenario::run::{CYCLE_S, Rate};

/// Speed below which a ram that is held by a controller counts as being at rest (m/s): in a second
/// it moves by no more than the thickness of a hair.
pub const AT_REST_M_PER_S: f64 = 0.1e-3;

/// Cycles per millisecond of the fastest loop.
const MOST_PER_MS: usize = Rate::Fourfold.per_ms() as usize;

/// References that the delay line keeps.
const LINE: usize = DELAY_CYCLES_MAX as usize * MOST_PER_MS + 1;

/// Forces that a late load cell keeps: 14 ms at most.
const FORCES: usize = 16 * MOST_PER_MS;

/// A rig that exists only as numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Emulator {
    plant: Plant,
    stroke_m: f64,
    /// Pure delay (s).
    delay_s: f64,
    force_noise_n: f64,
    displacement_noise_m: f64,
    sensors: SensorSetup,
    noise: Noise,
    period_s: f64,
}

/// What moves the ram, with fixture and damper.
#[derive(Debug, Clone, PartialEq)]
enum Plant {
    Ideal(Ideal),
    Servo(Servo),
    Benchmark(Benchmark),
}

/// Everything an emulated rig remembers.
#[derive(Debug, Clone, PartialEq)]
pub struct EmulatorState {
    cycle: u64,
    mechanics: Mechanics,
    own: PlantState,
    line: [Reference; LINE],
    forces_n: [f64; FORCES],
}

/// What a drive remembers besides the mechanics.
#[derive(Debug, Clone, Copy, PartialEq)]
enum PlantState {
    Ideal,
    Servo(ServoState),
    Benchmark(BenchmarkState),
}

impl Emulator {
    /// A rig for cycles of `period_s`; `stream` keeps the noise of several rigs apart.
    pub fn new(setup: &RigSetup, period_s: f64, stream: u64) -> Self {
        debug_assert!(period_s > 0.0 && period_s.is_finite(), "cycles of {period_s} s");
        Self {
            plant: match &setup.drive {
                Drive::Ideal => Plant::Ideal(Ideal::new(setup, period_s)),
                Drive::Servo(drive) => Plant::Servo(Servo::new(setup, *drive, period_s)),
                Drive::RthsBenchmark => Plant::Benchmark(Benchmark::new(setup, period_s)),
            },
            stroke_m: setup.stroke_m,
            delay_s: f64::from(setup.delay_cycles.min(DELAY_CYCLES_MAX)) * CYCLE_S,
            force_noise_n: setup.force_noise_n,
            displacement_noise_m: setup.displacement_noise_m,
            sensors: setup.sensors,
            noise: Noise::new(setup.seed, stream),
            period_s,
        }
    }

    /// The same rig for cycles of another length.
    #[must_use]
    pub fn with_period(self, period_s: f64) -> Self {
        debug_assert!(period_s > 0.0 && period_s.is_finite(), "cycles of {period_s} s");
        let plant = match self.plant {
            Plant::Ideal(plant) => Plant::Ideal(plant.with_period(period_s)),
            Plant::Servo(plant) => Plant::Servo(plant.with_period(period_s)),
            Plant::Benchmark(plant) => Plant::Benchmark(plant.with_period(period_s)),
        };
        Self { plant, period_s, ..self }
    }

    /// Length of a cycle (s).
    pub fn period_s(&self) -> f64 {
        self.period_s
    }

    /// Largest travel from the middle to either side (m).
    pub fn stroke_m(&self) -> f64 {
        self.stroke_m
    }

    /// The ram in the middle, the damper at rest, the noise at cycle 0.
    pub fn start(&self) -> EmulatorState {
        self.start_at(0.0)
    }

    /// The ram at rest at a displacement, the damper at rest there, the noise at cycle 0.
    pub fn start_at(&self, ram_m: f64) -> EmulatorState {
        let ram_m = ram_m.clamp(-self.stroke_m, self.stroke_m);
        let held = Reference { displacement_m: ram_m, ..Reference::default() };
        EmulatorState {
            cycle: 0,
            mechanics: Mechanics::resting_at(ram_m),
            own: match &self.plant {
                Plant::Ideal(_) => PlantState::Ideal,
                Plant::Servo(plant) => PlantState::Servo(plant.resting_at(ram_m)),
                Plant::Benchmark(plant) => PlantState::Benchmark(plant.resting_at(ram_m)),
            },
            line: [held; LINE],
            forces_n: [0.0; FORCES],
        }
    }

    /// Begins a session with the plant as it stands: the noise counts from here, the delay line
    /// holds where the ram is, and a late load cell shows the force of now.
    pub fn begin(&self, state: &mut EmulatorState) {
        let displacement_m = state.ram().displacement_m;
        let held = Reference { displacement_m, ..Reference::default() };
        (state.cycle, state.line) = (0, [held; LINE]);
        state.forces_n = [state.mechanics.load_cell_n; FORCES];
    }

    /// Whether the ram stands still: exactly where it is ideal, below [`AT_REST_M_PER_S`] and not
    /// asked to go anywhere where a controller holds it.
    pub fn is_at_rest(&self, state: &EmulatorState) -> bool {
        let ram_m_per_s = state.ram().velocity_m_per_s;
        let is_still = |speed_m_per_s: f64| speed_m_per_s.abs() < AT_REST_M_PER_S;
        match &state.own {
            PlantState::Ideal => ram_m_per_s == 0.0,
            PlantState::Servo(own) => {
                is_still(ram_m_per_s) && is_still(own.reference().velocity_m_per_s)
            }
            PlantState::Benchmark(own) => {
                is_still(ram_m_per_s) && is_still(own.reference().velocity_m_per_s)
            }
        }
    }

    /// One cycle.
    pub fn cycle(&self, state: &mut EmulatorState, command: Target) -> Reading {
        let target = match command {
            Target::Follow(reference) => Target::Follow(self.delayed(state, reference)),
            own => {
                let displacement_m = state.ram().displacement_m;
                let held = Reference { displacement_m, ..<_>::default() };
                self.delayed(state, held);
                own
            }
        };
        let EmulatorState { mechanics, own, .. } = state;
        let limits = match (&self.plant, own) {
            (Plant::Ideal(plant), PlantState::Ideal) => plant.cycle(mechanics, target),
            (Plant::Servo(plant), PlantState::Servo(own)) => plant.cycle(mechanics, own, target),
            (Plant::Benchmark(plant), PlantState::Benchmark(own)) => {
                plant.cycle(mechanics, own, target)
            }
            (Plant::Ideal(_) | Plant::Servo(_) | Plant::Benchmark(_), _) => {
                debug_assert!(false, "the state of a rig of another kind");
                <_>::default()
            }
        };
        let Mechanics { ram, eyes_m, load_cell_n, .. } = *mechanics;
        let behind_m = match command {
            Target::Follow(reference) => {
                reference.after(self.period_s).displacement_m - ram.displacement_m
            }
            _ => 0.0,
        };
        let [of_load_cell, of_eyes, of_ram, _] = self.noise.at(state.cycle);
        let SensorSetup { force_gain, force_offset_n, .. } = self.sensors;
        let force_n = force_gain * self.late_n(state, load_cell_n) + force_offset_n;
        state.cycle += 1;
        let eyes_m = eyes_m + self.displacement_noise_m * of_eyes;
        let ram_displacement_m = ram.displacement_m + self.displacement_noise_m * of_ram;
        Reading {
            force_n: force_n + self.force_noise_n * of_load_cell,
            displacement_m: match self.sensors.displacement {
                DisplacementSensor::Eyes => eyes_m,
                DisplacementSensor::Ram => ram_displacement_m,
            },
            ram_displacement_m,
            behind_m,
            limits,
        }
    }

    /// Keeps the force of a cycle, and takes the one that a late load cell shows.
    fn late_n(&self, state: &mut EmulatorState, now_n: f64) -> f64 {
        let late = self.sensors.force_skew_s / self.period_s;
        if late == 0.0 {
            return now_n;
        }
        let length = FORCES as u64;
        if let Some(place) = state.forces_n.get_mut((state.cycle % length) as usize) {
            *place = now_n;
        }
        let whole = (late as u64).min(length - 2);
        let share = (late - whole as f64).min(1.0);
        let before = |cycles: u64| {
            let place = ((state.cycle + length - cycles) % length) as usize;
            state.forces_n.get(place).copied().unwrap_or(now_n)
        };
        (1.0 - share) * before(whole) + share * before(whole + 1)
    }

    /// Puts a reference into the delay line and takes out the one that is due.
    fn delayed(&self, state: &mut EmulatorState, reference: Reference) -> Reference {
        let length = LINE as u64;
        let put = (state.cycle % length) as usize;
        // A rig in a loop that is faster than any of a bench is late by less.
        let cycles = (libm::round(self.delay_s / self.period_s) as u64).min(length - 1);
        let due = ((state.cycle + length - cycles) % length) as usize;
        if let Some(place) = state.line.get_mut(put) {
            *place = reference;
        }
        state.line.get(due).copied().unwrap_or(reference)
    }
}

impl EmulatorState {
    /// Cycles since the start.
    pub fn cycle(&self) -> u64 {
        self.cycle
    }

    /// The ram.
    pub fn ram(&self) -> RamState {
        self.mechanics.ram
    }

    /// Displacement across the eyes, without noise (m).
    pub fn eyes_m(&self) -> f64 {
        self.mechanics.eyes_m
    }

    /// Force of the damper, without noise (N).
    pub fn force_n(&self) -> f64 {
        self.mechanics.force_n
    }

    /// The damper.
    pub fn damper(&self) -> &DamperState {
        &self.mechanics.mounting.damper
    }

    /// Temperature of the damper, degrees Celsius, if the rig has a thermometer.
    pub fn temperature_degc(&self) -> Option<f64> {
        match &self.own {
            PlantState::Servo(own) => Some(own.temperature_degc()),
            PlantState::Ideal | PlantState::Benchmark(_) => None,
        }
    }
}
