//! What takes longer than a change can wait for: hours of faults, sound rigs, a million frames of a
//! rig with its own messages, killed runs, unit tests in an interpreter.

use crate::bits;
use crate::board::{self, Length};
use crate::miri;
use crate::power_cut::{self, Cuts};
use crate::roles;
use crate::run::{Outcome, Run};
use crate::thumb;

/// Six hours of random faults at 1 kHz.
const SOAK_CYCLES: &str = "21600000";

/// Seconds of each sound rig.
const SOUND_S: &str = "600";

/// Runs that are killed.
const KILLS: &str = "200";

/// Machines that lose their power.
const POWER_CUTS: u64 = 5;

/// Cycles of a rig with its own messages: a command and a measurement in each, a million frames.
const OWN_MESSAGES_CYCLES: &str = "500000";

/// Tests of minutes that are marked as ignored for it; other ignored ones print tables.
const LONG_TESTS: [&str; 4] = [
    "twelve_fixed_cases_have_the_outcome",
    "case_582_was_left_unexplained",
    "each_pair_on_every_damper",
    "becomes_subnormal_in_ten_million_steps",
];

/// Seed of random faults and of sound rigs. No limit was chosen with it.
const SEED: &str = "2611";

/// Everything that `cargo xtask test` leaves out.
pub(crate) fn test(run: &mut Run) {
    run.step("long", |run| {
        let mut cargo = run.cargo();
        cargo.args(["test", "--workspace", "--no-fail-fast", "--", "--ignored"]);
        run.checked(cargo.args(LONG_TESTS))
    });
    run.step("bits", bits::with_avx2);
    run.step("bits in release", bits::in_release);
    run.step("soak", |run| faults(run, &["--cycles", SOAK_CYCLES]));
    run.step("sound", |run| faults(run, &["--sound", SOUND_S]));
    run.step("own-messages", |run| {
        let mut cargo = run.cargo();
        cargo.args(["test", "-p", "hil-host", "--test", "bench", "--"]);
        cargo.args(["a_long_run_of_own_messages", "--nocapture"]);
        run.checked(cargo.env("OWN_MESSAGES_CYCLES", OWN_MESSAGES_CYCLES))
    });
    run.step("kills", |run| {
        let mut cargo = run.cargo();
        cargo.args(["test", "--test", "system", "--", "killed_run", "--nocapture"]);
        run.checked(cargo.env("YAWBENCH_KILLS", KILLS))
    });
    run.step("miri", miri::test);
    run.step("board", |run| {
        let bits = board::test(run, thumb::TARGET, Length::Full);
        bits.and(roles::test(run, thumb::TARGET, Length::Full))
    });
    run.step("power-cut", |run| power_cut::test(run, Cuts { kills: POWER_CUTS, seed: 2611 }));
}

/// `yawbench faults` in a release build.
fn faults(run: &mut Run, arguments: &[&str]) -> Outcome {
    let mut cargo = run.cargo();
    cargo.args(["run", "--release", "--bin", "yawbench", "--", "faults", "--seed", SEED]);
    run.checked(cargo.args(arguments))
}
