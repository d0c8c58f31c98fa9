//! `yawbench track-server` and a locomotive that shares no code with it: `track_reader.py`, written
//! from `yawbench.dbc` alone, on a serial line. `tests/vcan/track_server.rs` has both on a CAN bus.

use crate::support::command::{folder, repository, yawbench};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// Reads a track from a server at the other end of a line; what both say. None where there is no
/// Python.
fn read(server: &[&str], reader: &[&str]) -> Option<(Output, Output)> {
    let folder = folder("track-server");
    let line = folder.join("line");
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let mut command = Command::new(python);
    command.arg("-B").arg(repository().join("tests/vcan/track_reader.py"));
    command.arg("--listen").arg(&line).args(reader);
    let started = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut reader = match started {
        Ok(reader) => reader,
        Err(reason) => {
            // Past the capture of the output of a test that passes.
            let _unheard = writeln!(std::io::stderr(), "SKIPPED: no reader of a track: {reason}");
            return None;
        }
    };
    let mut said = BufReader::new(reader.stderr.take()?);
    let mut first = String::new();
    said.read_line(&mut first).unwrap();
    assert!(first.contains("listening"), "{first}");
    let mut command = yawbench();
    command.arg("track-server").arg(repository().join("scenarios/ss9-160kmh.toml"));
    command.arg("--json").arg("--line").arg(&line).args(server);
    let of_server = command.output().unwrap();
    let mut of_reader = reader.wait_with_output().unwrap();
    of_reader.stderr.extend(said.lines().map_while(Result::ok).flat_map(String::into_bytes));
    std::fs::remove_dir_all(folder).unwrap();
    Some((of_server, of_reader))
}

/// Both summaries; both have ended well.
fn summaries(both: &(Output, Output)) -> [Value; 2] {
    [&both.0, &both.1].map(|output| {
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    })
}

#[test]
fn a_reader_written_from_the_document_alone_has_the_track_that_was_offered() {
    let Some(both) = read(&["--duration", "1"], &["--session", "258"]) else { return };
    let [server, reader] = summaries(&both);
    assert_eq!(reader["computed_fingerprint"], reader["fingerprint"]);
    assert_eq!(server["fingerprint"], reader["fingerprint"]);
    assert_eq!(reader["received"], reader["samples"]);
    assert_eq!((&reader["step_um"], &reader["ways"]), (&100_000.into(), &1.into()));
    assert_eq!((&server["samples"], &server["repeated"]), (&reader["samples"], &0.into()));
    assert_eq!((&server["offers"], &reader["refused"]), (&1.into(), &0.into()));
}

#[test]
fn a_reader_that_misses_frames_gets_them_again() {
    let arguments = ["--session", "258", "--drop", "37"];
    let Some(both) = read(&["--duration", "1"], &arguments) else { return };
    let [server, reader] = summaries(&both);
    assert_eq!(reader["computed_fingerprint"], reader["fingerprint"]);
    assert!(server["repeated"].as_u64() > Some(10), "{server}");
}

#[test]
fn a_track_there_and_back_has_no_end() {
    let server = ["--duration", "1", "--there-and-back"];
    let Some(both) = read(&server, &["--session", "1", "--samples", "4500"]) else { return };
    let [server, reader] = summaries(&both);
    // Over the turn, and one way is enough for the fingerprint.
    assert!(reader["samples"].as_u64() < Some(4500), "{reader}");
    assert_eq!((&reader["received"], &reader["ways"]), (&4500.into(), &2.into()));
    assert_eq!(reader["computed_fingerprint"], server["fingerprint"]);
}

#[test]
fn a_track_that_does_not_travel_is_one_line() {
    let scenario = repository().join("scenarios/ss9-160kmh.toml");
    let refused = |arguments: &[&str]| {
        let mut command = yawbench();
        command.arg("track-server").arg(&scenario).args(arguments);
        let output = command.arg("--line").arg(Path::new("/no/such/line")).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let said = refused(&["--duration", "3600", "--there-and-back"]);
    assert!(said.contains("expected at most 262144 for a track there and back"), "{said}");
    assert!(
        said.contains("ss9-160kmh.toml: found 1603909 samples") && said.lines().count() == 1,
        "{said}"
    );
    let said = refused(&["--duration", "1"]);
    assert!(said.contains("line \"/no/such/line\": "), "{said}");
}
