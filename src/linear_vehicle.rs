//! The vehicle of a run about steady running, for the bench: its hunting and its receptances.

use firmware_core::damper::Nominal;
use hil_host::{Hunting, LinearMode, LinearVehicle};
use scenario::run::Run;
use std::f64::consts::TAU;
use vehicle_studies::StudyError;
use vehicle_studies::receptance::{self, damping_ratio};
use vehicle_studies::trip::Equipped;

/// Of a run; none where no mode of the vehicle is one that its dampers see.
///
/// # Errors
/// Wear on a rig that leaves no damper.
pub(crate) fn linear_vehicle(run: &Run) -> Result<Option<LinearVehicle>, StudyError> {
    let equipped = Equipped::of(run).map_err(StudyError::Damper)?;
    let dampers: Vec<Nominal> = equipped.dampers.iter().map(|damper| *damper.nominal()).collect();
    let about = (&run.start.state, run.speed_m_per_s);
    let found = receptance::resonances(&equipped.vehicle, equipped.table(), about, &dampers);
    let Some(resonances) = found else { return Ok(None) };
    let Some(hunting) = receptance::hunting(&resonances) else { return Ok(None) };
    let frequency_hz = hunting.pole.norm() / TAU;
    let mode = |one: &receptance::Resonance| LinearMode {
        pole: one.pole,
        residues: one.residues,
        cross: one.cross,
    };
    Ok(Some(LinearVehicle {
        hunting: Hunting { frequency_hz, damping_ratio: damping_ratio(hunting.pole) },
        hunting_pole: hunting.pole,
        modes: resonances.iter().map(mode).collect(),
    }))
}
