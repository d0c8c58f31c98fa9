//! Records that are not whole, or not those of their run: what is missing is said, and nothing that
//! is in them counts as a completed run.

use crate::support::command::{folder, output, repository, yawbench};
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Three seconds at 160 km/h with a rig; the folder.
fn run(name: &str) -> PathBuf {
    let out = folder(name);
    let mut command = yawbench();
    command.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml"));
    command.args(["--pace", "fast", "--duration", "3", "--overwrite", "--out"]).arg(&out);
    let made = output(&mut command);
    assert!(made.status.success(), "{}", said(&made));
    out
}

fn of(command: &str, run: &Path) -> Output {
    output(yawbench().arg(command).arg(run))
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text)).concat()
}

/// Bytes of the header and of a row, and their number.
fn layout(record: &Path) -> (u64, u64, u64) {
    let bytes = std::fs::read(record).unwrap();
    let header = 10 + u64::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    // Three seconds and four fades of half a second.
    let rows = 5000;
    (header, (bytes.len() as u64 - header) / rows, rows)
}

fn cut(record: &Path, rows: u64) {
    let (header, row, _) = layout(record);
    let file = OpenOptions::new().write(true).open(record).unwrap();
    file.set_len(header + rows * row).unwrap();
}

#[test]
fn half_a_record_was_a_completed_run() {
    let out = run("half-record");
    cut(&out.join("record.npy"), 2500);
    let report = of("report", &out);
    assert_eq!(report.status.code(), Some(1), "{}", said(&report));
    assert!(said(&report).contains("end unknown: summary.json counts 5000"), "{}", said(&report));
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("how the run ended is not known"));
    let replay = of("replay", &out);
    assert_eq!(replay.status.code(), Some(1), "{}", said(&replay));
    assert!(said(&replay).contains("2500 cycles that summary.json counts"), "{}", said(&replay));
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn rows_of_another_record_are_refused() {
    let (out, other) = (run("one-record"), run("another-record"));
    std::fs::copy(other.join("record.npy"), out.join("record.part02.npy")).unwrap();
    for command in ["report", "replay"] {
        let refused = of(command, &out);
        assert_eq!(refused.status.code(), Some(2), "{command}: {}", said(&refused));
        assert!(said(&refused).contains("found cycle 1 behind cycle 5000"), "{}", said(&refused));
    }
    for folder in [out, other] {
        std::fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn a_replay_of_a_row_from_far_ahead_never_ended() {
    let out = run("far-row");
    let record = out.join("record.npy");
    let (header, row, rows) = layout(&record);
    let mut bytes = std::fs::read(&record).unwrap();
    let last = (header + (rows - 1) * row) as usize;
    bytes[last..last + 8].copy_from_slice(&1_000_000_000_000_u64.to_le_bytes());
    std::fs::write(&record, bytes).unwrap();
    let refused = of("replay", &out);
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    assert!(said(&refused).contains("the row of cycle 1000000000000"), "{}", said(&refused));
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn the_log_and_the_record_of_one_run_are_no_two_tests() {
    let out = run("record-and-log");
    let mut identify = yawbench();
    identify.arg("identify").arg("--train").arg(out.join("record.npy")).arg("--holdout");
    let refused = output(identify.arg(out.join("bus.log")).arg("--out").arg(out.join("found")));
    assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
    assert!(said(&refused).contains("the same run as in"), "{}", said(&refused));
    assert!(!out.join("found").exists());
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_closed_standard_error_hid_the_exit_code() {
    let out = folder("closed-stderr");
    let full = OpenOptions::new().write(true).open("/dev/full");
    let Ok(full) = full else {
        println!("SKIPPED: this machine has no /dev/full");
        return;
    };
    let mut command = yawbench();
    command.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml"));
    command.args(["--pace", "fast", "--duration", "1", "--overwrite", "--out"]).arg(&out);
    let status = command.stdout(full.try_clone().unwrap()).stderr(full).status().unwrap();
    // A full standard output is an error; it is not a panic, and the files are there.
    assert_eq!(status.code(), Some(1));
    assert!(out.join("summary.json").is_file());
    std::fs::remove_dir_all(out).unwrap();
}

#[test]
fn a_format_that_nobody_knows_was_read_as_the_usual_one() {
    let out = run("later-format");
    for file in ["summary.json", "run.json"] {
        let path = out.join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replacen("\"format\": 1", "\"format\": 99", 1)).unwrap();
        for command in ["report", "replay"] {
            let refused = of(command, &out);
            assert_eq!(refused.status.code(), Some(2), "{command}: {}", said(&refused));
            let text = said(&refused);
            assert!(text.contains(file) && text.contains("found format 99"), "{text}");
        }
        std::fs::write(&path, text).unwrap();
    }
    std::fs::remove_dir_all(out).unwrap();
}
