//! A run that is killed leaves a record and a bus log that can be read.

use crate::support::command::{folder, output, read, repository, yawbench};
use crate::support::record::Record;
use can_protocol::Node;
use hil_host::record::measured::{read_bus_log, read_record};
use std::path::PathBuf;
use std::process::Stdio;
use std::time::{Duration, SystemTime};

/// Starts a run and kills it when its record has so many bytes; gives its folder and the time since
/// 1970 at which it was killed. It computes as fast as it can: at the pace of the clock, a busy
/// machine skips so many slots that the run ends by itself.
fn killed(name: &str, bytes: u64) -> (PathBuf, SystemTime) {
    let out = folder(name);
    let mut run = yawbench();
    run.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml")).arg("--out").arg(&out);
    run.args(["--pace", "fast", "--duration", "60"]).stderr(Stdio::null());
    let mut run = run.spawn().unwrap();
    while std::fs::metadata(out.join("record.npy")).map_or(0, |file| file.len()) < bytes {
        assert_eq!(run.try_wait().unwrap(), None, "it ended by itself");
        std::thread::yield_now();
    }
    run.kill().unwrap();
    let at = SystemTime::now();
    assert_eq!(run.wait().unwrap().code(), None);
    (out, at)
}

/// Bytes of a row.
const ROW: u64 = 853;

/// The number of kills: `YAWBENCH_KILLS`, or 20.
fn kills() -> u64 {
    std::env::var("YAWBENCH_KILLS").map_or(20, |kills| kills.parse().unwrap())
}

#[test]
fn a_run_that_is_killed_leaves_files_that_can_be_read() {
    let mut longest = Duration::ZERO;
    for kill in 0..kills() {
        let (out, at) = killed("killed", 1 + kill % 20 * 10 * ROW);
        let record = Record::read_killed(&out.join("record.npy"));
        for row in 0..record.rows() {
            assert_eq!(record.integer(row, "cycle", 0), row as u64 + 1, "kill {kill}");
        }
        let rows = read_record(&out.join("record.npy"), 1).unwrap().time_s.len();
        assert!(rows >= record.rows(), "kill {kill}: {rows} of {}", record.rows());
        let log = read(&out.join("bus.log"));
        // The handshake is in the file before the first row: a sync from the host.
        let first = log.lines().next().unwrap();
        assert!(first.contains(" memory 080#") && first.ends_with(" T"), "{first}");
        for name in ["record.npy", "bus.log"] {
            let written = std::fs::metadata(out.join(name)).unwrap().modified().unwrap();
            longest = longest.max(at.duration_since(written).unwrap_or_default());
        }
        if record.rows() > 100 {
            let test = read_bus_log(&out.join("bus.log"), Node::ALL[0], None).unwrap();
            assert!(!test.time_s.is_empty());
        }
        for name in ["scenario.toml", "vehicle.toml"] {
            assert!(out.join(name).is_file(), "no {name}");
        }
        std::fs::remove_dir_all(out).unwrap();
    }
    println!("{} kills, the last write at most {longest:?} before", kills());
}

#[test]
fn a_report_is_made_of_what_a_killed_run_left_and_says_so() {
    // Without a row, and with half a second of RUN after two fades; the header takes less than ten
    // rows.
    for (rows, bytes) in [(0, 1), (500, 1600 * ROW)] {
        let (out, _) = killed("killed-report", bytes);
        let report = || output(yawbench().arg("report").arg(&out));
        let made = report();
        let text = String::from_utf8_lossy(&made.stdout);
        assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
        assert!(text.contains("no end recorded"), "{text}");
        let cycles: u64 = text.split(' ').next().unwrap().parse().unwrap();
        assert!(cycles >= rows, "{text}");
        let html = read(&out.join("report.html"));
        assert!(html.contains("This run has no summary.json"), "no word of it");
        assert!(!out.join("summary.json").exists());
        // Once more, over the same report.
        assert_eq!(report().stdout, made.stdout);
        std::fs::remove_dir_all(out).unwrap();
    }
}

#[test]
fn a_report_of_a_run_that_ended_is_made_again_and_other_folders_are_refused() {
    let out = folder("report-again");
    let mut run = yawbench();
    run.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml"));
    let done = output(run.args(["--pace", "fast", "--duration", "3", "--out"]).arg(&out));
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    // Every counter that is not zero would be on the last line.
    let text = String::from_utf8_lossy(&done.stdout);
    let last = text.lines().last().unwrap();
    assert!(last.starts_with("frames sent ") && last.ends_with(" | no faults counted"), "{last}");
    let events = read(&out.join("summary.json"));
    assert!(events.contains("\"event\": \"state RUN\""), "{events}");
    let first = read(&out.join("report.html"));
    std::fs::remove_file(out.join("report.html")).unwrap();
    let made = output(yawbench().arg("report").arg(&out));
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(String::from_utf8_lossy(&made.stdout).starts_with("3000 cycles of RUN, completed\n"));
    let again = read(&out.join("report.html"));
    assert_eq!(again, first);
    let refused = output(yawbench().arg("report").arg(repository().join("scenarios")));
    let errors = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{errors}");
    assert!(errors.contains("found no result, expected one of `run`"), "{errors}");
    std::fs::remove_dir_all(out).unwrap();
}
