//! The locomotive's end: asks for the track ahead, and keeps what the vehicle stands on.
//!
//! ```text
//! Asking -> Reading
//!       \-> Failed: nobody answers, or the answer is not the track that is expected
//! ```
//!
//! While it reads it asks for a sixteenth of the window as soon as there is room for it, and again
//! for whatever has not come in 20 ticks. A sample is taken in its place or not at all.

use super::REACH_M;
use super::identity::{Identity, Ways};
use crate::WireFrame;
use can_protocol::{Frame, MessageId, TrackItem, TrackOffer, TrackPart, TrackRequest, TrackSample};
use firmware_core::track::{Irregularity, IrregularitySample, Window};

/// Ticks after which a question or request is repeated.
const REPEAT_TICKS: u32 = 20;

/// Ticks in which a server has to say which track it has: five seconds at 1 kHz.
const ANSWER_TICKS: u32 = 5000;

/// Ticks in which the first window has to be full.
const FILL_TICKS: u32 = 5000;

/// Why there is no track to begin on.
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
    /// Two servers answer, with different tracks.
    TwoServers,
    /// A grid on which no vehicle can run.
    Grid,
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
    /// Fingerprint of the only track that will do; none where any does.
    expected: Option<u32>,
    /// The number that was drawn, which offers carry, and that of the session, which seals samples.
    drawn: u16,
    session: u16,
    /// The sample that comes next, and its first half.
    next: u32,
    centre_line_m: Option<[f64; 2]>,
    /// Number behind the last sample asked for.
    asked: u32,
    /// Ticks of this phase, and since the last sample or request.
    ticks: u32,
    waited_ticks: u32,
    /// Whether the window has been full once.
    has_begun: bool,
    frame: Option<Frame>,
}

impl<const N: usize> Reader<N> {
    /// A reader that has not asked yet.
    pub const NEW: Self = Self {
        window: Window::new(0, 0.0, 1.0),
        phase: Phase::Asking([None; TrackItem::ALL.len()]),
        expected: None,
        drawn: 0,
        session: 0,
        next: 0,
        centre_line_m: None,
        asked: 0,
        ticks: 0,
        waited_ticks: 0,
        has_begun: false,
        frame: None,
    };

    /// Begins a session under a number that nobody can foresee on a real bus; with `expected` on
    /// the track with this fingerprint and no other.
    pub fn begin(&mut self, drawn: u16, expected: Option<u32>) {
        self.window.restart(0, 0.0, 1.0);
        self.phase = Phase::Asking([None; TrackItem::ALL.len()]);
        (self.drawn, self.session, self.expected) = (drawn, drawn, expected);
        (self.next, self.asked, self.centre_line_m) = (0, 0, None);
        (self.ticks, self.waited_ticks, self.has_begun) = (0, 0, false);
        self.frame = None;
    }

    /// Takes in any frame of the bus.
    pub fn hear(&mut self, frame: &WireFrame) {
        match self.phase {
            Phase::Asking(answered) => self.hear_offer(frame, answered),
            Phase::Reading(track) => {
                self.hear_sample(frame, track.fingerprint);
                self.hear_another(frame, &track);
            }
            Phase::Failed(_) => {}
        }
    }

    /// The offer of a second server, which comes behind that of the first.
    fn hear_another(&mut self, frame: &WireFrame, track: &Identity) {
        let Ok(offer) = TrackOffer::decode(frame.id(), frame.data()) else { return };
        let is_other = offer.session == self.drawn && offer.value != track.value(offer.item);
        if is_other && !self.has_begun {
            self.phase = Phase::Failed(TrackFault::TwoServers);
        }
    }

    fn hear_offer(&mut self, frame: &WireFrame, answered: [Option<u32>; TrackItem::ALL.len()]) {
        let Ok(offer) = TrackOffer::decode(frame.id(), frame.data()) else { return };
        if offer.session != self.drawn {
            return;
        }
        let mut answered = answered;
        let Some(place) = answered.get_mut(usize::from(offer.item.code())) else { return };
        if place.replace(offer.value).is_some_and(|before| before != offer.value) {
            self.phase = Phase::Failed(TrackFault::TwoServers);
            return;
        }
        self.phase = match answered {
            [Some(first), Some(step_um), Some(samples), Some(ways), Some(fingerprint)] => {
                let first_um = first as i32;
                match Ways::of(ways) {
                    Some(ways) => {
                        self.judge(&Identity { first_um, step_um, samples, ways, fingerprint })
                    }
                    None => Phase::Failed(TrackFault::Grid),
                }
            }
            _ => Phase::Asking(answered),
        };
    }

    /// Takes up a track, or refuses it.
    fn judge(&mut self, track: &Identity) -> Phase {
        let found = track.fingerprint;
        if let Some(expected) = self.expected.filter(|expected| *expected != found) {
            return Phase::Failed(TrackFault::AnotherTrack { found, expected });
        }
        let (first_m, step_m) = track.grid_m();
        let holds_vehicle = N.saturating_sub(4) as f64 * step_m > 2.0 * REACH_M;
        if track.samples < 4 || step_m <= 0.0 || !holds_vehicle {
            return Phase::Failed(TrackFault::Grid);
        }
        let total = match track.ways {
            Ways::One => track.samples as usize,
            Ways::ThereAndBack => usize::MAX,
        };
        self.window.restart(total, first_m, step_m);
        self.session = TrackRequest::session(self.drawn, found);
        (self.ticks, self.waited_ticks) = (0, REPEAT_TICKS);
        Phase::Reading(*track)
    }

    fn hear_sample(&mut self, frame: &WireFrame, fingerprint: u32) {
        // Before the first request it has none to expect.
        let is_sample = matches!(MessageId::from_raw(frame.id()), Some(MessageId::TrackSample(_)));
        if !is_sample || self.ticks == 0 {
            return;
        }
        let seal = TrackRequest::seal(self.session, fingerprint, self.next);
        let Ok(half) = TrackSample::decode_sealed(frame.id(), frame.data(), seal) else { return };
        let ([Some(first_m), Some(second_m)], true) =
            (half.channels_m, half.number == self.next as u8)
        else {
            return;
        };
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

    /// One tick with the vehicle at `at_m` and `ahead_m` to go in it: whether the window holds all
    /// that its wheels will stand on.
    pub fn tick(&mut self, at_m: f64, ahead_m: f64) -> bool {
        self.ticks = self.ticks.saturating_add(1);
        self.waited_ticks = self.waited_ticks.saturating_add(1);
        match self.phase {
            Phase::Asking(_) => {
                if self.ticks > ANSWER_TICKS {
                    self.phase = Phase::Failed(TrackFault::NoServer);
                } else if self.ticks % REPEAT_TICKS == 1 {
                    self.ask(0);
                }
                false
            }
            Phase::Reading(_) => {
                if self.ticks == 1 {
                    let first = self.window.begin_at(at_m - REACH_M);
                    self.next = u32::try_from(first).unwrap_or(u32::MAX);
                    self.asked = self.next;
                }
                self.window.pass(at_m - REACH_M);
                self.ask_ahead();
                let has_track = self.window.reaches(at_m + REACH_M + ahead_m);
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
    fn ask_ahead(&mut self) {
        let room = self.window.room().min(usize::from(u8::MAX)) as u8;
        let is_owed = self.next < self.asked;
        let has_much_room = usize::from(room) >= N / 16 || !self.has_begun;
        let is_due = if is_owed { self.waited_ticks >= REPEAT_TICKS } else { has_much_room };
        if room > 0 && is_due {
            self.ask(room);
        }
    }

    fn ask(&mut self, count: u8) {
        self.frame = Some(TrackRequest { session: self.session, first: self.next, count }.encode());
        (self.asked, self.waited_ticks) = (self.next.saturating_add(u32::from(count)), 0);
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
