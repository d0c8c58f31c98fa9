//! Whether the disk has room for a run, before it begins.

use super::plan::Plan;
use crate::BenchError;
use crate::record::Row;
use can_protocol::Profile;
use scenario::run::Run;
use std::path::Path;

/// Bytes for everything that does not grow with a run: report, summary, scenario.
const REST_BYTES: u64 = 20_000_000;

/// Bytes that a run writes.
pub(crate) fn needed_bytes(run: &Run, plan: &Plan, profile: Profile) -> u64 {
    let records = if run.compare.is_some() { 2 } else { 1 };
    let rows = records * run.cycles() * Row::size() as u64;
    rows + run.cycles() * log_bytes_per_cycle(plan, profile) + REST_BYTES
}

/// Bytes of the bus log in a cycle: a command and a measurement per rig, and a twentieth more for
/// slow messages.
fn log_bytes_per_cycle(plan: &Plan, profile: Profile) -> u64 {
    // Time stamp, id, spaces, direction and line end; then two digits per byte of the payload.
    let frame = 32
        + match profile {
            Profile::Classical => 16,
            Profile::Fd => 34,
        };
    let name = |bus: usize| plan.buses.get(bus).map_or(0, |bus| bus.interface().len() as u64);
    let per_cycle: u64 = plan.rigs.iter().map(|rig| 2 * (frame + name(rig.bus))).sum();
    per_cycle + per_cycle.div_ceil(20)
}

/// Refuses a run that the disk has no room for; `free` is none where the system does not say.
pub(super) fn check(
    folder: &Path,
    free: Option<u64>,
    needed: u64,
    cycles: u64,
) -> Result<(), BenchError> {
    match free.filter(|free| *free < needed) {
        Some(free) => Err(BenchError::Space { folder: folder.to_owned(), free, needed, cycles }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bus::BusChoice;
    use scenario::run::Overrides;

    #[test]
    fn a_day_on_one_rig_needs_eighty_six_gigabytes_and_less_is_refused() {
        let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
        let overrides = Overrides { duration_s: Some(1.0), ..Overrides::default() };
        let run = Run::load(&scenario, overrides).unwrap();
        let plan = Plan::new(&run, &BusChoice::Memory).unwrap();
        let second = needed_bytes(&run, &plan, Profile::Classical) - REST_BYTES;
        assert_eq!(second % 1000, 0);
        let day = second * 86_400;
        assert!((85e9..88e9).contains(&(day as f64)), "{day}");
        let place = Path::new("runs/long-1");
        assert!(check(place, Some(day), day, 86_400_000).is_ok());
        assert!(check(place, None, day, 86_400_000).is_ok());
        let refused = check(place, Some(1_500_000_000), day, 86_400_000).unwrap_err();
        assert!(refused.is_bad_input());
        let text = refused.to_string();
        assert!(
            text.starts_with("runs/long-1: found 1.5 GB free on its disk, expected at least "),
            "{text}"
        );
        assert!(text.ends_with(" GB for 86400000 cycles: shorten the run or free space"), "{text}");
    }
}
