//! How long a peer that has no clock has been silent.
//!
//! In lock-step each side waits for the other, and only real time tells that the other is lost. It
//! is counted in glances at the bus: a glance that took longer than it was to take is a machine
//! that stood still, with whoever else runs on it, and counts no more than it was to take. So a
//! standstill ends no run, and a peer that is lost is noticed later on a machine that hardly runs.
//! Nothing moves meanwhile: a ram in lock-step moves with commands alone.

use std::time::{Duration, Instant};

/// Silence after which a peer in lock-step is lost.
pub(crate) const SILENCE: Duration = Duration::from_secs(1);

/// Longest wait for a frame; a stop by the operator is seen after that time.
pub(crate) const GLANCE: Duration = Duration::from_millis(50);

/// Most that one glance counts: the wait, and a scheduler that is in no hurry.
const MOST: Duration = GLANCE.saturating_mul(2);

/// Time spent in waiting for a peer.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Silence {
    looked: Instant,
    lasted: Duration,
}

impl Silence {
    /// Begins at `now`.
    pub(crate) fn from(now: Instant) -> Self {
        Self { looked: now, lasted: Duration::ZERO }
    }

    /// How long it has lasted at `now`, which is a glance after the last call.
    pub(crate) fn lasts(&mut self, now: Instant) -> Duration {
        self.lasted += now.saturating_duration_since(self.looked).min(MOST);
        self.looked = now;
        self.lasted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silence_lasts_as_long_as_somebody_listens() {
        let mut silence = Silence::from(Instant::now());
        let begin = silence.looked;
        for glance in 1..=20_u32 {
            assert_eq!(silence.lasts(begin + GLANCE * glance), GLANCE * glance);
        }
    }

    #[test]
    fn a_machine_that_stands_still_hears_no_silence() {
        let mut silence = Silence::from(Instant::now());
        let later = silence.looked + Duration::from_secs(3600);
        assert_eq!(silence.lasts(later), MOST);
        assert_eq!(silence.lasts(later + GLANCE), MOST + GLANCE);
        assert!(MOST + GLANCE < SILENCE / 2);
    }
}
