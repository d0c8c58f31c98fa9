//! Every row of the judgement of a bus, on interfaces that are made up.

use super::*;
use crate::doctor::Verdict::{self, Change, Good, Unknown};
use crate::doctor::{Controller, asks_for_a_change};

const CLASSICAL: Wanted = Wanted { bits_per_s: 1e6, data_bits_per_s: None };
const FD: Wanted = Wanted { bits_per_s: 1e6, data_bits_per_s: Some(5e6) };

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// A controller for FD with nothing to change.
fn sound() -> BusFacts {
    let at = |bits_per_s, point| Some(Timing { bits_per_s, sample_point: Some(point) });
    BusFacts {
        interface: "can0".to_owned(),
        kind: InterfaceKind::Can,
        is_up: true,
        mtu: Some(72),
        queue_frames: Some(10),
        losses: vec![("receive errors".to_owned(), 0)],
        controller: Controller {
            state: Some("ERROR-ACTIVE".to_owned()),
            nominal: at(1e6, 0.8),
            data: at(5e6, 0.75),
            restart_ms: Some(0),
            error_counters: Some((0, 0)),
            modes: words(&["FD", "TDC-AUTO"]),
            known_modes: words(&["FD", "TDC-AUTO", "LISTEN-ONLY"]),
            termination_ohm: Some(120),
            delay_offset: Some(12),
        },
    }
}

fn row(checks: &[Check], what: &str) -> (String, Verdict) {
    let check = checks.iter().find(|check| check.what == what).unwrap();
    assert_eq!(check.advice.is_empty(), check.verdict == Good, "{check:?}");
    (check.found.clone(), check.verdict)
}

#[test]
fn a_sound_interface_has_nothing_to_change_and_only_the_termination_open() {
    for wanted in [CLASSICAL, FD] {
        let checks = judge_bus(&sound(), &wanted);
        assert!(!asks_for_a_change(&checks), "{checks:?}");
        let open = checks.iter().filter(|check| check.verdict == Unknown);
        assert_eq!(open.map(|check| &*check.what).collect::<Vec<_>>(), ["termination"]);
    }
}

#[test]
fn every_row_finds_its_own_fault_and_no_other() {
    type Fault = fn(&mut BusFacts);
    let faults: [(&str, Fault, &str); 16] = [
        ("interface", |bus| bus.is_up = false, "can0 is down"),
        (
            "bit rate",
            |bus| bus.controller.nominal.as_mut().unwrap().bits_per_s = 500e3,
            "500 kbit/s",
        ),
        (
            "sample point",
            |bus| bus.controller.nominal.as_mut().unwrap().sample_point = Some(0.5),
            "50.0 %",
        ),
        ("CAN FD", |bus| bus.mtu = Some(16), "off"),
        ("CAN FD", |bus| bus.controller.modes = words(&["TDC-AUTO"]), "off"),
        ("data bit rate", |bus| bus.controller.data.as_mut().unwrap().bits_per_s = 2e6, "2 Mbit/s"),
        (
            "data sample point",
            |bus| bus.controller.data.as_mut().unwrap().sample_point = Some(0.9),
            "90.0 %",
        ),
        ("transmitter delay compensation", |bus| bus.controller.modes = words(&["FD"]), "off"),
        (
            "special modes",
            |bus| bus.controller.modes = words(&["FD", "TDC-AUTO", "LISTEN-ONLY", "ONE-SHOT"]),
            "LISTEN-ONLY, ONE-SHOT",
        ),
        (
            "restart after bus-off",
            |bus| bus.controller.restart_ms = Some(100),
            "by itself after 100 ms",
        ),
        (
            "controller state",
            |bus| bus.controller.state = Some("ERROR-PASSIVE".to_owned()),
            "ERROR-PASSIVE",
        ),
        (
            "error counters",
            |bus| bus.controller.error_counters = Some((128, 0)),
            "transmit 128, receive 0",
        ),
        ("errors and losses so far", |bus| bus.losses[0].1 = 4, "receive errors 4"),
        ("transmit queue", |bus| bus.queue_frames = Some(1000), "1000 frames"),
        ("transmit queue", |bus| bus.queue_frames = Some(3), "3 frames"),
        ("controller state", |bus| bus.controller.state = Some("BUS-OFF".to_owned()), "BUS-OFF"),
    ];
    for (what, fault, found) in faults {
        let mut bus = sound();
        fault(&mut bus);
        let checks = judge_bus(&bus, &FD);
        assert_eq!(row(&checks, what), (found.to_owned(), Change), "{what}");
        let changes = checks.iter().filter(|check| check.verdict == Change).count();
        assert_eq!(changes, 1, "{what}: {checks:?}");
    }
}

#[test]
fn nothing_of_a_virtual_bus_is_called_can() {
    let bus = BusFacts {
        interface: "vcan0".to_owned(),
        kind: InterfaceKind::Virtual,
        is_up: true,
        mtu: Some(72),
        queue_frames: Some(1000),
        ..BusFacts::default()
    };
    let checks = judge_bus(&bus, &FD);
    assert!(!asks_for_a_change(&checks), "{checks:?}");
    let judged = ["interface", "CAN FD"];
    for check in &checks {
        let is_judged = judged.contains(&&*check.what);
        assert_eq!(check.verdict, if is_judged { Good } else { Unknown }, "{check:?}");
        let is_kind = check.what == "kind";
        assert!(is_judged || is_kind || check.found == VIRTUAL, "{check:?}");
    }
    let short = BusFacts { mtu: Some(16), ..bus };
    assert_eq!(row(&judge_bus(&short, &FD), "CAN FD"), ("off".to_owned(), Change));
}

#[test]
fn a_driver_that_tells_nothing_leaves_the_rows_open() {
    let silent = BusFacts {
        controller: Controller { nominal: sound().controller.nominal, ..<_>::default() },
        losses: Vec::new(),
        queue_frames: None,
        ..sound()
    };
    let checks = judge_bus(&silent, &CLASSICAL);
    assert!(!asks_for_a_change(&checks), "{checks:?}");
    for what in ["restart after bus-off", "controller state", "error counters"] {
        assert_eq!(row(&checks, what), ("-".to_owned(), Unknown));
    }
}

#[test]
fn an_interface_that_is_none_ends_the_list() {
    let absent = BusFacts { interface: "can7".to_owned(), ..BusFacts::default() };
    let checks = judge_bus(&absent, &CLASSICAL);
    assert_eq!(checks.len(), 1);
    assert_eq!(row(&checks, "interface"), ("no can7".to_owned(), Change));
    let other = InterfaceKind::Other("ether".to_owned());
    let checks = judge_bus(&BusFacts { kind: other, ..absent.clone() }, &CLASSICAL);
    assert_eq!(row(&checks, "interface"), ("can7 is of type ether".to_owned(), Change));
    let unread = InterfaceKind::Unread("no ip".to_owned());
    let checks = judge_bus(&BusFacts { kind: unread, ..absent }, &CLASSICAL);
    assert_eq!(row(&checks, "interface"), ("can7".to_owned(), Unknown));
}

#[test]
fn the_command_sets_what_is_wanted_and_keeps_what_is_good() {
    let mut bus = sound();
    bus.controller.restart_ms = Some(100);
    bus.controller.modes.push("LOOPBACK".to_owned());
    assert_eq!(
        set_up_command(&bus, &FD),
        "sudo ip link set can0 down; sudo ip link set can0 type can bitrate 1000000 \
         sample-point 0.800 dbitrate 5000000 dsample-point 0.750 fd on tdc-mode auto loopback \
         off restart-ms 0 && sudo ip link set can0 up"
    );
    bus.controller = Controller::default();
    assert_eq!(
        set_up_command(&bus, &CLASSICAL),
        "sudo ip link set can0 down; sudo ip link set can0 type can bitrate 1000000 \
         sample-point 0.800 && sudo ip link set can0 up"
    );
}
