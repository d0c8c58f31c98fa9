//! The vehicles that references are about, from the scenarios' own files, kept in the program: a
//! page of validation has to come out the same wherever it is asked for.

use crate::error::EvidenceError;
use firmware_core::vehicle::Vehicle;
use firmware_core::wheel_rail::table::ContactTable;
use scenario::source::Source;
use scenario::vehicle::VehicleFile;
use scenario::wheel_rail::Contact;
use std::path::Path;

/// A vehicle with its solved profiles, where it runs on some.
pub(super) struct Built {
    pub(super) vehicle: Vehicle,
    pub(super) contact: Option<Contact>,
}

impl Built {
    /// The table of its wheels.
    pub(super) fn table(&self) -> Result<&ContactTable, EvidenceError> {
        Ok(&self
            .contact
            .as_ref()
            .ok_or(EvidenceError::NotComputed("a vehicle without profiles"))?
            .table)
    }
}

/// Cooperrider's bogie.
pub(super) fn cooperrider() -> Result<Built, EvidenceError> {
    built(
        "cooperrider-bogie.toml",
        include_str!("../../../scenarios/vehicles/cooperrider-bogie.toml"),
    )
}

/// The Manchester benchmark's coach.
pub(super) fn manchester_coach() -> Result<Built, EvidenceError> {
    built(
        "manchester-coach.toml",
        include_str!("../../../scenarios/vehicles/manchester-coach.toml"),
    )
}

/// The SS9.
pub(super) fn ss9() -> Result<Built, EvidenceError> {
    built("ss9.toml", include_str!("../../../scenarios/vehicles/ss9.toml"))
}

fn built(name: &str, text: &str) -> Result<Built, EvidenceError> {
    let source = Source::from_text(Path::new(name), text);
    let file: VehicleFile = source.parse()?;
    Ok(Built { vehicle: file.build(&source)?, contact: file.wheel_rail.contact(&source)? })
}
