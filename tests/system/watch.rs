//! The watch over a rig: a damper that wears raises the flag, one that does not never does.

use crate::support::session::{ready, scenario, session};
use can_protocol::{Frame, Residual, Watch};
use firmware_core::damper::effects::ClearanceGrowth;
use firmware_core::damper::{Damper, Effect};
use hil_host::bus::{Bus, BusCounters, MemoryBus, Sent, WireFrame};
use hil_host::clock::Tick;
use hil_host::control::Buses;
use hil_host::record::Queues;
use scenario::run::{Run, SlotForce};
use scenario::watch::Limit;
use std::time::Duration;

/// One damper on a rig at 160 km/h, watched with short times, and `effects` in the mounted damper.
fn watched(effects: &[Effect]) -> Run {
    let mut run = scenario("ss9-one-worn-of-four.toml", 12.0);
    run.rig.damper = Damper::new(*run.rig.damper.nominal(), effects).expect("a possible damper");
    for slot in &mut run.slots {
        if let SlotForce::Rig { watch: Some(watch), virtual_clearance_2a_m, .. } = &mut slot.force {
            (watch.settle_s, watch.learn_s, watch.window_s) = (1.0, 2.0, 1.0);
            watch.limit = Limit::Ratio(3.0);
            *virtual_clearance_2a_m = 0.0;
        }
    }
    run
}

/// What a watch reported in a run.
struct Course {
    /// First cycle with drift.
    raised: Option<u64>,
    learnt_n: f64,
    /// Cycle, residual and measured force of every measurement that the model was compared with.
    compared: Vec<(u64, f64, f64)>,
    /// Residuals sent on the bus.
    sent: Vec<Residual>,
}

/// The bus of the rig, listened to.
struct Tap {
    bus: MemoryBus,
    sent: Vec<Residual>,
}

impl Bus for Tap {
    fn send(&mut self, frame: &Frame) -> Sent {
        self.sent.extend(Residual::decode(frame.id(), frame.data()));
        self.bus.send(frame)
    }
    fn receive(&mut self) -> Option<WireFrame> {
        self.bus.receive()
    }
    fn wait(&mut self, timeout: Duration) -> bool {
        self.bus.wait(timeout)
    }
    fn counters(&self) -> BusCounters {
        self.bus.counters()
    }
}

fn course(run: &Run) -> Course {
    let track = run.track.view();
    let session = session(run, &track);
    let (mut state, [bus]) = ready(run, &session);
    let mut buses = vec![Tap { bus, sent: Vec::new() }];
    let mut queues = Queues::default();
    let (mut recorder, _drain) = queues.split();
    let mut on_bus = Buses::new(&mut buses, &mut recorder);
    let mut course =
        Course { raised: None, learnt_n: f64::NAN, compared: Vec::new(), sent: Vec::new() };
    for _ in 0..run.cycles() {
        let row = session.cycle(&mut state, &mut on_bus, Tick::default());
        if row.drift[0] == Watch::Steady && course.learnt_n.is_nan() {
            course.learnt_n = row.residual_rms_n[0];
        }
        if row.drift[0] == Watch::Drift {
            course.raised.get_or_insert(row.cycle);
        }
        if row.residual_n[0].is_finite() {
            course.compared.push((row.cycle, row.residual_n[0], row.measured_n[0]));
        }
        // The modelled dampers are not watched.
        assert_eq!(row.drift[1..], [Watch::None; 3]);
    }
    course.sent = buses.into_iter().flat_map(|tap| tap.sent).collect();
    course
}

/// The first cycle with drift by the written rule, from the residuals in the record.
fn raised_by_the_rule(compared: &[(u64, f64, f64)]) -> Option<u64> {
    let mean = |values: &[(u64, f64, f64)], of: fn(&(u64, f64, f64)) -> f64| {
        values.iter().map(|row| of(row) * of(row)).sum::<f64>() / values.len() as f64
    };
    let learning = &compared[1000..3000];
    let (residual2, force2) = (mean(learning, |row| row.1), mean(learning, |row| row.2));
    let (mut r2, mut f2) = (residual2, force2);
    for (cycle, residual_n, force_n) in &compared[3000..] {
        r2 += (1.0 - libm::exp(-1e-3)) * (residual_n * residual_n - r2);
        f2 += (1.0 - libm::exp(-1e-3)) * (force_n * force_n - f2);
        if r2 > 9.0 * residual2 * (f2 / force2).max(1.0) {
            return Some(*cycle);
        }
    }
    None
}

#[test]
fn a_sound_damper_never_raises_the_flag() {
    let course = course(&watched(&[]));
    assert_eq!(course.raised, None);
    assert_eq!(raised_by_the_rule(&course.compared), None);
    // Load cell 5 N, displacement sensor 0.2 um at 12.5 MN/m, their resolution, and straight lines
    // over 1 ms, at forces up to 24 kN.
    assert!((4.0..8.0).contains(&course.learnt_n), "{} N", course.learnt_n);
}

#[test]
fn a_damper_that_wears_raises_the_flag_at_its_cycle() {
    // Some micrometres of play more after a decimetre of travel.
    let wear = ClearanceGrowth { growth_per_travel: 5e-5 };
    let course = course(&watched(&[wear.into()]));
    assert_eq!(course.raised, raised_by_the_rule(&course.compared));
    // It changes with the physics and with nothing else, as the trajectory hash does.
    assert_eq!(course.raised, Some(9318));
    // The bus carries a residual every 50 cycles: first drift in cycle 9351.
    assert_eq!(course.sent.len(), 240);
    let drift = course.sent.iter().position(|residual| residual.watch == Watch::Drift);
    assert_eq!(drift, Some(9350 / 50));
    let sequence =
        course.sent.iter().enumerate().all(|(i, residual)| usize::from(residual.counter) == i % 15);
    assert!(sequence && course.sent[0].rms_n.is_none());
}
