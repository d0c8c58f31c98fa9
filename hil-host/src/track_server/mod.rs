//! `yawbench track-server`: the whole track, for a locomotive on a board that has no memory for it.
//!
//! The node is [`nodes::track::Server`]; here it has a process, a clock and a bus. It answers
//! whoever asks, a sample per millisecond at most, and prints once a minute how far it is. Nothing
//! here moves a rig: a server that is late or gone stops a locomotive, which says so itself.

mod long_track;

use crate::BenchError;
use crate::bus::{Bus, BusCounters, BusError, Sent, SerialLineBus, SocketCanBus};
use crate::clock::Pacer;
use crate::control::NoStretch;
use can_protocol::{MessageId, Profile};
use firmware_core::track::Layout;
use long_track::LongTrack;
pub use nodes::track::Ways;
use nodes::track::{Counts, Identity, Server, Unservable};
use scenario::run::Run;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Real time of a tick.
const TICK: Duration = Duration::from_millis(1);

/// Above this a vehicle runs over samples of 0.1 m faster than they are sent and some repeated.
const FASTEST_M_PER_S: f64 = 90.0;

/// What the server is connected to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Line {
    /// A CAN interface.
    Can(String),
    /// A serial line, by its Unix socket; the server ends with it.
    Serial(PathBuf),
}

/// What a server has done.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TrackSummary {
    /// Fingerprint of its track, as in the DBC.
    pub fingerprint: String,
    /// How often it was asked which track it has.
    pub offers: u64,
    /// How often it was asked for samples.
    pub requests: u64,
    /// Samples sent.
    pub samples: u64,
    /// Samples among them that it had sent before.
    pub repeated: u64,
    /// Frames that the bus did not take.
    pub send_dropped: u64,
    /// Frames that the kernel lost on the way in.
    pub receive_dropped: u64,
    /// Ticks that its clock missed.
    pub skipped: u64,
}

/// Serves the irregularity of a scenario until `stop`, or until its serial line is closed.
///
/// # Errors
/// A grid or a sample that does not travel; the interface or the line cannot be used; the next
/// stretch of the track is not made.
pub fn run_on(
    (scenario, run): (&Path, &Run),
    ways: Ways,
    line: &Line,
    stop: &AtomicBool,
) -> Result<TrackSummary, BenchError> {
    let refused = |why: Unservable| BenchError::Kept {
        file: scenario.to_owned(),
        found: why.to_string(),
        expected: why.expected(),
    };
    let track = run.track.view();
    if track.layout != Layout::tangent() {
        let (file, found) = (scenario.to_owned(), "a track with curves".to_owned());
        let expected = "a straight one: only irregularity travels";
        return Err(BenchError::Kept { file, found, expected });
    }
    if run.speed_m_per_s > FASTEST_M_PER_S {
        let found = format!("{:.0} km/h", 3.6 * run.speed_m_per_s);
        let expected = "at most 324 km/h: a sample is sent in a millisecond";
        return Err(BenchError::Kept { file: scenario.to_owned(), found, expected });
    }
    let identity = Identity::of(&track.irregularity, ways).map_err(refused)?;
    let mut server = Server::new(identity, LongTrack::new(run));
    let Identity { fingerprint, step_um, samples, .. } = identity;
    let length_km = f64::from(samples) * f64::from(step_um) / 1e9;
    let shape = if ways == Ways::ThereAndBack { ", there and back" } else { "" };
    let waiting =
        format!("track {fingerprint:08x}, {length_km:.1} km{shape}: waiting for a locomotive");
    let (is_down, skipped, bus) = match line {
        Line::Can(interface) => {
            let heard = [MessageId::TrackRequest];
            let mut bus = SocketCanBus::open(interface, &heard, Profile::Classical)?;
            files::say!("{waiting}");
            serve(&mut server, &mut bus, |_| stop.load(Ordering::Relaxed))
        }
        Line::Serial(path) => {
            let mut bus = SerialLineBus::connect(path)?;
            files::say!("{waiting}");
            let is_over = |bus: &SerialLineBus| bus.is_closed() || stop.load(Ordering::Relaxed);
            serve(&mut server, &mut bus, is_over)
        }
    };
    if server.source().has_failed() {
        return Err(NoStretch.into());
    }
    if let Some(number) = server.unsendable() {
        return Err(refused(Unservable::Sample { number: number as usize }));
    }
    if is_down && let Line::Can(interface) = line {
        return Err(BusError::Down { interface: interface.clone() }.into());
    }
    let Counts { offers, requests, samples, repeated, .. } = server.counts();
    Ok(TrackSummary {
        fingerprint: format!("{fingerprint:08x}"),
        offers,
        requests,
        samples,
        repeated,
        send_dropped: bus.send_dropped,
        receive_dropped: bus.receive_dropped,
        skipped,
    })
}

/// The loop; whether the bus is down, the ticks that its clock missed, and what went over the bus.
fn serve<B: Bus>(
    server: &mut Server<LongTrack<'_>>,
    bus: &mut B,
    is_over: impl Fn(&B) -> bool,
) -> (bool, u64, BusCounters) {
    let mut pacer = Pacer::every(TICK);
    let (mut printed, mut said) = (Instant::now(), server.counts());
    let mut is_down = false;
    let cannot_go_on = |server: &Server<LongTrack<'_>>| {
        server.source().has_failed() || server.unsendable().is_some()
    };
    while !is_over(bus) && !is_down && !cannot_go_on(server) {
        pacer.wait();
        while let Some(frame) = bus.receive() {
            server.hear(&frame);
        }
        server.tick();
        while let Some(frame) = server.take_frame() {
            match bus.send(&frame) {
                Sent::Away => {}
                Sent::Dropped => {
                    server.put_back(frame);
                    break;
                }
                Sent::Down => {
                    is_down = true;
                    break;
                }
            }
        }
        let counts = server.counts();
        // Nothing new is said once a minute, whatever went wrong at once.
        let is_smooth = counts.repeated == said.repeated && said.samples > 0;
        let pause = Duration::from_secs(if is_smooth { 60 } else { 1 });
        if printed.elapsed() >= pause && counts != said {
            (printed, said) = (Instant::now(), counts);
            let Counts { offers, samples, repeated, end, .. } = said;
            if samples == 0 {
                files::say!("asked {offers} times which track this is, and for no sample of it");
            } else {
                files::say!("at sample {end}, {repeated} sent again");
            }
        }
    }
    (is_down, pacer.skipped(), bus.counters())
}

/// The account of a server in one line.
pub fn summary_text(summary: &TrackSummary) -> String {
    let TrackSummary { fingerprint, offers, requests, samples, repeated, .. } = summary;
    format!(
        "track {fingerprint}: asked {offers} times which it is; {samples} samples sent in \
         {requests} requests, {repeated} of them again; {} times no room on the bus, {} frames lost \
         on the way in",
        summary.send_dropped, summary.receive_dropped
    )
}
