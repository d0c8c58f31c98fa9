//! A recorded run, computed again from what came over the bus.
//!
//! ```text
//! scenario.toml -> session      bus.log -> frames received -> cycle -> frames sent, hash
//!                               record.npy -> missed ticks, requests of an operator      |
//!                               compare with bus.log and record.npy, bit for bit <-------+
//! ```
//! The control loop is that of a run; only buses and clock are replaced. Nothing of the rig is
//! modelled: a record of a real damper is replayed as well as one of an emulated rig.
//!
//! Limits: a cycle of which the bus took no frame leaves no mark in the log, so that the frames of
//! two cycles cannot be told apart, and what the recorder dropped is not there. Both show as a
//! difference at that cycle.

mod arming;
mod script;

use crate::BenchError;
use crate::bus::BusChoice;
use crate::clock::Tick;
use crate::control::{Arming, Buses, Course, Ending, STOP_S, Session, SessionState};
use crate::options::PaceChoice;
use crate::record::{LogFault, LogReader, Queues, Row, RowReader};
use crate::run::{LOG, Plan, RECORD, RunAbout, SCENARIO, Terms, kept_summary, read_about, session};
use can_protocol::{Pace, Profile, RunState, Sync};
use files::{ResultFolder, quoted};
use scenario::run::{Overrides, Run};
use script::{ReplayedBus, Script};
use serde::Serialize;
use std::cell::RefCell;
use std::fmt;
use std::num::NonZeroU8;
use std::path::Path;

/// What a replay shows.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Replay {
    /// Cycles that were computed again and are the same, up to the first difference.
    pub cycles: u64,
    /// Cycles of them whose rows the record lacks: only their frames were compared.
    pub without_row: u64,
    /// Cycles that were not computed, because the bus log ends before.
    pub not_replayed: u64,
    /// Cycles by `summary.json` that are behind the last row of the record.
    pub not_recorded: u64,
    /// Frames that were sent as they are in the bus log.
    pub frames: u64,
    /// Trajectory hash after the last of these cycles.
    pub trajectory_hash: String,
    /// The program that recorded the run, where it is another version.
    pub recorded_by: Option<String>,
    /// The first difference, and the cycle and time in which it is.
    pub difference: Option<Place>,
}

/// Where a replay differs from its record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Place {
    /// Number of the cycle, from one.
    pub cycle: u64,
    /// Its time: zero in the first cycle of RUN (s).
    pub time_s: f64,
    /// What differs.
    pub what: Difference,
}

// Times are those of whole cycles.
impl Eq for Place {}

/// A difference between a record and its replay.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "in", rename_all = "lowercase")]
pub enum Difference {
    /// A frame that the host sends.
    Frame {
        /// Its bus.
        bus: String,
        /// The frame in the log.
        recorded: String,
        /// The frame of the replay.
        replayed: String,
    },
    /// The state of the host.
    State {
        /// That of the record.
        recorded: &'static str,
        /// That of the replay.
        replayed: &'static str,
    },
    /// The trajectory.
    Trajectory {
        /// The hash in the record.
        recorded: String,
        /// The hash of the replay.
        replayed: String,
    },
}

impl Replay {
    /// Whether every cycle of the run was computed again and is the same.
    pub fn is_whole(&self) -> bool {
        self.difference.is_none() && self.not_replayed + self.not_recorded == 0
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cycle {} at {:.3} s: ", self.cycle, self.time_s)?;
        match &self.what {
            Difference::Frame { bus, recorded, replayed } => {
                write!(f, "sent {replayed} on {}, the log has {recorded}", quoted(bus))
            }
            Difference::State { recorded, replayed } => {
                write!(f, "state {replayed}, the record has {recorded}")
            }
            Difference::Trajectory { recorded, replayed } => {
                write!(f, "trajectory {replayed}, the record has {recorded}")
            }
        }
    }
}

/// Computes the run in a result folder again. `progress` gets the cycles that are done and asked
/// for.
///
/// # Errors
/// The folder holds no run whose rigs were armed, or a file of it cannot be read.
pub fn replay(folder: &Path, progress: &mut dyn FnMut(u64, u64)) -> Result<Replay, BenchError> {
    let folder = ResultFolder::existing(folder, "run")?;
    let about = read_about(&folder)?;
    let run = Run::load(&folder.file(SCENARIO), Overrides::default())?;
    let log = folder.file(LOG);
    let record = folder.file(RECORD);
    let mut rows = RowReader::open(&record)?;
    let failed = |why| BenchError::File { file: record.clone(), why };
    let plan = Plan::new(&run, &bus_of(&about, &record)?)?;
    let track = run.track.view();
    let session = session(&run, &track, &plan.rigs, terms(&about, &log)?)?;
    let mut state = session.start(session.line.start(run.start.state.clone()));

    let names = plan.buses.iter().map(|bus| bus.interface().to_owned()).collect();
    let script = RefCell::new(Script::new(
        LogReader::open(&log).map_err(LogFault::into_bench_error)?,
        names,
    ));
    let Some(first) = rows.next().map_err(failed)? else {
        return Err(kept(&record, "no row", "the record of a run that has begun"));
    };
    arming::arm(&session, &mut state, &mut script.borrow_mut(), &first)
        .map_err(|why| kept(&log, why.found(), "the log of the run in this folder"))?;

    let buses = plan.buses.iter().enumerate().map(|(number, bus)| ReplayedBus {
        number,
        script: &script,
        has_own_time: bus.has_own_time(),
    });
    let mut buses: Vec<_> = buses.collect();
    let mut queues = Queues::for_rigs(session.ports.len());
    // Nobody reads them: what the replay records is dropped.
    let (mut recorder, _drain) = queues.split();
    let mut again = Again {
        session: &session,
        state: &mut state,
        buses: Buses::new(&mut buses, &mut recorder),
        script: &script,
        course: Course::new(&run, &track),
        ending: Ending::default(),
        cycles: about.cycles,
        record: &record,
        waits_for_rigs: about.pace == PaceChoice::Lockstep,
        without_row: 0,
    };
    let mut row = Some(first);
    let mut difference = None;
    let mut same = 0;
    let mut hash = again.state.hash;
    let mut not_replayed = 0;
    let run_cycles = kept_summary(&folder)?.map(|kept| kept.cycles);
    let mut last = 0;
    while let Some(next) = row {
        last = next.cycle;
        if again.is_log_over() {
            not_replayed += 1;
            row = rows.next().map_err(failed)?;
            continue;
        }
        difference = again.up_to(&next)?;
        if let Some(fault) = script.borrow_mut().take_fault() {
            return Err(fault.into_bench_error());
        }
        if difference.is_some() {
            break;
        }
        (same, hash) = (again.state.line.cycle, again.state.hash);
        if same.is_multiple_of(1000) {
            progress(same, about.cycles);
        }
        row = rows.next().map_err(failed)?;
    }
    let program = RunAbout::this_program();
    Ok(Replay {
        cycles: same,
        without_row: again.without_row,
        not_replayed,
        not_recorded: run_cycles.map_or(0, |cycles| cycles.saturating_sub(last)),
        frames: script.borrow().sent(),
        trajectory_hash: format!("{hash:016x}"),
        recorded_by: (about.program != program).then_some(about.program),
        difference,
    })
}

/// The run that is computed again.
struct Again<'a, 's, 'b, 'r> {
    session: &'a Session<'s>,
    state: &'a mut SessionState,
    buses: Buses<'b, 'r, ReplayedBus<'b>>,
    script: &'b RefCell<Script>,
    course: Course<'s>,
    ending: Ending,
    /// Cycles of RUN that were asked for.
    cycles: u64,
    record: &'b Path,
    /// Whether a cycle began when every rig had answered the last one.
    waits_for_rigs: bool,
    without_row: u64,
}

impl Again<'_, '_, '_, '_> {
    /// The cycles up to that of a row; where they differ from the record, if they do.
    fn up_to(&mut self, row: &Row) -> Result<Option<Place>, BenchError> {
        while self.state.line.cycle + 1 < row.cycle {
            self.must_go_on(row)?;
            self.without_row += 1;
            self.cycle(0)?;
            if let Some(what) = self.script.borrow().difference() {
                return Ok(Some(self.place(what)));
            }
        }
        self.must_go_on(row)?;
        let skipped = u64::from(row.skipped);
        let before = self.mark(row);
        let computed = self.cycle(skipped)?;
        let is_other = |computed: &Row| computed.state != row.state;
        if is_other(&computed)
            && let Some(before) = before
        {
            // Nothing on the bus has led there: an operator has, or a disk that was too slow.
            *self.state = before;
            self.script.borrow_mut().go_back();
            self.request(row.state);
            let computed = self.cycle(skipped)?;
            return Ok(self.compared(row, &computed));
        }
        Ok(self.compared(row, &computed))
    }

    /// The state before a cycle in which the recorded run changes its state.
    fn mark(&mut self, row: &Row) -> Option<SessionState> {
        self.script.borrow_mut().mark();
        let now = nodes::wire_state(self.state.line.state);
        (now != row.state).then(|| self.state.clone())
    }

    /// Whether nothing is left in the log of a run that has rigs: every cycle sends to them.
    fn is_log_over(&self) -> bool {
        let has_rigs = !self.session.ports.is_empty();
        let mut script = self.script.borrow_mut();
        has_rigs && script.peek().is_none() && !script.has_fault()
    }

    /// Refuses a row of a cycle that cannot have been run.
    fn must_go_on(&self, row: &Row) -> Result<(), BenchError> {
        let line = &self.state.line;
        let has_rigs = !self.session.ports.is_empty();
        let most = self.cycles.saturating_add(self.session.cycles(STOP_S));
        let is_over = if has_rigs { self.is_log_over() } else { line.cycle >= most };
        if is_over || !(line.state.moves() || line.is_safe()) {
            let (cycle, last) = (row.cycle, line.cycle);
            let found = format!("the row of cycle {cycle} in a run that ends with cycle {last}");
            return Err(kept(self.record, &found, "no row behind the end"));
        }
        Ok(())
    }

    fn is_first(&self) -> bool {
        self.state.line.cycle == 0
    }

    /// What an operator has asked for.
    fn request(&mut self, recorded: RunState) {
        match recorded {
            RunState::RampOut => self.session.end_in_order(self.state),
            RunState::Safe | RunState::Fault => self.session.stop_by_operator(self.state),
            _ => {}
        }
    }

    /// One cycle with the frames that it found.
    fn cycle(&mut self, skipped: u64) -> Result<Row, BenchError> {
        while self.script.borrow_mut().is_received_next() {
            self.session.receive(self.state, &mut self.buses);
        }
        if self.waits_for_rigs && !self.state.line.is_safe() && !self.is_first() {
            // Whoever has not answered by now did not answer within the patience of the run.
            self.session.stop_for_silence(self.state);
        }
        self.state.skipped += skipped;
        let tick = Tick { skipped, ..Tick::default() };
        let track = self.course.track();
        let row = self.session.cycle_on(&track, self.state, &mut self.buses, tick);
        // An end that was asked for goes on from cycle to cycle.
        let _end = self.ending.take(self.session, self.state, self.cycles, false);
        if self.course.is_passed(&self.state.line) {
            self.course.change()?;
        }
        Ok(row)
    }

    /// Where a cycle differs from its row.
    fn compared(&self, recorded: &Row, replayed: &Row) -> Option<Place> {
        let hash = |row: &Row| format!("{:016x}", row.hash);
        let what = if let Some(what) = self.script.borrow().difference() {
            what
        } else if recorded.state != replayed.state {
            let (recorded, replayed) = (recorded.state.name(), replayed.state.name());
            Difference::State { recorded, replayed }
        } else if recorded.hash != replayed.hash {
            Difference::Trajectory { recorded: hash(recorded), replayed: hash(replayed) }
        } else {
            return None;
        };
        Some(self.place(what))
    }

    fn place(&self, what: Difference) -> Place {
        let line = &self.state.line;
        Place { cycle: line.cycle, time_s: line.time_s(self.session.line.cycle_s), what }
    }
}

/// The bus of slots that name none.
fn bus_of(about: &RunAbout, record: &Path) -> Result<BusChoice, BenchError> {
    about.bus.parse().map_err(|_| {
        let found = format!("a run on bus {}", quoted(&about.bus));
        kept(record, &found, "memory or socketcan:INTERFACE")
    })
}

/// What the rigs were given in the handshake: the sync of the host says it.
fn terms(about: &RunAbout, log: &Path) -> Result<Terms, BenchError> {
    let mut reader = LogReader::open(log).map_err(LogFault::into_bench_error)?.of_first_part();
    let mut sync = None;
    while let Some(line) =
        reader.next_line().map_err(LogFault::into_bench_error)?.filter(|_| sync.is_none())
    {
        sync = Sync::decode(line.frame.id(), line.frame.data()).ok();
    }
    let numbers = about.session_number.zip(about.boot_number);
    let (number, boot) = numbers.unwrap_or_default();
    let (profile, pace, slow_down) = sync
        .map_or((Profile::Classical, Pace::LockStep, NonZeroU8::MIN), |sync| {
            (sync.profile, sync.pace, sync.slow_down)
        });
    let arming = Arming { number, boot, ..Arming::in_memory() };
    let gate_hz = about.gate_hz;
    Ok(Terms { profile, pace, slow_down, arming, gate_hz, shows_progress: false })
}

fn kept(file: &Path, found: &str, expected: &'static str) -> BenchError {
    BenchError::Kept { file: file.to_owned(), found: found.to_owned(), expected }
}
