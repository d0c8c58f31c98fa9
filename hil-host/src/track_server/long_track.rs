//! The samples of a track that is made stretch by stretch while it is served.

use crate::control::Course;
use firmware_core::track::{IrregularitySample, Track};
use nodes::track::Source;
use scenario::run::Run;

/// A track of any length, of which two stretches are in memory.
///
/// Locomotives ask for one sample after the other, and for one again that was lost. The stretches
/// overlap by more than a request can ask for, so that the present one has it.
pub(super) struct LongTrack<'a> {
    run: &'a Run,
    first: &'a Track<'a>,
    course: Course<'a>,
    /// Whether the thread that makes stretches has failed.
    has_failed: bool,
}

impl<'a> LongTrack<'a> {
    /// The track of a run, which begins with `first`.
    pub(super) fn new(run: &'a Run, first: &'a Track<'a>) -> Self {
        Self { run, first, course: Course::new(run, first), has_failed: false }
    }

    /// Whether there is no next stretch for want of whoever makes it.
    pub(super) fn has_failed(&self) -> bool {
        self.has_failed
    }
}

impl Source for LongTrack<'_> {
    fn sample(&mut self, place: u32) -> Option<IrregularitySample> {
        let place = place as usize;
        if place < self.course.track().irregularity.before {
            // A locomotive that begins anew.
            self.course = Course::new(self.run, self.first);
        }
        loop {
            let stretch = self.course.track().irregularity;
            let end = stretch.before + stretch.samples.len();
            if place < end {
                return stretch.samples.get(place - stretch.before).copied();
            }
            if stretch.behind == 0 {
                return None;
            }
            if self.course.change().is_err() {
                self.has_failed = true;
                return None;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::run::Overrides;
    use scenario::source::Source as File;
    use std::path::Path;

    #[test]
    fn a_long_track_has_every_sample_of_the_track_as_a_whole() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(20.0), ..Overrides::default() };
        let whole = Run::from_source(&File::read(&path).unwrap(), overrides).unwrap();
        let mut run = whole.clone();
        let stretches = run.stretches.take().unwrap().of_samples(2048);
        assert!(stretches.make(0, &mut run.track.samples, &|| true));
        assert!(stretches.count() > 4);
        run.stretches = Some(stretches);
        let first = run.track.view();
        let mut track = LongTrack::new(&run, &first);
        let samples = &whole.track.samples.samples;
        // Now and then a request is lost and made again, and in the end a locomotive starts anew.
        let again = |n: u32| (n..n + 64).chain(n..n + 64);
        let places = (0..samples.len() as u32).step_by(64).flat_map(again).chain(0..3000);
        for place in places {
            assert_eq!(track.sample(place), samples.get(place as usize).copied(), "{place}");
        }
        assert!(!track.has_failed());
    }
}
