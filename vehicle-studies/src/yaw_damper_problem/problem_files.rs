//! The files that others need: data sheet, wanted motions, scoring, perturbed rigs, examples.

use super::answer::RESULT_OF;
use super::compensators::Ours;
use super::condition::Condition;
use super::data_sheet::DataSheet;
use super::errors::AIMS;
use super::exchange::motion_csv;
use super::perturbed;
use super::problem::{Motion, Problem};
use super::question::DEAD_TIMES_MS;
use super::regime::Regime;
use scenario::rig::Drive;
use std::fmt::Write as _;

/// A file of the problem: its name and its content.
pub type ProblemFile = (String, String);

/// Dead time of the examples (ms).
const EXAMPLE_MS: u16 = 5;
/// The motion of the example of a command.
const EXAMPLE: Motion = Motion { damper: Condition::New, regime: Regime::Track };

impl Problem<'_> {
    /// All files of the problem; rigs are drawn with a seed.
    pub fn files(&self, seed: u64, rigs: u64) -> Vec<ProblemFile> {
        let mut files = vec![
            ("README.txt".to_owned(), read_me(seed)),
            ("perturbed-rigs.csv".to_owned(), self.perturbed_csv(seed, rigs)),
            ("scoring.csv".to_owned(), scoring_csv()),
        ];
        for (damper, sheet) in self.sheets() {
            files.push((format!("rig-{}.csv", damper.name()), rig_csv(sheet)));
            files.push((format!("load-{}.csv", damper.name()), load_csv(sheet)));
        }
        for motion in self.motions() {
            let text = motion_csv(self.wanted(motion));
            files.push((format!("wanted-{}.csv", motion.name()), text));
        }
        let (command, _) = self.own_command(EXAMPLE, EXAMPLE_MS, Ours::Polynomial);
        let name = format!("example-command-{}-{EXAMPLE_MS}ms.csv", EXAMPLE.name());
        files.push((name, motion_csv(&command)));
        let filter = self.example_filter();
        files.push((format!("example-filter-{EXAMPLE_MS}ms.csv"), filter));
        files
    }

    /// The numbers in which perturbed rigs differ; rig 0 is the nominal one.
    fn perturbed_csv(&self, seed: u64, rigs: u64) -> String {
        let mut text = "rig,controller_gain_per_s,feed_forward,valve_hz,valve_damping_ratio,\
                        bulk_modulus_pa,leakage_m3_per_s_pa,friction_n_s_per_m,fixture_n_per_m\n"
            .to_owned();
        for number in 0..=rigs {
            let Some(nominal) = self.rig() else { break };
            let rig = perturbed::rig(nominal, seed, number);
            let Drive::Servo(servo) = &rig.drive else { continue };
            // Writing to a string does not fail.
            let _ = writeln!(
                text,
                "{number},{},{},{},{},{},{},{},{}",
                servo.controller_gain_per_s,
                servo.feed_forward,
                servo.valve_hz,
                servo.valve_damping_ratio,
                servo.bulk_modulus_pa,
                servo.leakage_m3_per_s_pa,
                servo.friction_n_s_per_m,
                1.0 / rig.fixture_m_per_n
            );
        }
        text
    }

    /// A linear extrapolation over the delay of the rig: it shows the format.
    fn example_filter(&self) -> String {
        let own_s = self.sheets().next().map_or(0.0, |(_, sheet)| sheet.delay_s(3.5));
        // The force leads by half a cycle.
        let delay_s = own_s + 1e-3 * f64::from(EXAMPLE_MS);
        let cycles = 1e3 * delay_s - 0.5;
        format!("b,a\n{:.6},1\n{:.6},\n", 1.0 + cycles, -cycles)
    }
}

/// What the tables do not say themselves.
fn read_me(seed: u64) -> String {
    let dead_times = DEAD_TIMES_MS.map(|ms| ms.to_string()).join(", ");
    format!(
        "Reference problem for compensators: yaw dampers of a locomotive on emulated rigs. Every\n\
         result is that of an {RESULT_OF}. docs/yaw-damper-reference-problem.md says more. The names\n\
         of the columns stand in line 1 of every table.\n\
         \n\
         rig-*.csv            Answer of the nominal rig to a sine, with that damper mounted, without\n\
         \x20                    dead time. A dead time of {dead_times} ms comes on top: its\n\
         \x20                    delay at every frequency. A command of time t is answered late by\n\
         \x20                    delay_s, and the force acts half a cycle early.\n\
         \x20                    A compensator has to lead by: delay_s + dead time - 0.0005 s.\n\
         load-*.csv           The same at several strokes, with the force and with the speed times\n\
         \x20                    the size of the force: how much later the ram is under load. All\n\
         \x20                    amplitudes are over that of the command.\n\
         wanted-*.csv         Motions that the rig is to carry out, at 1 kHz, from the run with\n\
         \x20                    every damper modelled.\n\
         example-*.csv        A command and a filter, in the format in which they come back.\n\
         perturbed-rigs.csv   Emulated rigs drawn with seed {seed}; 0 is the nominal one.\n\
         scoring.csv          What is scored. Aims hold for the sizes of errors, for new and worn\n\
         \x20                    dampers, in both regimes.\n"
    )
}

/// The data sheet of the nominal rig with a damper.
fn rig_csv(sheet: &DataSheet) -> String {
    let mut text = "frequency_hz,stroke_m,gain,phase_deg,delay_s\n".to_owned();
    for line in &sheet.answers {
        let (degrees, delay_s) = (line.phase_rad.to_degrees(), line.delay_s());
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{:.6e},{:.6},{degrees:.4},{delay_s:.6e}",
            line.frequency_hz, line.stroke_m, line.gain
        );
    }
    text
}

/// What the load takes from it.
fn load_csv(sheet: &DataSheet) -> String {
    let mut text = "frequency_hz,stroke_m,gain,phase_deg,force_n_per_m,force_phase_deg,\
                    force_times_speed_n_per_s,force_times_speed_phase_deg\n"
        .to_owned();
    for line in &sheet.under_load {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{:.6e},{:.6},{:.4},{:.6e},{:.4},{:.6e},{:.4}",
            line.frequency_hz,
            line.stroke_m,
            line.gain,
            line.phase_rad.to_degrees(),
            line.force_n_per_m,
            line.force_phase_rad.to_degrees(),
            line.force_times_speed_n_per_s,
            line.force_times_speed_phase_rad.to_degrees()
        );
    }
    text
}

/// Every criterion with its definition, its unit and its aim.
fn scoring_csv() -> String {
    let [work, stroke, phase] = AIMS.all();
    format!(
        "criterion,definition,unit,aim\n\
         work,\"sum of F[k] (x[k+1] - x[k]) over the dampers, per cycle of hunting, over that of the \
         all-model run, less one\",percent,{work}\n\
         stroke,\"sqrt(2) rms of the measured displacement about its mean, over that of the \
         all-model run, less one\",percent,{stroke}\n\
         phase,\"arg(Y / X) - w T / 2 at the frequency of hunting: measured over wanted \
         displacement, T = 1 ms\",degrees,{phase}\n\
         critical speed,\"speed below which no hunting stays, less that of the all-model run; closed \
         loop only\",km/h,\n"
    )
}
