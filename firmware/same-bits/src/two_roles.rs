//! The locomotive and the rig as nodes of one bus: the whole exchange, the fades and a run.
//!
//! The host makes the run with both nodes on a loopback. A board makes it with a timer, on a
//! loopback or on a line to another board. In lock-step neither the bus nor the clock changes a
//! bit.
//!
//! The track is run there and back and there again, so that a short one lasts. The host has it in
//! memory, a board reads it from a track server on the same bus.

use crate::random::Random;
use can_protocol::arming::{Patience, Requirements};
use can_protocol::{Node, Pace, Profile};
use core::num::NonZeroU8;
use firmware_core::line::{Line, LineState};
use firmware_core::supervision::Checks;
use nodes::locomotive::{End, Locomotive, SILENCE_TICKS, Terms};
use nodes::loopback::Loopback;
use nodes::rig::{ModelRig, ModelSetup, Numbers, Plant, RigNode, ServoBench, ServoRig, ServoSetup};
use nodes::timed::{TimedLocomotive, TimedRig};

/// Cycles of RUN: in every test run, and in the long one.
pub const CYCLES: [u32; 2] = [1_000, 100_000];

/// The damper slot on the rig.
pub const SLOT: usize = 0;

/// The rig.
pub const NODE: Node = Node::ALL[0];

/// Ticks of a run besides its cycles: greeting, exchange, quiet bus, farewell.
const OTHER_TICKS: u32 = 5_000;

/// The number that the reader of a track draws. On a real bus nobody may foresee it.
pub const TRACK_SESSION: u16 = 0x5EED;

/// Reads 25.6 m of track.
pub type BoardReader = nodes::track::Reader<256>;

/// A rig of these runs.
pub type Rig<'a> = RigNode<ModelRig<'a>, Random>;

/// The same behind a servo controller and converters.
pub type BehindServo<'a> = RigNode<ServoRig<ServoBench<'a>>, Random>;

impl Numbers for Random {
    /// Anyone can foresee these: a real bus needs the random numbers of the part.
    fn seeded(seed: u64, stream: u64) -> Self {
        Self::new(seed ^ (stream << 32))
    }

    fn number(&mut self) -> u32 {
        self.half()
    }
}

/// The rig around its damper.
pub fn rig<'a>(setup: &ModelSetup<'a>) -> Rig<'a> {
    RigNode::new(setup, NODE, Profile::Classical)
}

/// The rig around its damper, with a set-point and two sensors between them.
pub fn behind_servo<'a>(setup: &ModelSetup<'a>, cycle_s: f64) -> BehindServo<'a> {
    let ModelSetup { damper, stroke_m, rate_m_per_s, lag_s, seed } = *setup;
    let servo = ServoBench::new(damper, [stroke_m, rate_m_per_s, lag_s], 0.0, cycle_s);
    let setup = ServoSetup { servo, stroke_m, rate_m_per_s, seed };
    RigNode::new(&setup, NODE, Profile::Classical)
}

/// What the locomotive is given. The usual patience is meant for two boards in real time; emulated
/// ones on a busy machine need more.
pub fn terms(cycle_s: f64, cycles: u32, patience: Patience, silence_ticks: u32) -> Terms {
    let profile = Profile::Classical;
    let mut draw = Random::new(2);
    Terms {
        node: NODE,
        slot: SLOT,
        profile,
        pace: Pace::LockStep,
        slow_down: NonZeroU8::MIN,
        number: draw.half(),
        boot: draw.half(),
        requirements: Requirements {
            enabled: true,
            zero_age_s: 8 * 3600,
            shunt_passed: true,
            force_at_rest_n: 2000,
            stroke_um: 5000,
        },
        checks: Checks::usual(profile.counter_modulus(), cycle_s, 100e3),
        patience,
        silence_ticks,
        cycles: u64::from(cycles),
    }
}

/// The run on the host, on a line that holds the whole track; none where it is not completed.
pub fn run<P: Plant>(
    line: &Line<'_>,
    state: &mut LineState,
    rig: RigNode<P, Random>,
    cycles: u32,
) -> Option<u64> {
    let wire = Loopback::default();
    let [mut at_locomotive, mut at_rig] = wire.ends();
    let terms = terms(line.cycle_s, cycles, Patience::default(), SILENCE_TICKS);
    let mut locomotive = TimedLocomotive::new(Locomotive::new(line, state, terms)?);
    let mut rig = TimedRig::new(rig, SILENCE_TICKS);
    for _ in 0..cycles.saturating_add(OTHER_TICKS) {
        locomotive.tick(&mut at_locomotive, 0);
        rig.tick(&mut at_rig);
        match locomotive.locomotive().end() {
            Some(End::Completed) => return Some(locomotive.locomotive().hash()),
            Some(_) => return None,
            None => {}
        }
    }
    None
}
