//! A locomotive at 160 km/h with one damper on a rig, or several.

use can_protocol::{Node, Pace, Profile};
use firmware_core::track::Track;
use hil_host::control::{Arming, Port, Session};
use scenario::run::{ForceLimit, IfRigDropsOut, Overrides, Rate, Run, Slot, SlotForce};
use scenario::source::Source;
use std::num::NonZeroU8;
use std::path::Path;

/// The rig.
pub(crate) const NODE: Node = Node::ALL[0];

/// Five seconds of it.
pub(crate) fn scenario() -> Run {
    scenario_with("")
}

/// The same with further tables in its file.
pub(crate) fn scenario_with(tables: &str) -> Run {
    lasting(5.0, tables)
}

/// The same for so long (s).
pub(crate) fn lasting(duration_s: f64, tables: &str) -> Run {
    overridden(Overrides { duration_s: Some(duration_s), ..Overrides::default() }, tables)
}

/// The same at a rate.
pub(crate) fn at_rate(rate: Rate, duration_s: f64) -> Run {
    let (duration_s, rate) = (Some(duration_s), Some(rate));
    overridden(Overrides { duration_s, rate, ..Overrides::default() }, "")
}

fn overridden(overrides: Overrides, tables: &str) -> Run {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let source = Source::from_text(&path, &format!("{text}\n{tables}"));
    Run::from_source(&source, overrides).unwrap_or_else(|error| panic!("{error}"))
}

/// The frames that a run has.
pub(crate) fn profile(run: &Run) -> Profile {
    if run.rate == Rate::Usual { Profile::Classical } else { Profile::Fd }
}

/// Its control session; classical frames at the usual rate, CAN FD above.
pub(crate) fn session<'a>(run: &'a Run, track: &'a Track<'a>, pace: Pace) -> Session<'a> {
    let profile = profile(run);
    let force_n = match run.plausibility.force {
        ForceLimit::Force(force_n) => force_n,
        ForceLimit::Ratio(_) => 100e3,
    };
    let checks = run.plausibility.checks(profile.counter_modulus(), force_n);
    let port = |(slot, place): (usize, &Slot)| {
        let SlotForce::Rig { node, if_drops_out, .. } = place.force else { return None };
        let port = Port::new(Node::new(node).unwrap(), 0, slot, profile).unwrap();
        let port = port.checked(checks, run.motion.beyond_limits);
        Some(if if_drops_out == IfRigDropsOut::Model { port.dropping_out() } else { port })
    };
    Session {
        line: hil_host::run::line(run, track),
        ports: run.slots.iter().enumerate().filter_map(port).collect(),
        profile,
        pace,
        slow_down: NonZeroU8::MIN,
        arming: Arming::in_memory().requiring(&run.readiness),
        delay_gate: None,
        watched: [Some(0), Some(1), Some(3)],
        rear_bogie: Some(2),
    }
}
