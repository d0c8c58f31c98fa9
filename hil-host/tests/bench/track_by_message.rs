//! A locomotive node that reads its track from a server on the bus: the bits of the track in
//! memory, and what happens where the samples are late, lost, old or another's.

use crate::locomotive_node::{self, terms, together, until_end};
use crate::support::locomotive::{NODE, scenario};
use can_protocol::{Frame, MessageId, PROTOCOL_VERSION, Pace, Profile, RunState, Sync};
use firmware_core::line::Line;
use firmware_core::supervision::Signal;
use firmware_core::track::{Irregularity, IrregularitySample, Track};
use hil_host::rig::RigNode;
use nodes::can::{receive, transmit};
use nodes::locomotive::{End, Locomotive, NotArmed, SILENCE_TICKS, STOP_CYCLES};
use nodes::loopback::{End as BusEnd, Loopback};
use nodes::rig::Plant;
use nodes::timed::{TimedLocomotive, TimedRig, TimedServer};
use nodes::track::{self, Reader, Server, TrackFault, Ways, as_sent};
use scenario::run::Run;
use std::num::{NonZeroU8, NonZeroU16};

/// Ticks after which a bench that has not ended hangs.
const MOST_TICKS: u32 = 20_000;

/// What a board holds.
type BoardReader = Reader<256>;

/// The scenario on its track as it travels.
fn on_a_track_that_travels() -> Run {
    let mut run = scenario();
    for sample in &mut run.track.samples.samples {
        *sample = as_sent(sample).unwrap();
    }
    run
}

/// What a session has come to.
#[derive(Debug, PartialEq)]
struct Found {
    hash: u64,
    end: End,
    stop: Option<(u64, Signal)>,
    cycles: u64,
    rig: RunState,
}

/// A board and its rig on a bus with whatever else is on it, tick by tick.
fn session(
    run: &Run,
    pace: Pace,
    reader: &mut BoardReader,
    else_on_bus: impl FnMut(u64, &mut BusEnd<'_>),
) -> Found {
    session_with(run, pace, reader, else_on_bus, false)
}

/// The same with a rig that may have run before.
fn session_with(
    run: &Run,
    pace: Pace,
    reader: &mut BoardReader,
    mut else_on_bus: impl FnMut(u64, &mut BusEnd<'_>),
    ran_before: bool,
) -> Found {
    // No sample of the track is in this memory.
    let irregularity = Irregularity { samples: &[], ..run.track.view().irregularity };
    let track = Track { irregularity, ..run.track.view() };
    let line: Line<'_> = hil_host::run::line(run, &track);
    let mut state = line.start(run.start.state.clone());
    let wire = Loopback::default();
    let [mut at_locomotive, mut at_rig, mut at_server] = wire.ends();
    let locomotive = Locomotive::new(&line, &mut state, terms(run, pace)).unwrap();
    let mut locomotive = TimedLocomotive::new(locomotive);
    let rig: RigNode = RigNode::new(&run.rig, NODE, Profile::Classical);
    let mut rig = TimedRig::new(rig, SILENCE_TICKS);
    if ran_before {
        // It is in STANDBY and sends heartbeats.
        let sync = Sync {
            version: PROTOCOL_VERSION,
            profile: Profile::Classical,
            pace,
            period_us: NonZeroU16::new(1000).unwrap(),
            slow_down: NonZeroU8::MIN,
            time_us: 0,
        };
        assert!(transmit(&mut at_server, &sync.encode()));
        rig.tick(&mut at_rig);
        assert_eq!(rig.rig().run_state(), RunState::Standby);
    }
    let found = until_end(&mut locomotive, (rig, at_rig), MOST_TICKS, |_, locomotive, _| {
        else_on_bus(locomotive.locomotive().state().cycle, &mut at_server);
        locomotive.tick_reading(&mut at_locomotive, reader, 0);
        true
    });
    found.into()
}

impl<P: Plant> From<locomotive_node::Found<P>> for Found {
    fn from(found: locomotive_node::Found<P>) -> Self {
        let locomotive_node::Found { hash, end, stop, cycles, rig, .. } = found;
        Self { hash, end, stop, cycles, rig }
    }
}

fn reader(run: &Run, session: u16, expected: Option<u32>) -> BoardReader {
    let mut reader = BoardReader::NEW;
    let (reach_m, ahead_m) = (run.vehicle.reach_m(), run.speed_m_per_s * run.cycle_s());
    reader.begin(track::Terms { session, expected, reach_m, ahead_m });
    reader
}

fn server(run: &Run) -> Server<&[IrregularitySample]> {
    Server::of(&run.track.view().irregularity, Ways::One).unwrap()
}

/// The run with the whole track in memory.
fn in_memory(run: &Run) -> Found {
    let track = run.track.view();
    let line = hil_host::run::line(run, &track);
    let state = line.start(run.start.state.clone());
    let rig: RigNode = RigNode::new(&run.rig, NODE, Profile::Classical);
    let found = together(&line, state, terms(run, Pace::LockStep), rig, |_, _, _| true);
    let (hash, cycles) = (found.hash, found.cycles);
    Found { hash, end: found.end, stop: found.stop, cycles, rig: found.rig }
}

#[test]
fn a_track_by_message_gives_the_bits_of_the_track_in_memory() {
    let run = on_a_track_that_travels();
    let expected = in_memory(&run);
    assert_eq!(expected.end, End::Completed);
    for pace in [Pace::LockStep, Pace::Clock] {
        let mut server = TimedServer::new(server(&run));
        let fingerprint = server.server().identity().fingerprint;
        let mut reader = reader(&run, 7, Some(fingerprint));
        let found = session(&run, pace, &mut reader, |_, can| server.tick(can));
        assert_eq!(found, expected, "{pace:?}");
        let counts = server.server().counts();
        // It asks once a second whether this is still its track.
        assert_eq!((counts.offers, counts.repeated), (5, 0), "{counts:?}");
        // About a sample of 0.1 m for every 2.25 ms, and the window.
        let way = f64::from(expected.cycles as u32) * run.cycle_s() * run.speed_m_per_s / 0.1;
        let more = counts.samples as f64 - way;
        assert!((200.0..256.0).contains(&more), "{} samples over {way:.0}", counts.samples);
    }
}

#[test]
fn frames_that_are_lost_are_asked_for_again() {
    let run = on_a_track_that_travels();
    let expected = in_memory(&run);
    for (pace, every) in [(Pace::LockStep, 29), (Pace::Clock, 101)] {
        let mut server = server(&run);
        let mut sent = 0;
        let found = session(&run, pace, &mut reader(&run, 7, None), |_, can| {
            while let Some(frame) = receive(can) {
                server.hear(&frame);
            }
            server.tick();
            while let Some(frame) = server.take_frame() {
                sent += 1;
                if sent % every != 0 {
                    assert!(transmit(can, &frame));
                }
            }
        });
        assert_eq!(found, expected, "{pace:?}");
        assert!(server.counts().repeated > 0, "{:?}", server.counts());
    }
}

#[test]
fn a_server_that_falls_silent_stops_the_locomotive_where_its_window_ends() {
    let run = on_a_track_that_travels();
    for (pace, ticks) in [(Pace::Clock, 1), (Pace::LockStep, SILENCE_TICKS)] {
        let mut server = TimedServer::new(server(&run));
        let mut trackless = 0;
        let mut last = (0, 0);
        let found = session(&run, pace, &mut reader(&run, 7, None), |cycle, can| {
            if cycle < 1500 {
                server.tick(can);
            } else {
                // Its controller still takes in what nobody reads.
                while receive(can).is_some() {}
            }
            last = if last.0 == cycle { (cycle, last.1 + 1) } else { (cycle, 1) };
            trackless = trackless.max(last.1 * u32::from(cycle > 1500));
        });
        assert_eq!((found.end, found.rig), (End::Safe, RunState::Safe), "{pace:?}");
        let Some((cycle, Signal::Track)) = found.stop else { panic!("{found:?}") };
        // What it still had: the window less the vehicle between its wheels, 15 m.
        let way_m = (cycle - 1500) as f64 * run.cycle_s() * run.speed_m_per_s;
        assert!((8.5..=10.6).contains(&way_m), "{way_m} m after the last sample");
        assert_eq!(found.cycles, cycle + 1 + STOP_CYCLES);
        assert_eq!(trackless, ticks, "{pace:?}");
    }
}

#[test]
fn without_the_right_track_no_rig_is_armed() {
    let run = on_a_track_that_travels();
    let mut other = on_a_track_that_travels();
    other.track.samples.samples[1000].gauge_m += 1e-6;
    let mut fine = on_a_track_that_travels();
    fine.track.samples.step_m = 0.05;
    let right = server(&run).identity().fingerprint;
    let wrong = server(&other).identity().fingerprint;
    let refused = |tracks: &[&Run], expected| {
        let mut servers: Vec<_> = tracks.iter().map(|run| server(run)).collect();
        let found = session(&run, Pace::Clock, &mut reader(&run, 7, expected), |_, can| {
            while let Some(frame) = receive(can) {
                for server in &mut servers {
                    server.hear(&frame);
                }
            }
            for server in &mut servers {
                server.tick();
                while let Some(frame) = server.take_frame() {
                    assert!(transmit(can, &frame));
                }
            }
        });
        assert_eq!((found.cycles, found.rig), (0, RunState::Init), "{found:?}");
        found.end
    };
    let not_armed = |fault| End::NotArmed(NotArmed::Track(fault));
    assert_eq!(refused(&[], None), not_armed(TrackFault::NoServer));
    let another = TrackFault::AnotherTrack { found: wrong, expected: right };
    assert_eq!(refused(&[&other], Some(right)), not_armed(another));
    assert_eq!(refused(&[&run, &other], None), not_armed(TrackFault::TwoServers));
    // On a finer grid the window does not hold the vehicle.
    assert_eq!(refused(&[&fine], None), not_armed(TrackFault::Grid));
}

#[test]
fn samples_of_an_old_session_are_not_taken() {
    let run = on_a_track_that_travels();
    let mut server = server(&run);
    let is_sample =
        |frame: &Frame| matches!(MessageId::from_raw(frame.id()), Some(MessageId::TrackSample(_)));
    let mut log = Vec::new();
    session(&run, Pace::Clock, &mut reader(&run, 7, None), |_, can| {
        while let Some(frame) = receive(can) {
            server.hear(&frame);
        }
        server.tick();
        while let Some(frame) = server.take_frame() {
            assert!(transmit(can, &frame));
            log.push(frame);
        }
    });
    assert!(log.len() > 4000);
    // The server answers which track it has, and the log comes in the place of its samples.
    let mut played = log.iter().filter(|frame| is_sample(frame)).cycle();
    let found = session(&run, Pace::Clock, &mut reader(&run, 8, None), |_, can| {
        while let Some(frame) = receive(can) {
            server.hear(&frame);
        }
        server.tick();
        let mut plays = false;
        while let Some(frame) = server.take_frame() {
            let is_old = is_sample(&frame);
            plays |= is_old;
            assert!(is_old || transmit(can, &frame));
        }
        if plays {
            let frames: Vec<_> = played.by_ref().take(2).collect();
            assert!(frames.into_iter().all(|frame| transmit(can, frame)));
        }
    });
    assert_eq!(found.end, End::NotArmed(NotArmed::Track(TrackFault::NoSamples)));
}

#[test]
fn a_rig_in_standby_was_armed_without_a_track() {
    let run = on_a_track_that_travels();
    for pace in [Pace::LockStep, Pace::Clock] {
        let alone = |_: u64, can: &mut BusEnd<'_>| while receive(can).is_some() {};
        let found = session_with(&run, pace, &mut reader(&run, 7, None), alone, true);
        let fault = NotArmed::Track(TrackFault::NoServer);
        assert_eq!((found.end, found.cycles), (End::NotArmed(fault), 0), "{pace:?}");
        assert_eq!(found.rig, RunState::Standby);
        // One that comes late is waited for.
        let mut server = TimedServer::new(server(&run));
        let mut ticks = 0;
        let late = |_: u64, can: &mut BusEnd<'_>| {
            ticks += 1;
            if ticks > 290 {
                server.tick(can);
            } else {
                while receive(can).is_some() {}
            }
        };
        let found = session_with(&run, pace, &mut reader(&run, 7, None), late, true);
        assert_eq!((found.end, found.hash), (End::Completed, in_memory(&run).hash), "{pace:?}");
    }
}

#[test]
fn the_end_of_a_track_was_never_asked_for() {
    for spare in 0..17 {
        let mut run = on_a_track_that_travels();
        // It ends under the vehicle: behind it the rails are perfect.
        run.track.samples.samples.truncate(1000 + spare);
        let expected = in_memory(&run);
        assert_eq!(expected.end, End::Completed);
        let mut server = TimedServer::new(server(&run));
        let mut reader = reader(&run, 7, None);
        let found = session(&run, Pace::Clock, &mut reader, |_, can| server.tick(can));
        assert_eq!(found, expected, "{} samples", 1000 + spare);
    }
}

#[test]
fn a_vehicle_longer_than_the_locomotive_stands_on_its_whole_track() {
    let mut run = on_a_track_that_travels();
    for body in &mut run.vehicle.bodies {
        body.station_m *= 10.78 / 7.54;
    }
    assert!((run.vehicle.reach_m() - 10.78).abs() < 1e-9);
    let expected = in_memory(&run);
    let mut server = TimedServer::new(server(&run));
    let found = session(&run, Pace::Clock, &mut reader(&run, 7, None), |_, can| server.tick(can));
    assert_eq!((found.end, found.hash), (End::Completed, expected.hash));
    // Of 25 m between its wheels the window does not hold enough.
    for body in &mut run.vehicle.bodies {
        body.station_m *= 12.5 / 10.78;
    }
    let mut server = TimedServer::new(self::server(&run));
    let found = session(&run, Pace::Clock, &mut reader(&run, 7, None), |_, can| server.tick(can));
    assert_eq!(found.end, End::NotArmed(NotArmed::Track(TrackFault::Grid)));
}

#[test]
fn every_grid_that_is_accepted_can_be_run_on() {
    let mut ran = 0;
    for step_um in (60_000..=100_000_u32).step_by(2_500) {
        let mut run = on_a_track_that_travels();
        run.track.samples.step_m = f64::from(step_um) / 1e6;
        let mut server = TimedServer::new(server(&run));
        let mut reader = reader(&run, 7, None);
        let found = session(&run, Pace::Clock, &mut reader, |_, can| server.tick(can));
        let refused = End::NotArmed(NotArmed::Track(TrackFault::Grid));
        assert!(found.end == End::Completed || found.end == refused, "{step_um}: {found:?}");
        ran += u32::from(found.end == End::Completed);
    }
    assert!(ran > 5, "{ran} grids");
}

#[test]
fn a_server_that_is_started_anew_with_another_track_is_found_out_within_a_second() {
    let run = on_a_track_that_travels();
    let mut other = on_a_track_that_travels();
    other.track.samples.samples[1000].gauge_m += 1e-6;
    for pace in [Pace::Clock, Pace::LockStep] {
        let [mut first, mut second] = [&run, &other].map(|run| TimedServer::new(server(run)));
        let mut reader = reader(&run, 7, None);
        let found = session(&run, pace, &mut reader, |cycle, can| {
            if cycle < 1500 { first.tick(can) } else { second.tick(can) }
        });
        assert_eq!(found.end, End::Safe, "{found:?}");
        let Some((cycle, Signal::Track)) = found.stop else { panic!("{found:?}") };
        assert!((1500..2500).contains(&cycle), "{cycle}");
    }
}

#[test]
fn a_vehicle_that_is_faster_than_its_samples_come_is_not_armed() {
    let mut run = on_a_track_that_travels();
    run.speed_m_per_s = 95.0;
    let mut server = TimedServer::new(server(&run));
    let found = session(&run, Pace::Clock, &mut reader(&run, 7, None), |_, can| server.tick(can));
    assert_eq!(found.end, End::NotArmed(NotArmed::Track(TrackFault::TooFast)));
}

/// How far a rounded track moves the command of the rig from that on the track as it is.
#[test]
fn rounding_to_ten_nanometres_moves_the_rig_by_less_than_its_converters_see() {
    let (exact, rounded) = (scenario(), on_a_track_that_travels());
    let commands = |run: &Run| {
        let track = run.track.view();
        let line = hil_host::run::line(run, &track);
        let state = line.start(run.start.state.clone());
        let rig: RigNode = RigNode::new(&run.rig, NODE, Profile::Classical);
        let mut commands = Vec::new();
        together(&line, state, terms(run, Pace::LockStep), rig, |_, node, _| {
            commands.push(node.state().slots[0].command.displacement_m);
            true
        });
        commands
    };
    let (exact, rounded): (Vec<f64>, Vec<f64>) = (commands(&exact), commands(&rounded));
    let furthest = exact.iter().zip(&rounded).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let stroke = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    println!("{furthest:e} m of {stroke:e} m");
    assert!(exact.len() == rounded.len() && furthest > 0.0);
    assert!(furthest < 1e-6 && stroke > 0.5e-3, "{furthest:e} m of {stroke:e} m");
}
