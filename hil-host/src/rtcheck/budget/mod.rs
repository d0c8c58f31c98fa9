//! Where the time of a cycle goes, stage by stage, at every rate: the real-time budget.
//!
//! ```text
//! period = lateness + receive + decode + guard + step + compensate + encode + send + record + left
//! ```
//! The loop is that of a run: the same session, the same cycle, coupled to an emulated rig, with a
//! stopwatch that looks at the clock behind every stage. The rig is served, and the recorder's
//! queues emptied, between two cycles: neither belongs to the loop, which has them in processes and
//! threads of their own. It is measured twice,
//!
//! - **paced**: on absolute deadlines with the loop's real-time set-up, so that caches are as cold
//!   as the pause between two cycles leaves them;
//! - **hot**: one cycle behind the other, as a benchmark does.
//!
//! Frames change hands in memory, or through two sockets on a virtual interface: then receive and
//! send hold what the kernel takes. Looking at the clock costs time too; it is measured and said,
//! and not taken off.

mod table;
mod two_ends;

use super::distribution::empty;
use super::ticks::Ticks;
use crate::BenchError;
use crate::bus::BusChoice;
use crate::clock::{Pacer, Tick};
use crate::control::{Buses, Course, Requests, Session, SessionState, Stage, Stopwatch};
use crate::realtime::{self, RealtimeOptions, RealtimeReport};
use crate::record::{Drain, Queues, Recorder};
use crate::rig::RigNode;
use crate::run::{Plan, Terms, profile_of, session};
use can_protocol::Profile;
use firmware_core::track::Track;
use hdrhistogram::Histogram;
use scenario::run::{Rate, Run};
use std::time::{Duration, Instant};
use two_ends::TwoEnds;

/// The stages of a cycle, in order.
pub(super) const STAGES: [(Stage, &str); 8] = [
    (Stage::Receive, "receive"),
    (Stage::Decode, "decode"),
    (Stage::Guard, "guard"),
    (Stage::Step, "vehicle step"),
    (Stage::Compensate, "compensate"),
    (Stage::Encode, "encode"),
    (Stage::Send, "send"),
    (Stage::Record, "record"),
];

/// How long rigs in memory may take to answer.
const PATIENCE: Duration = Duration::from_secs(2);

/// Cycles of RUN before the first one that counts: caches and branch predictors settle.
const SETTLING_CYCLES: u64 = 200;

/// Looks at the clock whose cost is averaged.
const LOOKS: u32 = 10_000;

/// What is measured.
#[derive(Debug, Clone, PartialEq)]
pub struct BudgetOptions {
    /// Time of the paced measurement at each rate (s).
    pub seconds: f64,
    /// Hot cycles at each rate.
    pub hot_cycles: u64,
    /// Real-time set-up of the loop's thread.
    pub realtime: RealtimeOptions,
    /// Memory, or a virtual interface.
    pub bus: BusChoice,
}

/// The budget at every rate.
#[derive(Debug, Clone)]
pub struct Budget {
    /// What the system granted.
    pub realtime: RealtimeReport,
    /// What the frames went through.
    pub bus: BusChoice,
    /// A look at the clock (ns).
    pub look_ns: f64,
    /// Rate by rate.
    pub rates: Vec<RateBudget>,
}

/// The budget at a rate.
#[derive(Debug, Clone)]
pub struct RateBudget {
    /// The rate.
    pub rate: Rate,
    /// On absolute deadlines; none where it was not asked for.
    pub paced: Option<StageTimes>,
    /// One cycle behind the other.
    pub hot: StageTimes,
    /// Ticks that were skipped.
    pub skipped: u64,
}

/// Times of the cycles of a measurement (ns).
#[derive(Debug, Clone)]
pub struct StageTimes {
    /// Stage by stage.
    pub(super) stages: [Histogram<u64>; STAGES.len()],
    /// From the wake-up until the last command is sent.
    pub(super) receive_to_send: Histogram<u64>,
    /// From decode to encode without the vehicle step.
    pub(super) around_step: Histogram<u64>,
    /// How late the loop woke up.
    pub(super) lateness: Histogram<u64>,
    /// Lateness and the whole cycle.
    pub(super) used: Histogram<u64>,
}

impl StageTimes {
    fn new() -> Self {
        Self {
            stages: std::array::from_fn(|_| empty()),
            receive_to_send: empty(),
            around_step: empty(),
            lateness: empty(),
            used: empty(),
        }
    }

    fn take(&mut self, laps: &Laps, lateness_ns: u64) {
        for (histogram, spent_ns) in self.stages.iter_mut().zip(laps.spent_ns) {
            histogram.saturating_record(spent_ns);
        }
        let of = |stages: &[Stage]| stages.iter().map(|stage| laps.of(*stage)).sum::<u64>();
        let around = of(&[Stage::Decode, Stage::Guard, Stage::Compensate, Stage::Encode]);
        let to_send = around + of(&[Stage::Receive, Stage::Step, Stage::Send]);
        self.around_step.saturating_record(around);
        self.receive_to_send.saturating_record(to_send);
        self.lateness.saturating_record(lateness_ns);
        self.used.saturating_record(lateness_ns + to_send + laps.of(Stage::Record));
    }
}

/// A stopwatch that adds up the stages of one cycle.
#[derive(Debug)]
struct Laps {
    last: Instant,
    spent_ns: [u64; STAGES.len()],
}

impl Laps {
    fn begin() -> Self {
        Self { last: Instant::now(), spent_ns: [0; STAGES.len()] }
    }

    fn of(&self, stage: Stage) -> u64 {
        self.spent_ns[stage as usize]
    }
}

impl Stopwatch for Laps {
    #[inline]
    fn lap(&mut self, stage: Stage) {
        let now = Instant::now();
        let spent = now.saturating_duration_since(self.last);
        self.spent_ns[stage as usize] += spent.as_nanos() as u64;
        self.last = now;
    }
}

/// Measures the same scenario at each rate, which `load` reads for as many seconds as are needed.
/// Without `seconds` the paced measurement is left out.
///
/// # Errors
/// A scenario that does not hold at a rate; a bus that cannot be used; real time that is required
/// and was not granted.
pub fn budget<E: From<BenchError>>(
    load: impl Fn(Rate, f64) -> Result<Run, E>,
    options: &BudgetOptions,
) -> Result<Budget, E> {
    let mut runs = Vec::new();
    for rate in Rate::ALL {
        let hot_s = (options.hot_cycles + 2 * SETTLING_CYCLES) as f64 * rate.cycle_s();
        // The ramps are no part of the duration.
        runs.push(load(rate, options.seconds + hot_s)?);
    }
    // A thread of its own: its set-up ends with it.
    let measured = std::thread::scope(|scope| {
        scope
            .spawn(|| of_rates(&runs, options))
            .join()
            .unwrap_or(Err(BenchError::Thread { name: "keeps the pace" }))
    });
    Ok(measured?)
}

fn of_rates(runs: &[Run], options: &BudgetOptions) -> Result<Budget, BenchError> {
    let begin = Instant::now();
    for _ in 0..LOOKS {
        std::hint::black_box(Instant::now());
    }
    let look_ns = begin.elapsed().as_nanos() as f64 / f64::from(LOOKS);
    let realtime = realtime::set_up(&options.realtime);
    if options.realtime.require && !realtime.complete() {
        return Err(BenchError::RealtimeRefused);
    }
    let rates = runs.iter().map(|run| of_rate(run, options));
    let rates = rates.collect::<Result<_, _>>()?;
    Ok(Budget { realtime, bus: options.bus.clone(), look_ns, rates })
}

fn of_rate(run: &Run, options: &BudgetOptions) -> Result<RateBudget, BenchError> {
    // CAN FD at every rate: one column differs from the next by the rate alone.
    let profile = Profile::Fd;
    debug_assert!(run.rate == Rate::Usual || profile == profile_of(run.rate), "{}", run.rate);
    let plan = Plan::new(run, &BusChoice::Memory)?;
    let track = run.track.view();
    let session = session(run, &track, &plan.rigs, Terms::in_memory(profile))?;
    let rigs = |number: usize| {
        let rigs = plan.rigs.iter().filter(move |rig| rig.bus == number);
        rigs.map(|rig| RigNode::new(&run.rig, rig.node, profile))
    };
    let buses = (0..plan.buses.len()).map(|number| match &options.bus {
        BusChoice::Memory => Ok(TwoEnds::in_memory(rigs(number))),
        BusChoice::SocketCan(interface) => TwoEnds::on(interface, rigs(number), profile),
    });
    let buses: Vec<TwoEnds> = buses.collect::<Result<_, _>>()?;
    measure(run, &session, buses, options)
}

/// A loop that is being measured.
struct Measurement<'a, 'q> {
    session: &'a Session<'a>,
    state: SessionState,
    buses: Vec<TwoEnds>,
    recorder: Recorder<'q>,
    drain: Drain<'q>,
}

fn measure(
    run: &Run,
    session: &Session<'_>,
    mut buses: Vec<TwoEnds>,
    options: &BudgetOptions,
) -> Result<RateBudget, BenchError> {
    let mut state = session.start(session.line.start(run.start.state.clone()));
    session
        .greet(&mut state, &mut buses, PATIENCE, &Requests::armed())
        .map_err(|why| why.on(&options.bus))?;
    let mut queues = Queues::default();
    let (recorder, drain) = queues.split();
    let mut bench = Measurement { session, state, buses, recorder, drain };
    let track = session.line.track;
    let mut course = Course::new(run, track);
    let mut cycle = |bench: &mut Measurement<'_, '_>, times: Option<&mut StageTimes>, tick| {
        if course.is_passed(&bench.state.line) {
            course.change()?;
        }
        bench.cycle(&course.track(), times, tick);
        Ok::<(), BenchError>(())
    };
    while bench.state.line.run_cycles() < SETTLING_CYCLES {
        cycle(&mut bench, None, Tick::default())?;
    }
    let mut hot = StageTimes::new();
    for _ in 0..options.hot_cycles {
        cycle(&mut bench, Some(&mut hot), Tick::default())?;
    }
    let mut ticks = Ticks::new(run.rate.cycles(options.seconds));
    let mut paced = (!ticks.are_over()).then(StageTimes::new);
    let mut pacer = Pacer::new(run.rate.cycle_ns(), 1);
    while !ticks.are_over() {
        let tick = pacer.wait();
        if !ticks.take(tick.skipped) {
            break;
        }
        // The emulated rig has no clock that would have gone on.
        cycle(&mut bench, paced.as_mut(), Tick { skipped: 0, ..tick })?;
    }
    match bench.state.stop {
        Some(stop) => Err(BenchError::Budget { rate_hz: run.rate.hz(), why: stop.to_string() }),
        None => Ok(RateBudget { rate: run.rate, paced, hot, skipped: ticks.skipped }),
    }
}

impl Measurement<'_, '_> {
    fn cycle(&mut self, track: &Track<'_>, times: Option<&mut StageTimes>, tick: Tick) {
        let mut buses = Buses::new(&mut self.buses, &mut self.recorder);
        let mut laps = Laps::begin();
        let row = self.session.timed_cycle_on(track, &mut self.state, &mut buses, tick, &mut laps);
        buses.recorder().row(row);
        laps.lap(Stage::Record);
        if let Some(times) = times {
            times.take(&laps, tick.lateness_ns);
        }
        self.buses.iter_mut().for_each(TwoEnds::serve);
        while self.drain.rows.next().is_some() {}
        while self.drain.events.next().is_some() {}
    }
}
