//! A sweep spread over the workers of an existing scheduler: `HyperQueue` runs two shards,
//! `--merge` joins them, and the answer is the same bytes as in one piece. Runs where Python has
//! the package hyperqueue.

use crate::support::command::{folder, output, read, repository, yawbench};
use std::process::Command;

/// Starts a cluster on this machine, hands in every argument as the command of one task, and waits.
const SUBMIT: &str = "
import sys
from hyperqueue import Job, LocalCluster
from hyperqueue.cluster import WorkerConfig
with LocalCluster() as cluster:
    cluster.start_worker(WorkerConfig(cores=2))
    client = cluster.client()
    job = Job()
    for line in sys.argv[1:]:
        job.program(line.split('|'))
    client.wait_for_jobs([client.submit(job)])
";

#[test]
fn hyperqueue_runs_the_shards_of_a_sweep() {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let there = Command::new(&python).args(["-c", "import hyperqueue"]).output();
    if !there.is_ok_and(|found| found.status.success()) {
        assert!(std::env::var_os("REQUIRE_HYPERQUEUE").is_none(), "{python} has no hyperqueue");
        println!("skipped: {python} has no package hyperqueue");
        return;
    }
    let place = folder("hyperqueue");
    let vehicle = repository().join("scenarios/vehicles/cooperrider-bogie.toml");
    let vehicle = vehicle.display();
    let text =
        format!("title = \"bogie\"\nvehicle = '{vehicle}'\nspeed_kmh = 200.0\nduration_s = 1.0\n");
    std::fs::write(place.join("bogie.toml"), text).unwrap();
    let scenario = place.join("bogie.toml").display().to_string();
    let sweep = [
        "critical-speed",
        &scenario,
        "--from-kmh=225",
        "--to-kmh=265",
        "--method=linear",
        "--vary=vehicle.wheel_rail.surface.conical.conicity=0.045:0.055:5",
    ];
    let line = |shard: usize| {
        let (of, out) = (format!("--shard={shard}/2"), format!("--out={}/part", place.display()));
        [&[env!("CARGO_BIN_EXE_yawbench")][..], &sweep, &[&of, &out]].concat().join("|")
    };
    // HyperQueue writes what its tasks print where they were submitted.
    let mut submit = Command::new(&python);
    submit.args(["-c", SUBMIT]).args([1, 2].map(line)).current_dir(&place);
    let submitted = output(&mut submit);
    let errors = String::from_utf8_lossy(&submitted.stderr);
    assert!(submitted.status.success(), "{errors}");
    let parts: Vec<String> = [1, 2]
        .map(|shard| format!("{}/part/points-{shard}-of-2.jsonl", place.display()))
        .into_iter()
        .collect();
    let joined = output(
        yawbench().args(sweep).arg("--merge").args(&parts).arg("--out=joined").current_dir(&place),
    );
    assert_eq!(joined.status.code(), Some(0), "{}", String::from_utf8_lossy(&joined.stderr));
    let whole = output(yawbench().args(sweep).arg("--out=whole").current_dir(&place));
    assert_eq!(whole.status.code(), Some(0), "{}", String::from_utf8_lossy(&whole.stderr));
    let file = |of: &str| read(&place.join(of).join("critical-speed.json"));
    assert_eq!(file("joined"), file("whole"));
}
