//! A run as files of its own: every default written out, no default is left to the program.

use crate::cycle::Rate;
use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::irregularity::IrregularityFile;
use crate::motion::Motion;
use crate::rig::RigSetup;
use crate::run_file::{On, RunFile};
use crate::source::Source;
use crate::vehicle::VehicleFile;
use crate::wheel_rail::SurfaceFile;

/// A scenario and its vehicle as TOML, to be kept in one folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Effective {
    /// The scenario; it names the vehicle `vehicle.toml`.
    pub scenario: String,
    /// The vehicle.
    pub vehicle: String,
}

/// The scenario with every default written out; files that it names get their full path.
pub(crate) fn effective(
    mut file: RunFile,
    (motion, rig, rate): (&Motion, &RigSetup, Rate),
    source: &Source,
    mut vehicle: VehicleFile,
    vehicle_source: &Source,
) -> Result<Effective, ScenarioError> {
    let full = |source: &Source, path: &str| {
        let path = source.sibling(path);
        std::path::absolute(&path).unwrap_or(path).display().to_string()
    };
    "vehicle.toml".clone_into(&mut file.vehicle);
    file.damper = file.damper.over(&DamperFile::new_damper());
    file.rig = file.rig.with_defaults(&file.damper, rig);
    file.motion = file.motion.with_defaults();
    file.readiness = file.readiness.with_defaults();
    file.plausibility = file.plausibility.with_defaults(motion.stroke_m, rate);
    for slot in file.slot.iter_mut().filter(|slot| slot.on == On::Rig) {
        slot.model = Some(slot.model.take().unwrap_or_default().over(&file.damper));
        slot.accept_delay_error = Some(slot.accept_delay_error.unwrap_or(false));
        slot.compensation = Some(slot.compensation.take().unwrap_or_default().with_defaults());
        slot.if_rig_drops_out = Some(slot.if_rig_drops_out.unwrap_or_default());
    }
    for watch in file.slot.iter_mut().filter_map(|slot| slot.watch.as_mut()) {
        *watch = watch.with_defaults(&file.damper);
    }
    file.compare = file.compare.map(|compare| compare.with_defaults());
    if let Some(IrregularityFile::Csv { path }) = &mut file.track.irregularity {
        *path = full(source, path);
    }
    if let SurfaceFile::Profiles { wheel, rail, .. } = &mut vehicle.wheel_rail.surface {
        for profile in [wheel, rail] {
            if vehicle_source.sibling(profile).is_file() {
                *profile = full(vehicle_source, profile);
            }
        }
    }
    let written = |error: toml::ser::Error| source.whole_error(error.to_string());
    Ok(Effective {
        scenario: toml::to_string(&file).map_err(written)?,
        vehicle: toml::to_string(&vehicle).map_err(written)?,
    })
}
