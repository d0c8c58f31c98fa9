//! `yawbench track-server`: the whole track, for a locomotive on a board that has no memory for it.
//!
//! The node is [`nodes::track::Server`]; here it has a process, a clock and a bus. It answers
//! whoever asks, a sample per millisecond at most, and prints once a second how far it is. Nothing
//! here moves a rig: a server that is late or gone stops a locomotive, which says so itself.

mod long_track;

use crate::BenchError;
use crate::bus::{Bus, BusCounters, BusError, Sent, SerialLineBus, SocketCanBus};
use crate::clock::Pacer;
use crate::control::NoStretch;
use can_protocol::{MessageId, Profile};
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
    let identity = Identity::of(&track.irregularity, ways).map_err(refused)?;
    let mut server = Server::new(identity, LongTrack::new(run));
    let Identity { fingerprint, step_um, samples, .. } = identity;
    let length_km = f64::from(samples) * f64::from(step_um) / 1e9;
    let shape = if ways == Ways::ThereAndBack { ", there and back" } else { "" };
    files::say!("track {fingerprint:08x}, {length_km:.1} km{shape}: waiting for a locomotive");
    let (is_down, skipped, bus) = match line {
        Line::Can(interface) => {
            let heard = [MessageId::TrackRequest];
            let mut bus = SocketCanBus::open(interface, &heard, Profile::Classical)?;
            serve(&mut server, &mut bus, |_| stop.load(Ordering::Relaxed))
        }
        Line::Serial(path) => {
            let mut bus = SerialLineBus::connect(path)?;
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
    let (mut pending, mut is_down) = (None, false);
    let cannot_go_on = |server: &Server<LongTrack<'_>>| {
        server.source().has_failed() || server.unsendable().is_some()
    };
    while !is_over(bus) && !is_down && !cannot_go_on(server) {
        pacer.wait();
        while let Some(frame) = bus.receive() {
            server.hear(&frame);
        }
        server.tick();
        while let Some(frame) = pending.take().or_else(|| server.take_frame()) {
            match bus.send(&frame) {
                Sent::Away => {}
                Sent::Dropped => {
                    // The next tick tries again.
                    pending = Some(frame);
                    break;
                }
                Sent::Down => {
                    is_down = true;
                    break;
                }
            }
        }
        if printed.elapsed() >= Duration::from_secs(1) && server.counts() != said {
            (printed, said) = (Instant::now(), server.counts());
            let Counts { samples, repeated, end, .. } = said;
            files::say!("sample {end}, sent {samples}, again {repeated}");
        }
    }
    (is_down, pacer.skipped(), bus.counters())
}

/// The account of a server in one line.
pub fn summary_text(summary: &TrackSummary) -> String {
    let TrackSummary { fingerprint, offers, requests, samples, repeated, .. } = summary;
    format!(
        "track {fingerprint}: asked for {offers} times, {samples} samples sent in {requests} \
         requests, {repeated} of them again; frames dropped {} out and {} in, {} ticks missed",
        summary.send_dropped, summary.receive_dropped, summary.skipped
    )
}
