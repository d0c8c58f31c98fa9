//! Sound rigs, hour after hour: every alarm of a detector is a false one.
//!
//! A grid of dampers, tracks and rigs, each in a session of its own in virtual time, with the
//! irregularity and the noise of seeds that no limit was chosen with. `H` hours without an alarm
//! prove, at a confidence of 95 %, a rate below `-ln(0.05) / H`, about `3 / H`.
//!
//! A vehicle that hunts beyond the stroke of its rig is no sound case: the speeds are those of the
//! two scenarios, 160 km/h on straight track and 80 km/h in a curve of 400 m. Worn dampers hunt
//! there too, and stay within the stroke.

use crate::BenchError;
use crate::bus::{BusChoice, MemoryBus};
use crate::clock::Tick;
use crate::control::{Buses, Course, Requests};
use crate::draw::Draw;
use crate::record::Queues;
use crate::rig::RigNode;
use crate::run::{Plan, Terms, session};
use can_protocol::{Profile, Watch};
use rayon::prelude::*;
use scenario::rig::RigSetup;
use scenario::run::{Overrides, Run, SlotForce};
use scenario::setting::Setting;
use scenario::watch::{Limit, WatchSetup};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Clearances of the grid (m).
const CLEARANCES_M: [f64; 6] = [0.0, 1e-3, 2e-3, 4e-3, 6e-3, 8e-3];

/// Series stiffness of a worn damper (N/m): the softest of the published study.
const WORN_KE_N_PER_M: f64 = 3e6;

/// Cycles between two reports of progress.
const REPORTED: u64 = 1000;

/// Name of the watch over the model of a damper, which raises alarms and ends nothing.
const WATCH: &str = "watch";

/// The conditions of a sound rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoundCase {
    /// Clearance of all dampers (m).
    pub clearance_2a_m: f64,
    /// Whether the series stiffness of all dampers is that of a worn one.
    pub is_soft: bool,
    /// In a curve, or on straight track.
    pub is_curve: bool,
    /// On a slow rig in a flexible frame, or on a good laboratory rig.
    pub is_slow: bool,
}

/// The scenarios of the two kinds of track.
#[derive(Debug, Clone, Copy)]
pub struct SoundScenarios<'a> {
    /// On straight track.
    pub straight: &'a Path,
    /// In a curve.
    pub curve: &'a Path,
}

/// An alarm on a sound rig.
#[derive(Debug, Clone, PartialEq)]
pub struct FalseAlarm {
    /// Key of the signal.
    pub signal: &'static str,
    /// What was found, in words.
    pub message: String,
}

/// What was heard of a sound rig.
#[derive(Debug, Clone, PartialEq)]
pub struct Heard {
    /// Its conditions.
    pub case: SoundCase,
    /// Seed of its track.
    pub seed: u32,
    /// Cycles with the rig armed.
    pub cycles: u64,
    /// The alarms. One that ends the session ends the case.
    pub alarms: Vec<FalseAlarm>,
}

/// All cases.
pub fn sound_cases() -> Vec<SoundCase> {
    let mut cases = Vec::new();
    for is_slow in [false, true] {
        for is_curve in [false, true] {
            for is_soft in [false, true] {
                cases.extend(CLEARANCES_M.map(|clearance_2a_m| SoundCase {
                    clearance_2a_m,
                    is_soft,
                    is_curve,
                    is_slow,
                }));
            }
        }
    }
    cases
}

/// Runs cases for so many seconds each, on all cores; `done` hears of cycles as they are done.
///
/// # Errors
/// A scenario that does not fit, has no rig, or has one that cannot be armed.
pub fn listen_to_sound_rigs(
    scenarios: SoundScenarios<'_>,
    cases: &[SoundCase],
    seconds: f64,
    seed: u64,
    stop: &AtomicBool,
    done: &(dyn Fn(u64) + Sync),
) -> Result<Vec<Heard>, BenchError> {
    let all = sound_cases();
    let listen = |case: &SoundCase| {
        // The same case has the same seed in every choice of cases.
        let stream = all.iter().position(|other| other == case).unwrap_or(all.len());
        let draw = Draw::seeded(seed, stream as u64);
        case.listen(scenarios, seconds, draw, stop, done)
    };
    cases.par_iter().map(listen).collect()
}

/// The largest rate of alarms that so many hours without one leave possible, per hour, at a
/// confidence of 95 %.
pub fn alarm_rate_bound_per_h(hours: f64) -> f64 {
    -libm::log(0.05) / hours
}

impl SoundCase {
    /// Runs it.
    fn listen(
        self,
        scenarios: SoundScenarios<'_>,
        seconds: f64,
        mut draw: Draw,
        stop: &AtomicBool,
        done: &(dyn Fn(u64) + Sync),
    ) -> Result<Heard, BenchError> {
        let (track_seed, noise_seed) = (draw.number(), draw.number());
        let run = self.run(scenarios, seconds, track_seed, noise_seed)?;
        let plan = Plan::new(&run, &BusChoice::Memory)?;
        let track = run.track.view();
        let mut course = Course::new(&run, &track);
        let session = session(&run, &track, &plan.rigs, Terms::in_memory(Profile::Classical))?;
        let rigs = plan.rigs.iter().map(|rig| RigNode::new(&run.rig, rig.node, Profile::Classical));
        let mut bus = MemoryBus::new(rigs);
        let bus = std::slice::from_mut(&mut bus);
        let mut state = session.start(session.line.start(run.start.state.clone()));
        session
            .greet(&mut state, bus, Duration::from_secs(1), &Requests::armed())
            .map_err(|why| why.on(&BusChoice::Memory))?;
        let mut queues = Queues::default();
        let (mut recorder, _drain) = queues.split();
        let mut alarms = Vec::new();
        let mut is_drifting = false;
        let mut track = course.track();
        while state.line.run_cycles() < run.cycles() && state.stop.is_none() {
            if course.is_passed(&state.line) {
                drop(track);
                course.change()?;
                track = course.track();
            }
            let mut buses = Buses::new(bus, &mut recorder);
            session.cycle_on(&track, &mut state, &mut buses, Tick::default());
            let drifts = state.ports.iter().any(|port| port.watch.view.verdict == Watch::Drift);
            if drifts && !is_drifting {
                let time_s = state.line.time_s(run.cycle_s());
                let message = format!("at {time_s:.3} s, force off its model");
                alarms.push(FalseAlarm { signal: WATCH, message });
            }
            is_drifting = drifts;
            if state.line.cycle % REPORTED == 0 {
                done(REPORTED);
                if stop.load(Ordering::Relaxed) {
                    break;
                }
            }
        }
        let ends = state
            .stop
            .map(|stop| FalseAlarm { signal: stop.cause.signal.key(), message: stop.to_string() });
        alarms.extend(ends);
        Ok(Heard { case: self, seed: track_seed, cycles: state.line.cycle, alarms })
    }

    /// The scenario with the case's dampers, track and rig.
    fn run(
        self,
        scenarios: SoundScenarios<'_>,
        seconds: f64,
        track_seed: u32,
        noise_seed: u32,
    ) -> Result<Run, BenchError> {
        let mut settings = vec![
            Setting::to("damper.clearance_2a_m", self.clearance_2a_m),
            Setting::to("track.irregularity.aar6.seed", f64::from(track_seed)),
        ];
        if self.is_soft {
            settings.push(Setting::to("damper.ke_n_per_m", WORN_KE_N_PER_M));
        }
        if self.is_curve {
            // The whole way is curved; no train runs at more than 100 m/s.
            settings.push(Setting::to("track.curve.length_m", 1e3 + 100.0 * seconds));
        }
        let path = if self.is_curve { scenarios.curve } else { scenarios.straight };
        let overrides = Overrides { duration_s: Some(seconds), ..Overrides::default() };
        let mut run = Run::load_with(path, overrides, &settings)?;
        let rig = if self.is_slow { slow(run.rig) } else { run.rig };
        run.rig = RigSetup { seed: u64::from(noise_seed), ..rig };
        // Every damper is watched.
        for slot in &mut run.slots {
            if let SlotForce::Rig { model, watch, .. } = &mut slot.force {
                watch.get_or_insert_with(|| Box::new(watch_over((**model).clone())));
            }
        }
        Ok(run)
    }
}

/// The usual watch over a damper.
fn watch_over(damper: firmware_core::damper::Damper) -> WatchSetup {
    WatchSetup { damper, settle_s: 2.0, learn_s: 10.0, window_s: 10.0, limit: Limit::Ratio(3.0) }
}

/// The slow rig of `scenarios/rigs/slow-rig.toml` with the damper of another one.
fn slow(rig: RigSetup) -> RigSetup {
    RigSetup {
        name: "slow rig".to_owned(),
        stroke_m: 0.125,
        rate_m_per_s: 0.25,
        lag_s: 6e-3,
        delay_cycles: 4,
        fixture_m_per_n: 1.0 / 60e6,
        force_noise_n: 20.0,
        displacement_noise_m: 1e-6,
        ..rig
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::rig::RigFile;

    #[test]
    fn the_slow_rig_is_that_of_its_file() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/rigs/slow-rig.toml");
        let file = RigFile::load(&path).unwrap();
        assert_eq!(slow(file.clone()), file);
    }

    #[test]
    fn three_hours_without_an_alarm_leave_one_an_hour_possible() {
        assert!((alarm_rate_bound_per_h(3.0) - 0.9986).abs() < 1e-4);
    }

    #[test]
    fn the_grid_has_every_case_once() {
        let cases = sound_cases();
        assert_eq!(cases.len(), 48);
        let twice = cases.iter().enumerate().any(|(n, case)| cases[..n].contains(case));
        assert!(!twice);
    }
}
