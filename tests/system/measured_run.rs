//! A run is a measurement too: its bus log and its record read back as the test that the rig saw.

use crate::support::command::{folder, output, repository, yawbench};
use can_protocol::Node;
use hil_host::record::measured::{read_bus_log, read_record};
use measurement::{Measurement, noise};

#[test]
fn the_log_and_the_record_of_a_run_hold_the_same_test() {
    let out = folder("measured-run");
    let scenario = repository().join("scenarios/ss9-one-worn-of-four.toml");
    let run = output(
        yawbench()
            .arg("run")
            .arg(scenario)
            .args(["--pace", "fast", "--duration", "4", "--out"])
            .arg(&out),
    );
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let log = read_bus_log(&out.join("bus.log"), Node::new(1).unwrap(), None).unwrap();
    let record = read_record(&out.join("record.npy"), 0).unwrap();
    let (log, record) =
        (Measurement::from_series(log).unwrap(), Measurement::from_series(record).unwrap());
    assert_eq!((log.step_s, record.step_s), (1e-3, 1e-3));
    assert!(log.direction_declared && record.direction_declared);
    assert!(log.len() > 3900 && record.len() > 3900, "{} {}", log.len(), record.len());
    // The last measurement of the log may come after the last cycle of the record, or before.
    let last = *record.force_n.last().unwrap();
    let at = log.force_n.iter().rposition(|force| *force == last).unwrap();
    let common = 3800;
    assert_eq!(
        log.force_n[at + 1 - common..=at],
        record.force_n[record.len() - common..],
        "other forces"
    );
    assert_eq!(
        log.displacement_m[at + 1 - common..=at],
        record.displacement_m[record.len() - common..],
        "other displacements"
    );
    // Under a locomotive no ram rests and no motion repeats: the noise floor is not known.
    assert_eq!(noise::noise(&log).map(|floor| floor.rms_n), None);
    let modelled = Measurement::from_series(read_record(&out.join("record.npy"), 1).unwrap());
    assert!(modelled.unwrap().repairs.is_empty());
    std::fs::remove_dir_all(out).unwrap();
}
