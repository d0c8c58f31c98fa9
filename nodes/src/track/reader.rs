//! The locomotive's end: asks for the track ahead, and keeps what the vehicle stands on.
//!
//! ```text
//! Asking -> Reading
//!       \-> Failed: nobody answers, or the answer is not the track that is expected
//! ```
//!
//! While it reads it asks for a sixteenth of the window as soon as there is room for it, and again
//! for whatever has not come in 20 ticks, on a slow bus in up to 60. Once a second it asks once
//! more which track this is: a server that was started anew with another one is found out. A sample
//! is taken in its place or not at all.

use super::identity::{Identity, Ways};
use crate::WireFrame;
use can_protocol::{
    Frame, MessageId, TrackItem, TrackOffer, TrackPart, TrackRequest, TrackSample, TrackSeal,
};
use firmware_core::track::{Irregularity, IrregularitySample, Window};

/// Ticks after which a question or request is repeated.
const REPEAT_TICKS: u32 = 20;

/// Ticks in which a server has to say which track it has: five seconds at 1 kHz.
const ANSWER_TICKS: u32 = 5000;

/// Ticks in which the first window has to be full.
const FILL_TICKS: u32 = 5000;

/// Ticks between two questions for the track while it is read: a second at 1 kHz.
const CHECK_TICKS: u32 = 1000;

/// Longest wait before a request is repeated, whatever answers took: a quarter of what is ahead of
/// the SS9 at 160 km/h.
const REPEAT_TICKS_MAX: u32 = 60;

/// Samples of a window that its vehicle cannot stand on: what is asked for at once, and the four
/// around each end.
const fn spare(samples: usize) -> usize {
    samples / 16 + 8
}

/// What a reader is told before it begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Terms {
    /// The number of this session, which nobody can foresee on a real bus.
    pub session: u16,
    /// Fingerprint of the only track that will do; none where any does.
    pub expected: Option<u32>,
    /// [Reach](firmware_core::vehicle::Vehicle::reach_m) of the vehicle (m).
    pub reach_m: f64,
    /// Way of the vehicle in a tick (m).
    pub ahead_m: f64,
}

/// What is wrong with the track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrackFault {
    /// No server has answered.
    NoServer,
    /// The server has another track than the one expected.
    AnotherTrack {
        /// Its fingerprint.
        found: u32,
        /// That of the track expected.
        expected: u32,
    },
    /// Two servers answer with different tracks, or one was started anew with another.
    TwoServers,
    /// A grid on which the window does not hold the vehicle.
    Grid,
    /// The vehicle runs over more samples in a tick than a server sends.
    TooFast,
    /// Its samples do not come, or all fail their seal.
    NoSamples,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    /// Which track is it? The values of the items that have been answered.
    Asking([Option<u32>; TrackItem::ALL.len()]),
    /// Samples of this track are taken.
    Reading(Identity),
    Failed(TrackFault),
}

/// A window of `N` samples on a track that comes by messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Reader<const N: usize> {
    window: Window<N>,
    phase: Phase,
    terms: Terms,
    /// The sample that comes next, and its first half.
    next: u32,
    centre_line_m: Option<[f64; 2]>,
    /// Number behind the last sample asked for.
    asked: u32,
    /// Ticks of this phase, and since the last sample or request.
    ticks: u32,
    waited_ticks: u32,
    /// Ticks since the last request, and how long the slowest first answer to one took.
    since_request: Option<u32>,
    slowest_ticks: u32,
    /// Whether the window has been full once.
    has_begun: bool,
    frame: Option<Frame>,
}

impl<const N: usize> Reader<N> {
    /// A reader that has not asked yet.
    pub const NEW: Self = Self {
        window: Window::new(0, 0.0, 1.0),
        phase: Phase::Asking([None; TrackItem::ALL.len()]),
        terms: Terms { session: 0, expected: None, reach_m: 0.0, ahead_m: 0.0 },
        next: 0,
        centre_line_m: None,
        asked: 0,
        ticks: 0,
        waited_ticks: 0,
        since_request: None,
        slowest_ticks: 0,
        has_begun: false,
        frame: None,
    };

    /// Begins a session.
    pub fn begin(&mut self, terms: Terms) {
        const { assert!(N >= 64 && N <= 4096, "a window of 64 to 4096 samples") };
        debug_assert!(terms.reach_m >= 0.0 && terms.ahead_m >= 0.0, "{terms:?}");
        self.window.restart(0, 0.0, 1.0);
        self.phase = Phase::Asking([None; TrackItem::ALL.len()]);
        self.terms = terms;
        (self.next, self.asked, self.centre_line_m) = (0, 0, None);
        (self.ticks, self.waited_ticks, self.has_begun) = (0, 0, false);
        (self.since_request, self.slowest_ticks, self.frame) = (None, 0, None);
    }

    /// Takes in any frame of the bus.
    pub fn hear(&mut self, frame: &WireFrame) {
        if let Ok(offer) = TrackOffer::decode(frame.id(), frame.data()) {
            if offer.session == self.terms.session {
                self.hear_offer(offer);
            }
        } else if let Phase::Reading(track) = self.phase {
            self.hear_sample(frame, track.fingerprint);
        }
    }

    fn hear_offer(&mut self, offer: TrackOffer) {
        self.phase = match self.phase {
            Phase::Asking(answered) => self.answered(answered, offer),
            // Of a second server, or of one that was started anew with another track.
            Phase::Reading(track) if offer.value != track.value(offer.item) => {
                Phase::Failed(TrackFault::TwoServers)
            }
            phase => phase,
        };
    }

    /// What comes of an answer, besides those that were there.
    fn answered(
        &mut self,
        mut answered: [Option<u32>; TrackItem::ALL.len()],
        offer: TrackOffer,
    ) -> Phase {
        let place = answered.get_mut(usize::from(offer.item.code()));
        let before = place.and_then(|place| place.replace(offer.value));
        if before.is_some_and(|before| before != offer.value) {
            return Phase::Failed(TrackFault::TwoServers);
        }
        let [Some(first), Some(step_um), Some(samples), Some(ways), Some(fingerprint)] = answered
        else {
            return Phase::Asking(answered);
        };
        let first_um = first as i32;
        match Ways::of(ways) {
            Some(ways) => self.judge(&Identity { first_um, step_um, samples, ways, fingerprint }),
            None => Phase::Failed(TrackFault::Grid),
        }
    }

    /// Takes up a track, or refuses it.
    fn judge(&mut self, track: &Identity) -> Phase {
        let found = track.fingerprint;
        if let Some(expected) = self.terms.expected.filter(|expected| *expected != found) {
            return Phase::Failed(TrackFault::AnotherTrack { found, expected });
        }
        let (first_m, step_m) = track.grid_m();
        let Terms { reach_m, ahead_m, .. } = self.terms;
        let held_m = N.saturating_sub(spare(N)) as f64 * step_m;
        if track.samples < 4 || step_m <= 0.0 || held_m < 2.0 * reach_m + ahead_m {
            return Phase::Failed(TrackFault::Grid);
        }
        // A server sends a sample in a tick, and some more than once.
        if ahead_m > 0.9 * step_m {
            return Phase::Failed(TrackFault::TooFast);
        }
        let total = match track.ways {
            Ways::One => track.samples as usize,
            Ways::ThereAndBack => usize::MAX,
        };
        self.window.restart(total, first_m, step_m);
        (self.ticks, self.waited_ticks) = (0, 0);
        Phase::Reading(*track)
    }

    fn hear_sample(&mut self, frame: &WireFrame, fingerprint: u32) {
        // Before the first request it has none to expect.
        let is_sample = matches!(MessageId::from_raw(frame.id()), Some(MessageId::TrackSample(_)));
        if !is_sample || self.ticks == 0 {
            return;
        }
        let (seal, next) = (TrackSeal::new(self.terms.session, fingerprint), self.next);
        let Ok(half) = TrackSample::decode_sealed(frame.id(), frame.data(), seal, next) else {
            return;
        };
        let ([Some(first_m), Some(second_m)], true) =
            (half.channels_m, half.number == self.next as u8)
        else {
            return;
        };
        if let Some(ticks) = self.since_request.take() {
            self.slowest_ticks = self.slowest_ticks.max(ticks.min(REPEAT_TICKS_MAX));
        }
        match half.part {
            TrackPart::CentreLine => self.centre_line_m = Some([first_m, second_m]),
            TrackPart::Rails => {
                let Some([vertical_m, alignment_m]) = self.centre_line_m.take() else { return };
                let sample = IrregularitySample {
                    vertical_m,
                    alignment_m,
                    cross_level_m: first_m,
                    gauge_m: second_m,
                };
                if self.window.push(sample) {
                    (self.next, self.waited_ticks) = (self.next.saturating_add(1), 0);
                }
            }
        }
    }

    /// One tick with the vehicle at `at_m`: whether the window holds all that its wheels will stand
    /// on in it.
    pub fn tick(&mut self, at_m: f64) -> bool {
        self.ticks = self.ticks.saturating_add(1);
        self.waited_ticks = self.waited_ticks.saturating_add(1);
        self.since_request = self.since_request.map(|ticks| ticks.saturating_add(1));
        match self.phase {
            Phase::Asking(_) => {
                if self.ticks > ANSWER_TICKS {
                    self.phase = Phase::Failed(TrackFault::NoServer);
                } else if self.ticks % REPEAT_TICKS == 1 {
                    self.ask_which();
                }
                false
            }
            Phase::Reading(_) => {
                let Terms { reach_m, ahead_m, .. } = self.terms;
                if self.ticks == 1 {
                    let first = self.window.begin_at(at_m - reach_m);
                    self.next = u32::try_from(first).unwrap_or(u32::MAX);
                    self.asked = self.next;
                }
                self.window.pass(at_m - reach_m);
                let has_track = self.window.reaches(at_m + reach_m + ahead_m);
                if self.ticks.is_multiple_of(CHECK_TICKS) {
                    self.ask_which();
                } else {
                    self.ask_ahead(has_track);
                }
                // It begins with all that it can hold.
                self.has_begun |= has_track && self.window.room() == 0;
                if !self.has_begun && self.ticks > FILL_TICKS {
                    self.phase = Phase::Failed(TrackFault::NoSamples);
                }
                has_track && self.has_begun
            }
            Phase::Failed(_) => false,
        }
    }

    /// Asks for what there is room for, when it is due.
    fn ask_ahead(&mut self, has_track: bool) {
        let room = self.window.room();
        let is_owed = self.next < self.asked;
        let is_enough = room >= N / 16 || room == self.window.missing();
        let repeat_ticks = (2 * self.slowest_ticks).clamp(REPEAT_TICKS, REPEAT_TICKS_MAX);
        let is_due = if is_owed {
            self.waited_ticks >= repeat_ticks
        } else {
            is_enough || !has_track || !self.has_begun
        };
        if room > 0 && is_due {
            let count = room.min(usize::from(u8::MAX)) as u8;
            self.send(count);
            (self.asked, self.waited_ticks) = (self.next.saturating_add(u32::from(count)), 0);
            self.since_request = Some(0);
        }
    }

    fn ask_which(&mut self) {
        self.send(0);
    }

    fn send(&mut self, count: u8) {
        let request = TrackRequest { session: self.terms.session, first: self.next, count };
        self.frame = Some(request.encode());
    }

    /// The next frame to send.
    pub fn take_frame(&mut self) -> Option<Frame> {
        self.frame.take()
    }

    /// The stretch that it holds.
    pub fn view(&self) -> Irregularity<'_> {
        self.window.view()
    }

    /// Why there is no track to begin on; none while there may be one.
    pub fn fault(&self) -> Option<TrackFault> {
        match self.phase {
            Phase::Failed(fault) => Some(fault),
            _ => None,
        }
    }
}
