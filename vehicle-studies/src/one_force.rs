//! Scenarios in which one measured force acts on several bogies.
//!
//! A force that was measured at one bogie and acts on another one follows a motion that this bogie
//! does not make. Whether a vehicle hunts, and how it rides, depends on just that.

use crate::error::StudyError;
use scenario::run::{Run, SlotForce, StandsFor};

/// Refuses a scenario in which the rig of one bogie stands for a damper of another.
///
/// # Errors
/// The first such damper.
pub(crate) fn refuse_other_bogie(run: &Run) -> Result<(), StudyError> {
    let place = |number: usize| run.slots.get(number).map_or("", |slot| slot.place.as_str());
    let mut slots = run.slots.iter().enumerate();
    let found = slots.find_map(|(number, slot)| match slot.force {
        SlotForce::StandIn { stands_for: StandsFor::OtherBogie, of, .. } => Some((number, of)),
        _ => None,
    });
    match found {
        Some((own, of)) => Err(StudyError::OtherBogie(place(own).to_owned(), place(of).to_owned())),
        None => Ok(()),
    }
}
