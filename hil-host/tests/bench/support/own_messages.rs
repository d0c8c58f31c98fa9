//! A rig that knows its own messages alone, in virtual time: those of
//! `scenarios/rigs/own-messages/`.

use dbc::{CanId, Database, Signal, Value};
use hil_host::Draw;
use hil_host::bus::{BusCounters, RawFrame, Sent};
use hil_host::gateway::{Gateway, GatewayError, GatewayPlan, Loss, Wire};
use hil_host::rig::{Emulator, EmulatorState, Reference, Target};
use scenario::rig::RigSetup;
use scenario::source::Source;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Cycles between two messages with the state.
const STATE_CYCLES: u64 = 50;

/// A file of the examples.
pub(crate) fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/rigs/own-messages").join(name)
}

/// The plan of an example, with its map changed and everything accepted.
pub(crate) fn plan(name: &str, change: impl Fn(String) -> String) -> GatewayPlan {
    planned(name, change, Loss::ALL).unwrap_or_else(|error| panic!("{error}"))
}

/// The same, with these losses accepted.
pub(crate) fn planned(
    name: &str,
    change: impl Fn(String) -> String,
    accepted: &[Loss],
) -> Result<GatewayPlan, GatewayError> {
    planned_with(name, |dbc| dbc, change, accepted)
}

/// The same, with the DBC changed too.
pub(crate) fn planned_with(
    name: &str,
    change_dbc: impl Fn(String) -> String,
    change_map: impl Fn(String) -> String,
    accepted: &[Loss],
) -> Result<GatewayPlan, GatewayError> {
    let read = |file: &str| std::fs::read_to_string(example(file)).unwrap();
    let (dbc, map) = (format!("{name}.dbc"), format!("{name}-map.toml"));
    let database = Database::from_text(Path::new(&dbc), &change_dbc(read(&dbc)))?;
    let map = Source::from_text(Path::new(&map), &change_map(read(&map)));
    GatewayPlan::new(&database, &map, accepted)
}

/// What a rig does wrong, or not at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Habits {
    /// It stops after so many cycles without a command.
    pub(crate) time_out_cycles: Option<u64>,
    /// From this cycle on its counter stands still.
    pub(crate) freezes_at: Option<u64>,
    /// In this cycle it has a fault.
    pub(crate) fails_at: Option<u64>,
    /// From this cycle on its force is beyond what its signal may hold.
    pub(crate) blind_from: Option<u64>,
    /// Before this cycle it is silent: it has not started yet.
    pub(crate) starts_at: u64,
    /// In this cycle somebody else sends a command.
    pub(crate) foreign_at: Option<u64>,
}

/// A rig with one of the two examples of messages.
#[derive(Debug)]
pub(crate) struct OwnRig {
    is_servo: bool,
    database: Database,
    emulator: Emulator,
    state: EmulatorState,
    pub(crate) habits: Habits,
    target: Target,
    is_enabled: bool,
    silent: u64,
    pub(crate) cycles: u64,
    alive: u64,
    sequence: u64,
    is_failed: bool,
    out: VecDeque<RawFrame>,
    counters: BusCounters,
    /// Mode of every command, by the servo.
    pub(crate) modes: Vec<f64>,
    /// Set points (m).
    pub(crate) set_points_m: Vec<f64>,
}

impl OwnRig {
    pub(crate) fn new(name: &str, setup: &RigSetup, habits: Habits) -> Self {
        let emulator = Emulator::new(setup, 1e-3, 1);
        Self {
            is_servo: name == "servo",
            database: Database::read(&example(&format!("{name}.dbc"))).unwrap(),
            state: emulator.start_at(2.5e-3),
            emulator,
            habits,
            target: Target::Hold,
            is_enabled: false,
            silent: 0,
            cycles: 0,
            alive: 0,
            sequence: 0,
            is_failed: false,
            out: VecDeque::new(),
            counters: BusCounters::default(),
            modes: Vec::new(),
            set_points_m: Vec::new(),
        }
    }

    fn signal(&self, name: &str) -> (CanId, usize, Signal) {
        let (message, named) = self.database.signal(name).unwrap();
        (message.id, message.len, named.signal)
    }

    fn value(&self, frame: &RawFrame, name: &str) -> f64 {
        let (_, _, signal) = self.signal(name);
        match signal.read(frame.data()) {
            Value::Valid(value) => value,
            other => panic!("{name}: {other:?}"),
        }
    }

    fn put(&mut self, values: &[(&str, f64)]) {
        let (id, len, _) = self.signal(values[0].0);
        let mut data = vec![0; len];
        for (name, value) in values {
            self.signal(name).2.write(&mut data, *value);
        }
        self.out.push_back(RawFrame::new(id, false, &data).unwrap());
    }

    fn on_command(&mut self, frame: &RawFrame) {
        let (x_m, v_m_per_s) = if self.is_servo {
            assert_eq!(frame.id(), CanId::Extended(0x18FF_0101));
            self.modes.push(self.value(frame, "Mode"));
            self.is_enabled = self.value(frame, "Mode") == 1.0;
            self.sequence = self.value(frame, "Sequence") as u64;
            let x_m = self.value(frame, "SetPosition") * 1e-3;
            (x_m, self.value(frame, "SetVelocity") * 1e-3)
        } else {
            assert_eq!(frame.id(), CanId::Standard(0x210));
            self.is_enabled = true;
            (self.value(frame, "Target") * -1e-6, 0.0)
        };
        self.set_points_m.push(x_m);
        self.silent = 0;
        self.target = if self.is_enabled {
            Target::Follow(Reference { displacement_m: x_m, velocity_m_per_s: v_m_per_s })
        } else {
            Target::Hold
        };
    }

    fn cycle(&mut self) {
        self.cycles += 1;
        if self.cycles < self.habits.starts_at {
            return;
        }
        self.silent += 1;
        let reading = self.emulator.cycle(&mut self.state, self.target);
        if let Target::Follow(reference) = &mut self.target {
            *reference = reference.after(1e-3);
        }
        let is_late = self.habits.time_out_cycles.is_some_and(|most| self.silent >= most);
        self.is_failed |= self.habits.fails_at == Some(self.cycles);
        if is_late || self.is_failed {
            self.target = Target::Hold;
        }
        if self.habits.freezes_at.is_none_or(|at| self.cycles < at) {
            self.alive += 1;
        }
        if self.habits.foreign_at == Some(self.cycles) {
            self.put(&[("SetPosition", 40.0), ("Mode", 1.0)]);
        }
        let is_blind = self.habits.blind_from.is_some_and(|from| self.cycles >= from);
        let (force_n, x_m) = (reading.force_n, reading.displacement_m);
        if self.is_servo {
            self.put(&[
                ("LoadCell", force_n),
                ("Measured.Position", x_m * 1e3),
                ("SensorsOk", f64::from(!is_blind)),
                ("Alive", (self.alive % 256) as f64),
                ("SequenceSeen", self.sequence as f64),
            ]);
            let state = match () {
                () if self.is_failed => 4.0,
                () if is_late => 1.0,
                () if self.is_enabled => 2.0,
                () => 0.0,
            };
            if self.cycles.is_multiple_of(STATE_CYCLES) || self.is_failed {
                self.put(&[("ServoState", state), ("OilTemperature", 35.0)]);
            }
        } else {
            let force_kn = if is_blind { f64::INFINITY } else { force_n * -1e-3 };
            let life = (self.alive % 15) as f64;
            self.put(&[("Force", force_kn), ("Stroke", x_m * -1e6), ("Life", life)]);
        }
    }
}

impl Wire for OwnRig {
    fn send(&mut self, frame: &RawFrame) -> Sent {
        self.counters.sent += 1;
        self.on_command(frame);
        // A command stands for its time.
        self.cycle();
        Sent::Away
    }

    fn receive(&mut self) -> Option<RawFrame> {
        let frame = self.out.pop_front();
        self.counters.received += u64::from(frame.is_some());
        frame
    }

    fn wait(&mut self, _timeout: Duration) -> bool {
        self.cycle();
        true
    }

    fn has_own_time(&self) -> bool {
        false
    }

    fn counters(&self) -> BusCounters {
        self.counters
    }

    fn time(&self) -> Duration {
        Duration::from_millis(self.cycles)
    }
}

/// A gateway to such a rig.
pub(crate) fn gateway(plan: GatewayPlan, rig: OwnRig) -> Gateway<OwnRig> {
    let (node, profile) = (super::locomotive::NODE, can_protocol::Profile::Classical);
    Gateway::new(plan, rig, node, profile, Draw::seeded(7, 1))
}
