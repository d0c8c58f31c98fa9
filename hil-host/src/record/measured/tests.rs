//! A log and a record that are written here and read back.

use super::{read_bus_log, read_record};
use crate::bus::WireFrame;
use crate::record::{BusEvent, BusLog, Direction, InputKind, NpyWriter, Row};
use can_protocol::{
    ArmItem, ArmMessage, ArmSide, Measurement, MeasurementFlags, Node, Pace, Profile, RunState,
    Seal, SessionCode, Sync,
};
use measurement::Measurement as Test;
use std::fs::File;
use std::num::{NonZeroU8, NonZeroU16};
use std::path::PathBuf;

fn place(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("yawbench-{}-{name}", std::process::id()))
}

/// Displacement (m) and force (N) of a cycle of 2 ms: 5 mm at 2 Hz.
fn sample(cycle: u64) -> (f64, f64) {
    let angle = std::f64::consts::TAU * 2.0 * cycle as f64 * 2e-3;
    (5e-3 * libm::sin(angle), 9e3 * libm::sin(angle + 0.9))
}

/// A log of 1500 cycles at 500 Hz; `change` may spoil or drop a measurement.
fn log(name: &str, change: impl Fn(u64, &mut Measurement) -> bool) -> PathBuf {
    log_of(name, false, change)
}

/// The same, of rigs that are armed in it where it is sealed.
fn log_of(name: &str, is_sealed: bool, change: impl Fn(u64, &mut Measurement) -> bool) -> PathBuf {
    let path = place(name);
    let mut log =
        BusLog::begin(File::create(&path).unwrap(), 1_700_000_000_000_000_000, vec!["can0".into()]);
    let sync = Sync {
        version: can_protocol::PROTOCOL_VERSION,
        profile: Profile::Classical,
        pace: Pace::Clock,
        period_us: NonZeroU16::new(2000).unwrap(),
        slow_down: NonZeroU8::MIN,
        time_us: 0,
    };
    let event = |time_ns, frame: &can_protocol::Frame| BusEvent {
        time_ns,
        bus: 0,
        direction: Direction::Received,
        frame: WireFrame::from(frame),
    };
    log.write(&[event(0, &sync.encode())]).unwrap();
    let code = SessionCode::of(0x1234_5678, 0xDEAD_BEEF);
    for node in [Node::ALL[0], Node::ALL[1]].into_iter().filter(|_| is_sealed) {
        for (side, item, value) in [
            (ArmSide::Host, ArmItem::HostNumber, 0x1234_5678),
            (ArmSide::Rig, ArmItem::RigNumber, 0xDEAD_BEEF),
            (ArmSide::Rig, ArmItem::Armed, 0),
        ] {
            let (counter, state) = (0, RunState::Standby);
            let message = ArmMessage { side, node, counter, state, item, value };
            log.write(&[event(0, &message.encode().0)]).unwrap();
        }
    }
    let mut counter = 0;
    for cycle in 0..1500 {
        let (x, f) = sample(cycle);
        for node in [Node::ALL[0], Node::ALL[1]] {
            let mut measurement = Measurement {
                node,
                counter,
                state: RunState::Run,
                flags: MeasurementFlags::default(),
                echo: None,
                force_n: Some(f * f64::from(node.number())),
                displacement_m: Some(x),
                time_us: None,
            };
            if change(cycle, &mut measurement) {
                // Up to 0.7 ms late.
                let time_ns = cycle * 2_000_000 + cycle % 8 * 100_000;
                let seal = Seal { code, cycle: cycle as u32 };
                let (frame, _) = if is_sealed {
                    measurement.encode_sealed(Profile::Classical, seal)
                } else {
                    measurement.encode(Profile::Classical)
                };
                log.write(&[event(time_ns, &frame)]).unwrap();
            }
        }
        counter = Profile::Classical.next_counter(counter);
    }
    log.finish().unwrap();
    path
}

#[test]
fn a_bus_log_is_a_test_of_one_node() {
    let path = log("good.log", |_, _| true);
    let series = read_bus_log(&path, Node::ALL[1], None).unwrap();
    assert_eq!((series.time_s.len(), series.repairs.len()), (1500, 0));
    assert_eq!(series.lines[0], 3);
    let test = Test::from_series(series).unwrap();
    assert_eq!((test.step_s, test.direction_declared, test.cycles.len()), (2e-3, true, 6));
    for cycle in 0..1500 {
        let (x, f) = sample(cycle as u64);
        // Half a digit of the wire: 0.2 um, 0.2 N.
        assert!((test.displacement_m[cycle] - x).abs() <= 0.11e-6, "{cycle}");
        assert!((test.force_n[cycle] - 2.0 * f).abs() <= 0.11, "{cycle}");
    }
    let none = read_bus_log(&path, Node::ALL[2], None).unwrap_err().to_string();
    assert!(
        none.ends_with(
            "found no measurement of node 3 in state RUN, expected a log of a run with that rig"
        ),
        "{none}"
    );
    assert!(read_bus_log(&path, Node::ALL[0], Some("can1")).is_err());
    std::fs::remove_file(path).unwrap();
}

#[test]
fn a_log_of_an_armed_session_opens_with_the_numbers_in_it() {
    let sealed = log_of("sealed.log", true, |cycle, measurement| {
        // What holds the armed ram is no test, and no fault.
        if cycle < 3 {
            measurement.state = RunState::Armed;
        }
        cycle != 700
    });
    let series = read_bus_log(&sealed, Node::ALL[1], None).unwrap();
    assert_eq!((series.time_s.len(), series.repairs.len()), (1496, 0));
    assert_eq!(series.lines[0], 1 + 6 + 2 * 3 + 2);
    for (number, time_s) in series.time_s.iter().enumerate() {
        let cycle = if number < 697 { number + 3 } else { number + 4 };
        assert!((time_s - (cycle - 3) as f64 * 2e-3).abs() < 1e-12, "{number}");
        let (x, _) = sample(cycle as u64);
        assert!((series.displacement_m[number] - x).abs() <= 0.11e-6, "{number}");
    }
    // Without the exchange nothing in it can be read.
    let text = std::fs::read_to_string(&sealed).unwrap();
    let late: Vec<&str> = text.lines().skip(7).collect();
    std::fs::write(&sealed, late.join("\n") + "\n").unwrap();
    let blind = read_bus_log(&sealed, Node::ALL[1], None);
    assert!(blind.is_err() || blind.is_ok_and(|series| series.time_s.len() < 20));
    std::fs::remove_file(sealed).unwrap();
}

#[test]
fn lost_and_unusable_frames_are_told_and_keep_their_place() {
    let path = log("lossy.log", |cycle, measurement| {
        match cycle {
            0..20 => measurement.state = RunState::Safe,
            // Two lost, one without force, one repeated counter.
            300 | 301 => return false,
            500 => measurement.force_n = None,
            700 => {
                measurement.counter = Profile::Classical.counter_steps(1, measurement.counter);
            }
            _ => {}
        }
        true
    });
    let series = read_bus_log(&path, Node::ALL[0], None).unwrap();
    assert_eq!(series.time_s.len(), 1500 - 20 - 4);
    assert!((series.time_s.last().unwrap() - 1479.0 * 2e-3).abs() < 1e-12);
    let expected = [
        "1 frames with a wrong CRC, repeated or out of sequence left out",
        "20 frames outside of RUN left out",
        "1 frames without valid force and displacement left out",
    ];
    assert_eq!(series.repairs, expected);
    let test = Test::from_series(series).unwrap();
    assert_eq!(
        test.repairs[3],
        "time_s: 4 missing samples filled in after line 600, 996, 1396, by cubic interpolation"
    );
    assert_eq!(test.len(), 1480);
    for cycle in [299, 300, 301, 500, 700, 1499] {
        let (x, f) = sample(cycle as u64);
        assert!((test.displacement_m[cycle - 20] - x).abs() <= 0.3e-6, "{cycle}");
        assert!((test.force_n[cycle - 20] - f).abs() <= 1.0, "{cycle}");
    }
    // Forty lost: more than two turns of the counter. The frame after them is out of sequence; the
    // next is placed by the clock, and that is too many to fill.
    let path_2 = log("gap.log", |cycle, _| !(600..640).contains(&cycle));
    let series = read_bus_log(&path_2, Node::ALL[0], None).unwrap();
    assert!((series.time_s.last().unwrap() - 1499.0 * 2e-3).abs() < 1e-12);
    let error = Test::from_series(series).unwrap_err().to_string();
    assert!(
        error.contains("gap.log:1204: time_s: found a gap of 0.084000 s, 41 samples"),
        "{error}"
    );
    std::fs::remove_file(path).unwrap();
    std::fs::remove_file(path_2).unwrap();
}

#[test]
fn what_is_no_log_and_no_record_is_refused_with_its_line() {
    let path = place("bad.log");
    std::fs::write(&path, "(1700000000.000000) can0 080#00\ntime,x\n").unwrap();
    let error = read_bus_log(&path, Node::ALL[0], None).unwrap_err().to_string();
    assert!(error.contains("bad.log:2: frame: found"), "{error}");
    let error = read_record(&path, 0).unwrap_err().to_string();
    assert!(
        error.ends_with("found another layout, expected a record.npy of this version"),
        "{error}"
    );
    std::fs::remove_file(path).unwrap();
}

#[test]
fn a_record_gives_every_slot_its_own_signals() {
    let path = place("record.npy");
    let mut writer = NpyWriter::begin(File::create(&path).unwrap()).unwrap();
    for cycle in 0..200_u64 {
        let (x, f) = sample(cycle);
        let mut row = Row { cycle: cycle + 1, time_s: cycle as f64 * 2e-3, ..Row::default() };
        (row.extension_m[0], row.force_n[0]) = (x, f);
        (row.measured_m[3], row.measured_n[3]) = (2.0 * x, 3.0 * f);
        row.input = [InputKind::NoRig; 4];
        row.input[3] = if cycle == 9 { InputKind::Missing } else { InputKind::Fresh };
        writer.write(&[row]).unwrap();
    }
    writer.finish().unwrap();
    let modelled = read_record(&path, 0).unwrap();
    assert_eq!((modelled.displacement_m[50], modelled.force_n[50]), sample(50));
    assert_eq!(modelled.time_s.len(), 200);
    let rig = read_record(&path, 3).unwrap();
    assert_eq!((rig.time_s.len(), rig.lines[9]), (199, 11));
    assert_eq!((rig.displacement_m[49], rig.force_n[49]), (2.0 * sample(50).0, 3.0 * sample(50).1));
    assert_eq!(rig.repairs, ["1 cycles without a fresh measurement left out"]);
    assert!(read_record(&path, 4).is_err());
    std::fs::remove_file(path).unwrap();
}

#[test]
fn what_a_kill_cut_off_is_left_out() {
    let path = log("cut.log", |_, _| true);
    let whole = std::fs::read(&path).unwrap();
    std::fs::write(&path, &whole[..whole.len() - 5]).unwrap();
    let series = read_bus_log(&path, Node::ALL[1], None).unwrap();
    assert_eq!(series.time_s.len(), 1499);
    assert_eq!(series.repairs, ["the last line is cut off and left out"]);
    std::fs::remove_file(path).unwrap();

    let path = place("cut.npy");
    let mut writer = NpyWriter::begin(File::create(&path).unwrap()).unwrap();
    let rows: Vec<Row> = (1..=20).map(|cycle| Row { cycle, ..Row::default() }).collect();
    writer.write(&rows).unwrap();
    drop(writer);
    let file = File::options().write(true).open(&path).unwrap();
    let length = file.metadata().unwrap().len();
    file.set_len(length - 3).unwrap();
    assert_eq!(read_record(&path, 0).unwrap().time_s.len(), 19);
    // A file system that had no time for the rows, but for the size of the file.
    file.set_len(length + 1000).unwrap();
    let read = read_record(&path, 0).unwrap();
    assert!((19..=20).contains(&read.time_s.len()), "{}", read.time_s.len());
    std::fs::remove_file(path).unwrap();
}
