//! The control loop on the memory bus, in virtual time: what it does with frames that it should not
//! use, and how it ends.

use crate::support::locomotive::{NODE, scenario, session};
use can_protocol::{Frame, MessageId, Pace as WirePace, Profile};
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::clock::{Pacer, Tick};
use hil_host::control::{
    Asker, Buses, Course, End, NoAnswer, Pace, Requests, STOP_S, Session, SessionState,
};
use hil_host::record::{Queues, ROWS};
use hil_host::rig::RigNode;
use scenario::run::Run;
use std::collections::VecDeque;
use std::time::Duration;

/// The bus of the rig, with room for frames that neither host nor rig has sent.
struct Disturbed {
    bus: MemoryBus,
    from_outside: VecDeque<WireFrame>,
    measurements: Vec<WireFrame>,
    /// The rig is disconnected after this number of measurements.
    most: usize,
}

impl Disturbed {
    fn new(run: &Run) -> Self {
        let bus = MemoryBus::new(Some(RigNode::new(&run.rig, NODE, Profile::Classical)));
        let from_outside = VecDeque::new();
        Self { bus, from_outside, measurements: Vec::new(), most: usize::MAX }
    }

    /// Disturbances on a bus: garbage, frames with a wrong CRC, old ones, foreign ids.
    fn disturb(&mut self) {
        let [.., old, _, _, last] = self.measurements.as_slice() else { panic!("too early") };
        let mut broken = last.data().to_vec();
        broken[3] ^= 0x10;
        let frame = |id, data: &[u8]| WireFrame::new(id, false, data).unwrap();
        let measurement = last.id();
        let command = MessageId::Command(Profile::Classical, NODE).raw();
        for frame in [
            frame(measurement, &broken),
            old.clone(),
            last.clone(),
            frame(measurement, &[1, 2]),
            frame(command, &[0xDE, 0xAD, 0xBE, 0xEF]),
            frame(0x7AA, &[0, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77]),
        ] {
            self.bus.inject(&frame);
            self.from_outside.push_back(frame);
        }
    }
}

impl Bus for Disturbed {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.bus.send(frame)
    }
    fn receive(&mut self) -> Option<WireFrame> {
        if let Some(frame) = self.from_outside.pop_front() {
            return Some(frame);
        }
        let frame = self.bus.receive().filter(|_| self.measurements.len() < self.most)?;
        if frame.id() == MessageId::Measurement(Profile::Classical, NODE).raw() {
            self.measurements.push(frame.clone());
        }
        Some(frame)
    }
    fn wait(&mut self, timeout: Duration) -> bool {
        !self.from_outside.is_empty() || self.bus.wait(timeout)
    }
    fn has_own_time(&self) -> bool {
        self.bus.has_own_time()
    }
    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}

fn greeted(session: &Session<'_>, run: &Run) -> (SessionState, Disturbed) {
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = Disturbed::new(run);
    let buses = std::slice::from_mut(&mut bus);
    session.greet(&mut state, buses, Duration::from_secs(1), &Requests::armed()).unwrap();
    (state, bus)
}

#[test]
fn garbage_wrong_crc_and_old_frames_change_nothing_but_a_counter() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut course = |disturbed: bool| {
        let (mut state, mut bus) = greeted(&session, &run);
        let mut disturbances = 0;
        for cycle in 0..2000 {
            if disturbed && cycle > 10 && cycle % 97 == 0 {
                bus.disturb();
                disturbances += 1;
            }
            let buses = std::slice::from_mut(&mut bus);
            session.cycle(&mut state, &mut Buses::new(buses, &mut recorder), Tick::default());
        }
        (state, bus, disturbances)
    };
    let (clean, clean_bus, _) = course(false);
    let (state, bus, times) = course(true);
    assert!(times > 10);
    assert_eq!((state.hash, &state.line), (clean.hash, &clean.line));
    let counts = session.ports[0].counts(&state.ports[0]);
    assert_eq!((counts.wrong_crc, counts.repeated), (2 * times, times));
    assert_eq!((counts.wrong_sequence, counts.lost_frames), (times, 0));
    let (rig, clean_rig) = (bus.bus.rigs()[0].frames(), clean_bus.bus.rigs()[0].frames());
    assert_eq!((rig.crc_errors, clean_rig.crc_errors), (times, 0));
    // Commands in ARMED asked where the ram stands.
    assert_eq!((rig.received, rig.lost), (clean_rig.received, 0));
    assert!((2001..2010).contains(&rig.received), "{}", rig.received);
    assert_eq!(bus.bus.rigs()[0].physics(), clean_bus.bus.rigs()[0].physics());
}

#[test]
fn a_late_host_found_the_measurements_of_rigs_in_memory_old() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::Clock);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut course = |skipped: u64| {
        let (mut state, mut bus) = greeted(&session, &run);
        for cycle in 0..1000 {
            let tick = Tick { skipped: if cycle == 500 { skipped } else { 0 }, ..Tick::default() };
            let buses = std::slice::from_mut(&mut bus);
            session.cycle(&mut state, &mut Buses::new(buses, &mut recorder), tick);
        }
        assert_eq!(state.stop, None);
        state.hash
    };
    let on_time = course(0);
    for skipped in [1, 6, 7, 14, 15, 1000] {
        assert_eq!(course(skipped), on_time, "{skipped} ticks skipped");
    }
}

#[test]
fn a_host_whose_rig_falls_silent_goes_safe_in_the_fifth_cycle_and_ends_after_the_stop() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::Clock);
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let (mut state, mut bus) = greeted(&session, &run);
    bus.most = bus.measurements.len() + 300;
    let mut buses = Buses::new(std::slice::from_mut(&mut bus), &mut recorder);
    // A clock that waits for nothing and skips nothing.
    let mut pace = Pace::Realtime(Pacer::virtual_time(1_000_000));
    let mut course = Course::new(&run, &track);
    let end = session.run(&mut course, &mut state, &mut buses, &mut pace, 5000, &Requests::armed());
    assert_eq!(end, End::Safe);
    // The last measurement is used in cycle 301; the guard trips in the fifth cycle after it.
    assert_eq!(state.line.cycle, 301 + 5 + (STOP_S * 1e3) as u64);
    assert_eq!(state.line.slots[0].command.velocity_m_per_s, 0.0);
    assert_eq!(state.skipped, 0);
}

#[test]
fn a_stop_before_the_first_cycle_ends_the_wait_for_the_rigs() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::LockStep);
    let mut state = session.start(session.line.start(run.start.state.clone()));
    let mut bus = Disturbed::new(&run);
    bus.most = 0;
    let requests = Requests::armed();
    requests.end(Asker::Key);
    let greeting = session.greet(
        &mut state,
        std::slice::from_mut(&mut bus),
        Duration::from_secs(600),
        &requests,
    );
    assert_eq!(greeting, Err(NoAnswer::Interrupted));
}

#[test]
fn a_loop_whose_rows_find_no_room_for_more_than_a_second_ends_in_order() {
    let run = scenario();
    let track = run.track.view();
    let session = session(&run, &track, WirePace::Clock);
    let mut queues = Queues::default();
    // Nobody takes the rows out: as on a disk that hangs.
    let (mut recorder, _drain) = queues.split();
    recorder.rows_lost_at_most = 1000;
    let (mut state, mut bus) = greeted(&session, &run);
    let mut buses = Buses::new(std::slice::from_mut(&mut bus), &mut recorder);
    let mut pace = Pace::Realtime(Pacer::virtual_time(1_000_000));
    let mut course = Course::new(&run, &track);
    let end =
        session.run(&mut course, &mut state, &mut buses, &mut pace, 20_000, &Requests::armed());
    // Coupling and motion are faded out, for half a second each.
    assert_eq!((end, state.line.cycle), (End::Stopped, ROWS as u64 + 1001 + 1000));
    assert!(!state.line.is_safe());
    assert_eq!((recorder.dropped_rows, recorder.is_overrun()), (2001, true));
}
