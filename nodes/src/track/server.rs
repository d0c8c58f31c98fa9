//! The track server: the node that has the whole track.

use super::identity::{Identity, Unservable, Ways, as_sent, channels};
use crate::WireFrame;
use can_protocol::{Frame, TrackItem, TrackOffer, TrackPart, TrackRequest, TrackSample, TrackSeal};
use firmware_core::track::{Irregularity, IrregularitySample};
use heapless::Deque;

/// Frames that wait to be taken: an offer, or the samples of a tick.
const FRAMES: usize = 8;

/// Where a server has its samples from.
pub trait Source {
    /// The sample at a place of the track, one way; none where it is not there yet. Never waits.
    fn sample(&mut self, place: u32) -> Option<IrregularitySample>;
}

impl Source for &[IrregularitySample] {
    fn sample(&mut self, place: u32) -> Option<IrregularitySample> {
        self.get(place as usize).copied()
    }
}

/// Serves one locomotive at a time: whoever asked last.
#[derive(Debug, Clone)]
pub struct Server<S> {
    source: S,
    identity: Identity,
    /// The session of the last request, and the samples that it asked for and did not get yet.
    session: u16,
    wanted: core::ops::Range<u32>,
    frames: Deque<Frame, FRAMES>,
    counts: Counts,
    unsendable: Option<u32>,
}

/// What a server has done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Questions for the track.
    pub offers: u64,
    /// Requests for samples.
    pub requests: u64,
    /// Samples sent.
    pub samples: u64,
    /// Samples sent again.
    pub repeated: u64,
    /// Number behind the furthest sample sent.
    pub end: u32,
}

impl<'a> Server<&'a [IrregularitySample]> {
    /// A server of a track that is in memory.
    ///
    /// # Errors
    /// A grid or a sample that cannot travel.
    pub fn of(track: &Irregularity<'a>, ways: Ways) -> Result<Self, Unservable> {
        debug_assert!(track.behind == 0, "{} samples are not in memory", track.behind);
        Ok(Self::new(Identity::of(track, ways)?, track.samples))
    }
}

impl<S: Source> Server<S> {
    /// A server of a track, with its samples.
    pub fn new(identity: Identity, source: S) -> Self {
        Self {
            source,
            identity,
            session: 0,
            wanted: 0..0,
            frames: Deque::new(),
            counts: Counts::default(),
            unsendable: None,
        }
    }

    /// Place of a sample that was asked for and does not travel.
    pub fn unsendable(&self) -> Option<u32> {
        self.unsendable
    }

    /// Where it has its samples from.
    pub fn source(&self) -> &S {
        &self.source
    }

    /// The track that it has.
    pub fn identity(&self) -> Identity {
        self.identity
    }

    /// What it has done.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes in any frame of the bus.
    pub fn hear(&mut self, frame: &WireFrame) {
        let Ok(request) = TrackRequest::decode(frame.id(), frame.data()) else { return };
        let TrackRequest { session, first, count } = request;
        if session != self.session {
            // Another locomotive, or one that has started again.
            (self.session, self.counts.end, self.wanted) = (session, 0, 0..0);
        }
        if count == 0 {
            self.offer();
        } else {
            self.counts.requests += 1;
            let end = first.saturating_add(u32::from(count));
            let end = match self.identity.ways {
                Ways::One => end.min(self.identity.samples),
                Ways::ThereAndBack => end,
            };
            self.wanted = first.min(end)..end;
        }
    }

    fn offer(&mut self) {
        self.counts.offers += 1;
        for item in TrackItem::ALL {
            let value = self.identity.value(item);
            let offer = TrackOffer { session: self.session, item, value };
            // Full only where nobody takes the frames; the locomotive asks again.
            let _full = self.frames.push_back(offer.encode());
        }
    }

    /// One tick: the next sample that is wanted. One per millisecond is enough up to 324 km/h on a
    /// grid of 0.1 m, and leaves the bus to the rigs.
    pub fn tick(&mut self) {
        if self.frames.len() + TrackPart::ALL.len() > FRAMES {
            return;
        }
        let number = self.wanted.start;
        if self.wanted.is_empty() {
            return;
        }
        // One that is still being made goes out later.
        let Some(sample) = self.sample(number) else { return };
        self.wanted.start = number.saturating_add(1);
        let [vertical_m, alignment_m, cross_level_m, gauge_m] = channels(&sample);
        let seal = TrackSeal::new(self.session, self.identity.fingerprint);
        for (part, [first_m, second_m]) in [
            (TrackPart::CentreLine, [vertical_m, alignment_m]),
            (TrackPart::Rails, [cross_level_m, gauge_m]),
        ] {
            let channels_m = [Some(first_m), Some(second_m)];
            let half = TrackSample { part, number: number as u8, channels_m };
            let (frame, saturated) = half.encode_sealed(seal, number);
            debug_assert!(saturated.is_empty(), "sample {number} does not travel");
            let _full = self.frames.push_back(frame);
        }
        self.counts.samples += 1;
        self.counts.repeated += u64::from(number < self.counts.end);
        self.counts.end = self.counts.end.max(number.saturating_add(1));
    }

    /// The next frame to send.
    pub fn take_frame(&mut self) -> Option<Frame> {
        self.frames.pop_front()
    }

    /// Takes back the frame that was taken last and found no room: the next tick tries again, since
    /// a controller may have fewer mailboxes than an offer has frames.
    pub fn put_back(&mut self, frame: Frame) {
        let is_full = self.frames.push_front(frame).is_err();
        debug_assert!(!is_full, "a frame that was not taken");
    }

    /// A sample of the track as it travels.
    fn sample(&mut self, number: u32) -> Option<IrregularitySample> {
        let place = match self.identity.ways {
            Ways::One => number,
            Ways::ThereAndBack => there_and_back(number, self.identity.samples),
        };
        let sample = self.source.sample(place)?;
        let sent = as_sent(&sample);
        if sent.is_none() {
            self.unsendable = Some(place);
        }
        sent
    }
}

/// Number of the sample at a place of a track that is run there and back and there again. At the
/// turns the track is continuous.
///
/// ```
/// let places = (0..8).map(|place| nodes::track::there_and_back(place, 4));
/// assert!(places.eq([0, 1, 2, 3, 2, 1, 0, 1]));
/// ```
pub fn there_and_back(place: u32, samples: u32) -> u32 {
    let period = samples.saturating_mul(2).saturating_sub(2).max(1);
    let at = place % period;
    if at < samples { at } else { period - at }
}
