//! The page shows of every interlock what the loop itself has found.

use super::*;
use crate::control::{Session, SessionState};
use crate::run::{Terms, in_memory};
use can_protocol::Profile;
use firmware_core::supervision::CommandLimits;
use scenario::run::{Overrides, Run};
use std::ops::ControlFlow;
use std::path::Path;

/// The rows of a scenario, its limits, how far the loop says that each check has come, and what
/// commands have asked of the rams.
type Judged = (Vec<Row>, AgreedLimits, Vec<Interlock>, [Demand; DAMPER_SLOTS]);

fn run(name: &str, seconds: f64) -> Judged {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios").join(name);
    let overrides = Overrides { duration_s: Some(seconds), ..Overrides::default() };
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
        let demands = state.line.slots.each_ref().map(|memory| memory.demand);
        (session.agreed(state), of_port.collect(), demands)
    };
    let terms = Terms::in_memory(Profile::Classical);
    let found = in_memory(&run, terms, |_| {}, run.cycles(), take, close).unwrap();
    let (agreed, reached, demands) = found.expect("a run to its end");
    (rows, agreed, reached, demands)
}

fn is_of_commands(lock: &Interlock) -> bool {
    lock.check.starts_with("command_")
}

#[test]
fn the_rows_give_the_margins_of_the_loop() {
    for name in ["ss9-160kmh.toml", "ss9-slow-rig.toml", "ss9-one-worn-of-four.toml"] {
        let (rows, agreed, expected, demands) = run(name, 3.0);
        let mut interlocks = Interlocks::default();
        for row in &rows {
            interlocks.take(row, &agreed);
        }
        let (of_commands, found): (Vec<Interlock>, Vec<Interlock>) =
            interlocks.reached(&agreed).into_iter().partition(is_of_commands);
        assert!(found.len() == Reached::COUNT && rows.len() > 3000, "{name}");
        assert_eq!(found, expected, "{name}");
        let actions: Vec<&str> = found.iter().filter_map(|lock| lock.action).collect();
        assert_eq!((actions.len(), actions[0]), (Reached::COUNT, "stop"), "{name}");
        // Where no command was cut, those that were sent have asked for as much as the motion did.
        let slot = of_commands[0].slot;
        let (demand, Agreed { checks, limits, .. }) = (demands[slot], agreed[slot].unwrap());
        let acceleration = demand.speed_change_m_per_s / checks.cycle_s;
        let is_cut = acceleration > limits.acceleration_m_per_s2;
        assert_eq!(is_cut, name == "ss9-one-worn-of-four.toml", "{name}: {acceleration} m/s2");
        let asked = [demand.stroke_m, demand.velocity_m_per_s, acceleration];
        assert_eq!(of_commands.len(), asked.len(), "{name}");
        for (lock, asked) in of_commands.iter().zip(asked) {
            let (largest, limit) = (lock.largest.unwrap(), lock.limit.unwrap());
            let off = if is_cut { largest - limit } else { (largest - asked).abs() };
            assert!(off < 1e-9 * limit, "{name}: {lock:?}, asked {asked}");
            assert!(lock.action == Some("cut") && !lock.has_tripped, "{name}: {lock:?}");
        }
        let moved = found.iter().filter(|lock| lock.largest.is_some_and(|largest| largest > 0.0));
        assert!(moved.count() > 6, "{name}: is this test blind?");
    }
}

#[test]
fn a_limit_that_was_passed_is_shown_as_tripped() {
    let (rows, mut agreed, ..) = run("ss9-160kmh.toml", 1.0);
    let Some(own) = &mut agreed[0] else { panic!("no rig in slot 0") };
    own.checks.force.limit = 1.0;
    let mut interlocks = Interlocks::default();
    for row in &rows {
        interlocks.take(row, &agreed);
    }
    let found = interlocks.reached(&agreed);
    let force = found.iter().find(|lock| lock.check == "force").unwrap();
    assert!(force.has_tripped && force.margin_percent.is_some_and(|margin| margin < 0.0));
    assert!(found.iter().filter(|lock| lock.has_tripped).count() >= 1);
}

#[test]
fn lost_and_damaged_frames_count_as_in_the_loop() {
    let agreed = Agreed {
        checks: Checks::usual(15, 1e-3, 40e3),
        limits: CommandLimits::default(),
        beyond_limits: BeyondLimits::Saturate,
    };
    let agreed = AgreedLimits::from([Some(agreed), None, None, None]);
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
        interlocks.take(&row, &agreed);
    }
    let found = interlocks.reached(&agreed);
    let largest = |key: &str| found.iter().find(|lock| lock.check == key).unwrap().largest;
    assert_eq!(largest("lost_in_a_row"), Some(2.0));
    assert_eq!(largest("lost_of_250"), Some(3.0));
    assert_eq!(largest("age"), Some(1.0));
}
