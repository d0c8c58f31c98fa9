//! Whether a completed run held its time and its rigs: a tick has to be earned.
//!
//! A run that has done all its cycles can still be of little worth: on a machine that skipped every
//! third slot of the clock, over a bus that lost every hundredth measurement, or on a rig that did
//! not follow. Each share has its limit; what is above it is a reason not to call the run held. So
//! is a rig that was lost on the way.

use super::DamperSummary;
use super::Frames;
use crate::control::DropOutSummary;
use scenario::run::{Slot, SlotForce};

/// Largest share of the clock's slots that may be skipped.
const SKIPPED_MAX: f64 = 1e-3;

/// Largest share of measurements that may be lost: a share of 0.1 % is held, one of 1 % is not.
const LOST_MAX: f64 = 5e-3;

/// Largest share of measurements with a flag of the rig: limit reached, lagging, saturated.
const FLAGGED_MAX: f64 = 1e-3;

/// Largest share of commands that the limits of the scenario may change.
const LIMITED_MAX: f64 = 1e-2;

/// What a run has counted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Counted<'a> {
    /// All control cycles.
    pub(super) cycles: u64,
    /// Ticks of the clock that were skipped.
    pub(super) skipped: u64,
    /// Rows and frames that the record has lost.
    pub(super) unrecorded: u64,
    pub(super) frames: &'a Frames,
    pub(super) dampers: &'a [DamperSummary],
    /// Slots in the order of the dampers: virtual wear rounds its contacts within the limits on
    /// purpose.
    pub(super) places: &'a [Slot],
    /// Rigs that were lost while the vehicle went on.
    pub(super) drop_outs: &'a [DropOutSummary],
}

/// Why a completed run is not held, one sentence each with what to change.
pub(super) fn not_held(counted: &Counted<'_>) -> Vec<String> {
    let Counted { cycles, skipped, unrecorded, frames, dampers, places, drop_outs } = counted;
    let lost = drop_outs.iter().map(|drop_out| drop_out.why.message.clone());
    let mut reasons: Vec<String> = lost.collect();
    let ticks = cycles + skipped;
    if let Some(percent) = above(*skipped, ticks, SKIPPED_MAX) {
        reasons.push(format!(
            "{percent} % of the clock's ticks were skipped: use a real-time kernel, a \
             processor of its own (--cpu), or a longer period (--slow-down)"
        ));
    }
    if let Some(percent) = above(frames.lost, frames.sent, LOST_MAX) {
        reasons.push(format!(
            "{percent} % of the measurements were lost: check cable, termination and bus load"
        ));
    }
    if *unrecorded > 0 {
        reasons.push(format!(
            "{unrecorded} rows and frames were not recorded: make room on the disk, or use a \
             faster one"
        ));
    }
    for (damper, slot) in dampers.iter().zip(*places) {
        let name = &damper.name;
        let flagged = damper.flagged_measurements.unwrap_or(0);
        if let Some(percent) = above(flagged, *cycles, FLAGGED_MAX) {
            reasons.push(format!(
                "{name}: in {percent} % of the cycles the rig reached a limit or was behind its \
                 command: it does not carry this motion"
            ));
        }
        let limited = damper.limited_commands.filter(|_| !is_worn(slot)).unwrap_or(0);
        if let Some(percent) = above(limited, *cycles, LIMITED_MAX) {
            reasons.push(format!(
                "{name}: in {percent} % of the cycles the limits in [motion] changed the command"
            ));
        }
    }
    reasons
}

/// Whether software adds wear to the damper of a slot.
pub(crate) fn is_worn(slot: &Slot) -> bool {
    match slot.force {
        SlotForce::Rig { virtual_clearance_2a_m, virtual_compliance_m_per_n, .. } => {
            virtual_clearance_2a_m > 0.0 || virtual_compliance_m_per_n > 0.0
        }
        SlotForce::Modelled(_) | SlotForce::StandIn { .. } => false,
    }
}

/// The share in per cent, where it is above its limit.
fn above(count: u64, of: u64, most: f64) -> Option<String> {
    let share = count as f64 / of.max(1) as f64;
    (share > most).then(|| report::significant(share * 100.0, 2))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAMES: Frames = Frames {
        sent: 10_000,
        received: 10_000,
        lost: 0,
        crc_errors: 0,
        repeated: 0,
        wrong_sequence: 0,
        late: 0,
    };

    const HELD: Counted<'_> = Counted {
        cycles: 10_000,
        skipped: 0,
        unrecorded: 0,
        frames: &FRAMES,
        dampers: &[],
        places: &[],
        drop_outs: &[],
    };

    fn reasons(skipped: u64, lost: u64) -> Vec<String> {
        let frames = Frames { lost, ..FRAMES };
        not_held(&Counted { skipped, frames: &frames, ..HELD })
    }

    #[test]
    fn a_run_in_a_slow_machine_was_completed_with_a_green_tick() {
        // 7,740 of 10,740 ticks were skipped.
        let counted = Counted { cycles: 3000, skipped: 7740, ..HELD };
        let reasons = not_held(&counted);
        assert!(reasons.len() == 1 && reasons[0].starts_with("72 % of the clock's"), "{reasons:?}");
    }

    #[test]
    fn a_loss_of_a_thousandth_is_held_and_one_of_a_hundredth_is_not() {
        assert_eq!(reasons(0, 0), Vec::<String>::new());
        assert_eq!(reasons(10, 10), Vec::<String>::new());
        assert!(reasons(0, 100)[0].contains(" of the measurements were lost"));
        assert_eq!(reasons(20, 100).len(), 2);
    }

    #[test]
    fn a_record_with_a_gap_is_not_held() {
        let reasons = not_held(&Counted { unrecorded: 9, ..HELD });
        assert!(reasons.len() == 1 && reasons[0].starts_with("9 rows and frames"), "{reasons:?}");
    }
}
