//! A rig whose loop has no gain margin is refused before anybody is met.

use crate::interface::{interface, yawbench};
use std::path::Path;

#[test]
fn a_rig_without_a_gain_margin_is_refused_and_nothing_is_written() {
    let Some(vcan) = interface() else { return };
    let scenarios = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let text = std::fs::read_to_string(scenarios.join("ss9-160kmh.toml")).expect("the scenario");
    let vehicle = scenarios.join("vehicles/ss9.toml").display().to_string();
    // A cubic over 50 ms amplifies beyond hunting more than the vehicle yields.
    let compensation = "[slot.compensation]\nkind = \"polynomial\"\ndelay_s = 50e-3\norder = 3\n";
    let text = format!("{}\n{compensation}", text.replace("vehicles/ss9.toml", &vehicle));
    let folder = std::env::temp_dir().join(format!("yawbench-{vcan}-unstable"));
    std::fs::create_dir_all(&folder).expect("a folder");
    let scenario = folder.join("unstable.toml");
    std::fs::write(&scenario, text).expect("a scenario");
    let out = folder.join("run");
    let mut host = yawbench();
    host.arg("run").arg(&scenario).args(["--arm", "--bus", &format!("socketcan:{vcan}")]);
    let output = host.arg("--out").arg(&out).output().expect("the host");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("front left") && message.contains("gain margin"), "{message}");
    assert!(!out.exists(), "{}", out.display());
    std::fs::remove_dir_all(folder).expect("the folder");
}
