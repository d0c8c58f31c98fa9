//! Steps of a simulation that a flag can end.

use crate::error::EvidenceError;
use std::sync::atomic::AtomicBool;

/// Takes steps in portions of some hundred, until `stop` is set.
///
/// # Errors
/// The work is stopped.
pub(super) fn stepped(
    steps: u32,
    stop: &AtomicBool,
    mut step: impl FnMut(u32),
) -> Result<(), EvidenceError> {
    const PORTION: u32 = 512;
    let mut open = steps;
    while open > 0 {
        EvidenceError::check(stop)?;
        let portion = open.min(PORTION);
        step(portion);
        open -= portion;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;

    #[test]
    fn steps_are_taken_in_portions_until_the_flag_is_set() {
        let stop = AtomicBool::new(false);
        let mut taken = 0;
        assert!(stepped(1300, &stop, |steps| taken += steps).is_ok());
        assert_eq!(taken, 1300);
        let ended = stepped(u32::MAX, &stop, |steps| {
            taken += steps;
            stop.store(taken > 5000, Ordering::Relaxed);
        });
        assert!(ended.is_err() && taken < 6000, "{taken}");
    }
}
