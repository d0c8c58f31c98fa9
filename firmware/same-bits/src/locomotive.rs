//! The creep laws under the whole vehicle: trajectory after so many steps.

use firmware_core::fnv;
use firmware_core::guard::ForceInput;
use firmware_core::line::{Line, LineState};
use firmware_core::track::{Track, Window};
use firmware_core::vehicle::{DAMPER_SLOTS, Vehicle};
use firmware_core::wheel_rail::creep::{CreepLaw, Fastsim};

/// The laws of wheels on profiles, by name.
pub const LAWS: [&str; 3] = ["linear_saturated", "polach", "fastsim"];

/// Cells of FASTSIM's grid along and across.
const CELLS: u16 = 10;

/// Puts a law under all wheels; false where there is none of this name.
pub fn use_law(vehicle: &mut Vehicle, name: &str) -> bool {
    let law = match name {
        "linear_saturated" => Some(CreepLaw::LinearSaturated),
        "polach" => Some(CreepLaw::Polach),
        "fastsim" => Fastsim::new(CELLS, CELLS).map(CreepLaw::Fastsim),
        _ => None,
    };
    if let Some(law) = law {
        vehicle.axles.iter_mut().for_each(|axle| axle.wheel.creep = law);
    }
    law.is_some()
}

/// What is told of each step, to count what it costs.
pub trait Watch {
    /// A step begins.
    fn begins(&mut self) {}
    /// It is done.
    fn ends(&mut self) {}
}

impl Watch for () {}

/// Runs a line without rigs on from a state; the trajectory hash of the cycles.
#[inline(never)]
pub fn run(line: &Line<'_>, state: &mut LineState, steps: u32, watch: &mut impl Watch) -> u64 {
    let mut hash = fnv::START;
    for _ in 0..steps {
        watch.begins();
        line.step(state, &[ForceInput::Missing; DAMPER_SLOTS]);
        watch.ends();
        hash = state.hashed(hash, line.vehicle);
    }
    hash
}

/// Samples that a board holds: 25.6 m of track, with a locomotive of 18 m between its wheels.
pub type BoardWindow = Window<256>;

/// No wheel is further than this from the vehicle's reference point (m).
const REACH_M: f64 = 10.0;

/// The same run, with the track handed over sample by sample while the vehicle runs on it; none
/// where the window was not filled in time.
#[inline(never)]
pub fn run_in_window(
    line: &Line<'_>,
    window: &mut BoardWindow,
    state: &mut LineState,
    steps: u32,
) -> Option<u64> {
    let mut samples = line.track.irregularity.samples.iter();
    let mut hash = fnv::START;
    for _ in 0..steps {
        let at_m = state.vehicle.distance_m.lane(0);
        window.pass(at_m - REACH_M);
        for sample in samples.by_ref().take(window.room()) {
            window.push(*sample);
        }
        if !window.reaches(at_m + REACH_M + line.speed_m_per_s * line.cycle_s) {
            return None;
        }
        let track = Track { layout: line.track.layout.clone(), irregularity: window.view() };
        line.step_on(&track, state, &[ForceInput::Missing; DAMPER_SLOTS], &[None; DAMPER_SLOTS]);
        hash = state.hashed(hash, line.vehicle);
    }
    Some(hash)
}
