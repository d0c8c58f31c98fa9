//! The page shows of every interlock what the loop itself has found.

use super::*;
use crate::control::{Session, SessionState};
use crate::run::{Terms, in_memory};
use can_protocol::Profile;
use scenario::run::{Overrides, Run};
use std::ops::ControlFlow;
use std::path::Path;

/// The rows of a scenario, its checks, and how far the loop says that each of them has come.
fn run(name: &str, seconds: f64) -> (Vec<Row>, AgreedChecks, Vec<Interlock>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    let overrides = Overrides { duration_s: Some(seconds), speed_kmh: None };
    let run = Run::load(&path, overrides).unwrap();
    let mut rows = Vec::new();
    let take = |row: &Row| {
        rows.push(*row);
        Ok(ControlFlow::Continue(()))
    };
    let close = |session: &Session<'_>, state: &SessionState, _| {
        let ports = session.ports.iter().zip(&state.ports);
        let of_port = ports.flat_map(|(port, memory)| {
            port.reached(memory).map(|reached| interlock(port.slot, &reached))
        });
        (session.agreed_checks(state), of_port.collect())
    };
    let terms = Terms::in_memory(Profile::Classical);
    let found = in_memory(&run, terms, |_| {}, run.cycles(), take, close).unwrap();
    let (checks, reached) = found.expect("a run to its end");
    (rows, checks, reached)
}

#[test]
fn the_rows_give_the_margins_of_the_loop() {
    for name in ["ss9-160kmh.toml", "ss9-slow-rig.toml", "ss9-one-worn-of-four.toml"] {
        let (rows, checks, expected) = run(name, 3.0);
        let mut interlocks = Interlocks::default();
        for row in &rows {
            interlocks.take(row, &checks);
        }
        let found = interlocks.reached(&checks);
        assert!(found.len() == Reached::COUNT && rows.len() > 3000, "{name}");
        assert_eq!(found, expected, "{name}");
        let moved = found.iter().filter(|lock| lock.largest.is_some_and(|largest| largest > 0.0));
        assert!(moved.count() > 6, "{name}: is this test blind?");
    }
}

#[test]
fn a_limit_that_was_passed_is_shown_as_tripped() {
    let (rows, mut checks, _) = run("ss9-160kmh.toml", 1.0);
    let Some(own) = &mut checks[0] else { panic!("no rig in slot 0") };
    own.force.limit = 1.0;
    let mut interlocks = Interlocks::default();
    for row in &rows {
        interlocks.take(row, &checks);
    }
    let found = interlocks.reached(&checks);
    let force = found.iter().find(|lock| lock.check == "force").unwrap();
    assert!(force.has_tripped && force.margin_percent.is_some_and(|margin| margin < 0.0));
    assert!(found.iter().filter(|lock| lock.has_tripped).count() >= 1);
}

#[test]
fn lost_and_damaged_frames_count_as_in_the_loop() {
    let checks = AgreedChecks::from([Some(Checks::usual(15, 1e-3, 40e3)), None, None, None]);
    let mut interlocks = Interlocks::default();
    for cycle in 1..=200 {
        let mut row = Row { cycle, state: RunState::Run, ..Row::default() };
        (row.input[0], row.age_cycles[0]) = (InputKind::Fresh, 1);
        (row.frame[0][0], row.rig_state[0]) = (1, RunState::Run.code());
        match cycle {
            // Nothing came, twice.
            100 | 101 => (row.input[0], row.frame[0][0]) = (InputKind::Missing, 0),
            // It failed its check.
            150 => (row.input[0], row.frame[0][0]) = (InputKind::Invalid, 0),
            _ => {}
        }
        interlocks.take(&row, &checks);
    }
    let found = interlocks.reached(&checks);
    let largest = |key: &str| found.iter().find(|lock| lock.check == key).unwrap().largest;
    assert_eq!(largest("lost_in_a_row"), Some(2.0));
    assert_eq!(largest("lost_of_250"), Some(3.0));
    assert_eq!(largest("age"), Some(1.0));
}
