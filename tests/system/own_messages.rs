//! `yawbench run --dbc` up to its refusal: what is printed, and that nothing is written.

use crate::support::command::{folder, output, repository, yawbench};

const ALL: &str = "no-session,no-crc,no-readiness,no-pressure-off";

/// Runs on the memory bus, where no rig speaks its own messages; what it complains of.
fn refused(name: &str, dbc: &str, map: &str, accept: &str) -> Vec<String> {
    let out = folder(&format!("own-messages-{name}"));
    std::fs::remove_dir_all(&out).unwrap();
    let mut run = yawbench();
    run.current_dir(repository()).args(["run", "scenarios/ss9-160kmh.toml", "--dbc", dbc]);
    run.args(["--dbc-map", map, "--accept", accept, "--out"]).arg(&out);
    let result = output(&mut run);
    let complained = String::from_utf8_lossy(&result.stderr).into_owned();
    assert_eq!((result.status.code(), result.stdout.len()), (Some(2), 0), "{complained}");
    assert!(!out.exists(), "{complained}");
    complained.lines().map(str::to_owned).collect()
}

#[test]
fn losses_are_explained_where_they_are_what_stops_a_run() {
    let servo = |name, accept| {
        let folder = "scenarios/rigs/own-messages";
        refused(name, &format!("{folder}/servo.dbc"), &format!("{folder}/servo-map.toml"), accept)
    };
    let more = format!("{ALL},no-echo");
    let other = servo("other", &more);
    assert_eq!(other.len(), 1, "{other:?}");
    assert!(other[0].contains("found 1 rig(s) on --bus memory"), "{other:?}");

    let unaccepted = servo("unaccepted", "no-crc,no-echo");
    let begins = ["loss ", "no-session ", "no-crc ", "no-readiness ", "no-pressure-off ", "note: "];
    assert_eq!(unaccepted.len(), begins.len() + 1, "{unaccepted:?}");
    let mut pairs = unaccepted.iter().zip(begins);
    assert!(pairs.all(|(line, begin)| line.starts_with(begin)), "{unaccepted:?}");
    assert!(unaccepted[1].contains("any node can command the rig"), "{unaccepted:?}");
    assert!(unaccepted[5].contains("--accept no-echo: not lost"), "{unaccepted:?}");
    assert!(unaccepted[6].ends_with(&format!("expected --accept {ALL}")), "{unaccepted:?}");
}

#[test]
fn a_map_that_does_not_fit_is_one_line() {
    let place = folder("own-messages");
    let examples = repository().join("scenarios/rigs/own-messages");
    let map = std::fs::read_to_string(examples.join("servo-map.toml")).unwrap();
    let wrong = place.join("wrong.toml");
    std::fs::write(&wrong, map.replace("stopped = 0", "stopped = 1.4")).unwrap();
    let dbc = examples.join("servo.dbc");
    let said = refused("wrong", dbc.to_str().unwrap(), wrong.to_str().unwrap(), ALL);
    assert_eq!(said.len(), 1, "{said:?}");
    let expected = "wrong.toml:6: [command] enable: found 1.4, expected a value of SetPoint.Mode: 0 \
                    to 3 in steps of 1";
    assert!(said[0].ends_with(expected), "{said:?}");
    std::fs::remove_dir_all(&place).unwrap();
}
