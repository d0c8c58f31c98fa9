//! The two roles of an image: the locomotive, and the rig as a node.

use crate::setup;
use can_protocol::arming::Patience;
use firmware_core::damper::Damper;
use firmware_core::line::{Line, LineState, Slot};
use nodes::locomotive::{End, Locomotive};
use nodes::rig::{ModelSetup, ServoBench, ServoRig};
use nodes::timed::{TimedLocomotive, TimedRig};
use same_bits::Random;
use same_bits::two_roles::{self, BoardReader};
use static_cell::StaticCell;

/// Period of the timer (us): a cycle of the model.
pub const PERIOD_US: u32 = 1000;

/// Ticks for which the other board may be silent. It is emulated, on a machine that may be busy.
const SILENCE_TICKS: u32 = 20_000;

/// How long it may leave a question of the exchange unanswered: five seconds.
const PATIENCE: Patience = Patience { repeat_cycles: 20, attempts: 250, quiet_cycles: 20_000 };

/// The rig, which has just started.
pub type BoardRig = TimedRig<nodes::rig::ModelRig<'static>, Random>;

/// The same behind a servo controller and its converters, which are doubles: a port puts its own in
/// their place.
pub type ServoBoardRig = TimedRig<ServoRig<ServoBench<'static>>, Random>;

/// The rig of the scenario around the model of its damper.
#[inline(never)]
pub fn rig(damper: &'static Damper) -> BoardRig {
    TimedRig::new(two_roles::rig(&model(damper)), SILENCE_TICKS)
}

/// The rig of the scenario behind a servo controller.
#[inline(never)]
pub fn servo_rig(damper: &'static Damper) -> ServoBoardRig {
    TimedRig::new(two_roles::behind_servo(&model(damper), setup::CYCLE_S), SILENCE_TICKS)
}

fn model(damper: &'static Damper) -> ModelSetup<'static> {
    ModelSetup {
        damper,
        stroke_m: setup::RIG_STROKE_M,
        rate_m_per_s: setup::RIG_RATE_M_PER_S,
        lag_s: setup::RIG_LAG_S,
        seed: 1,
    }
}

static LOCOMOTIVE: StaticCell<BoardLocomotive> = StaticCell::new();

/// The locomotive with the reader of its track.
pub struct BoardLocomotive {
    node: TimedLocomotive<'static>,
    line: &'static Line<'static>,
    reader: &'static mut BoardReader,
}

impl BoardLocomotive {
    /// The locomotive of the scenario for so many cycles of RUN; none the second time.
    #[inline(never)]
    pub fn new(cycles: u32) -> Option<&'static mut Self> {
        let line: &'static Line<'static> = setup::line_with_rig(&setup::VEHICLE)?;
        let state: &'static mut LineState = setup::start(line)?;
        let terms = two_roles::terms(line.cycle_s, cycles, PATIENCE, SILENCE_TICKS);
        let node = TimedLocomotive::new(Locomotive::new(line, state, terms)?);
        let reader = setup::track_reader()?;
        Some(LOCOMOTIVE.try_uninit()?.write(Self { node, line, reader }))
    }

    /// One tick of the timer.
    pub fn tick<C: embedded_can::nb::Can>(&mut self, can: &mut C, skipped: u32) {
        self.node.tick_reading(can, self.reader, skipped);
    }

    /// The model of the damper on its rig: where both roles are one program, the rig has the same.
    pub fn damper(&self) -> Option<&'static Damper> {
        match self.line.slots.get(two_roles::SLOT) {
            Some(Slot::Rig(rig)) => Some(&rig.model),
            _ => None,
        }
    }

    /// How it has ended; none while it goes on.
    pub fn end(&self) -> Option<End> {
        self.node.locomotive().end()
    }

    /// The trajectory hash.
    pub fn hash(&self) -> u64 {
        self.node.locomotive().hash()
    }
}
