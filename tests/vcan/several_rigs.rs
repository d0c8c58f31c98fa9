//! Two rigs on one interface, one of which is killed in RUN, as processes of their own.
//! `hil-host/tests/bench/several_rigs.rs` has the same in virtual time, with exact cycles.

use crate::rig::{MEASUREMENT, Rig, alone, assert_replays, hear, host_of, listener, out, summary};
use std::process::Stdio;

/// A rig on a node; it stays when its host has gone.
fn args(node: &str) -> [&str; 4] {
    ["--node", node, "--fifo-priority", "0"]
}

#[test]
fn the_vehicle_goes_on_without_a_rig_that_is_killed_and_says_so() {
    let Some((vcan, _turn)) = alone() else { return };
    let [killed, other] = ["1", "2"].map(|node| Rig::start(&vcan, &args(node)));
    let socket = listener(&vcan);
    let (bus, folder) = (format!("socketcan:{vcan}"), out(&vcan, "two-rigs-one-lost"));
    let options = ["--pace", "lockstep", "--overwrite"];
    let host = host_of("ss9-two-rigs-partner.toml", &bus, "6", &folder, &options)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the host");
    // RUN begins after a thousand cycles.
    assert_eq!(hear(&socket, MEASUREMENT, 2000).len(), 2000, "the run did not start");
    drop(killed);
    let host = host.wait_with_output().expect("the host");
    let end = summary(&host);
    let said = String::from_utf8_lossy(&host.stderr);
    assert_eq!(host.status.code(), Some(1), "{said}");
    assert_eq!((&end["state"], &end["steps"]), (&"completed".into(), &6000.into()), "{end}");
    let lost = &end["drop_outs"][0];
    assert_eq!(
        (&lost["place"], &lost["node"], &lost["signal"]),
        (&"front left".into(), &1.into(), &"silent_rig".into()),
        "{end}"
    );
    println!("{}", lost["message"]);
    assert_eq!(end["not_held"][0], lost["message"]);
    let from = |slot: usize| end["damper"][slot]["model_from_s"].as_f64();
    // The partner of the lost rig too, and the other bogie to the end on its rig.
    assert!(from(0).is_some_and(|time_s| time_s > 0.9) && from(0) == from(1), "{end}");
    assert_eq!((from(2), from(3)), (None, None));
    assert_replays(&folder);
    let rig = other.interrupt();
    // Ramped out, and free for the next host.
    assert_eq!((&rig["runs"], &rig["safe_events"]), (&1.into(), &0.into()), "{rig}");
    let _ = std::fs::remove_dir_all(folder);
}
