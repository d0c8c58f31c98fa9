use super::compensators::OURS;
use super::condition::CONDITIONS;
use super::data_sheet::DataSheet;
use super::errors::Errors;
use super::recording::Recording;
use super::regime::{REGIMES, Regime};
use crate::trip::{Equipped, Rigs};
use scenario::rig::RigSetup;
use scenario::run::{Overrides, Run};
use std::path::Path;
use firmware_core::compensation::Compensator;

#[test]
fn prototype() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    let sheet = DataSheet::of(&Run::load(&path, overrides).unwrap().rig);
    for l in &sheet.0 { println!("{} Hz {:.2} mm gain {:.4} delay {:.3} ms", l.frequency_hz, 1e3*l.stroke_m, l.gain, 1e3*l.delay_s()); }
    println!("{:?} {:?}", sheet.inverse(2), sheet.inverse(3));
    for condition in CONDITIONS {
        let run = Run::load_with(&path, overrides, &condition.settings()).unwrap();
        let equipped = Equipped::of(&run).unwrap();
        let sheet = DataSheet::of(&run.rig);
        println!("{:?} {:?} {:.3} ms", sheet.inverse(2), sheet.inverse(3), 1e3*sheet.delay_s(3.5));
        let band = run.band.unwrap();
        let mut hz = 3.3;
        for regime in [Regime::Hunting, Regime::Track] {
            let speed = match regime { Regime::Track => run.speed_m_per_s, Regime::Hunting => condition.hunting_kmh() / 3.6 };
            let track = regime.track(&band, speed);
            let t0 = std::time::Instant::now();
            let reference = Recording::of(&equipped, regime, &track, speed).unwrap();
            let Some(reference) = reference.and_then(|r| r.observed(hz)) else { println!("no reference {condition:?} {regime:?}"); continue };
            if regime == Regime::Hunting { hz = reference.frequency_hz; }
            println!("{condition:?} {regime:?} {reference:?} {:.2} s", t0.elapsed().as_secs_f64());
            let ideal = Rigs::late_by(&run.rig, 0.0, [true; 4]).unwrap();
            let rigid = Rigs::late_by(&RigSetup { fixture_m_per_n: 0.0, ..run.rig.clone() }, 0.0, [true; 4]).unwrap();
            let _ = ideal; for (name, rigs) in [("ideal rigid", rigid)] {
                let found = Recording::of(&equipped.behind(rigs), regime, &track, speed).unwrap().and_then(|r| r.observed(hz));
                println!("   {name} {:?}", found.map(|f| Errors::of(&f, &reference)));
            }
            for dead in [1, 5, 15] {
                for ours in OURS { if ours == super::compensators::Ours::None { continue; }
                    let rig = RigSetup { delay_cycles: dead, ..run.rig.clone() };
                    let c: Compensator = ours.compensator(&sheet, f64::from(dead) * 1e-3, hz);
                    let t0 = std::time::Instant::now();
                    let found = Recording::of(&equipped.behind(Rigs::compensated(&rig, c, [true; 4])), regime, &track, speed).unwrap().and_then(|r| r.observed(hz));
                    match found {
                        None => println!("   {dead:2} ms {:13} none", ours.name()),
                        Some(f) => { let e = Errors::of(&f, &reference); println!("   {dead:2} ms {:13} work {:7.2} % stroke {:6.2} % phase {:7.3} deg  {:.3} Hz {:.2} s", ours.name(), e.work_percent, e.stroke_percent, e.phase_deg, f.frequency_hz, t0.elapsed().as_secs_f64()); }
                    }
                }
            }
        }
    }
    let _ = REGIMES;
}

#[test]
fn prototype_below() {
    use super::from_below::{Climb, FromBelow};
    use super::ring_down::{Release, RingDown};
    use super::compensators::Ours;
    use crate::critical_speed::{LinearSpeed, Procedure};
    use firmware_core::damper::{Damper, Nominal};
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    let run = Run::load(&path, overrides).unwrap();
    let sheet = DataSheet::of(&run.rig);
    let real = Equipped::of(&run).unwrap();
    let nominal = *real.dampers[0].nominal();
    let maxwell = Damper::new(Nominal { clearance_2a_m: 0.0, f_relief_n: 1e9, ..nominal }, &[]).unwrap();
    let linear = real.clone().with(&maxwell);
    let procedure = Procedure { from_kmh: 150.0, to_kmh: 400.0, ..Procedure::default() };
    let eigen = LinearSpeed::of(&linear, &procedure, 1e-3).unwrap();
    println!("eigen {:?} {:?}", eigen.critical, eigen.frequency_hz);
    for at in &eigen.locus { println!("  {} {:?}", at.kmh, &at.modes[..at.modes.len().min(4)]); }
    let release = Release { offset_m: 1e-3, window_m: [0.02e-3, 0.2e-3], watched_s: 8.0, stroke_limit_m: 10e-3 };
    for kmh in [180.0, 220.0, 240.0, 260.0, 280.0, 300.0, 320.0] {
        for offset_m in [1e-3, 3e-3] {
            println!("  linear {kmh} {offset_m} {:?}", RingDown::of(&linear, &Release { offset_m, ..release }, kmh).unwrap());
        }
    }
    let climb = Climb { from_kmh: 200.0, step_kmh: 5.0, margin: 0.03, release };
    let on_rigs = |e: &Equipped<'static>| e.behind(Rigs::compensated(&RigSetup { delay_cycles: 5, ..run.rig.clone() }, Ours::Inverse.compensator(&sheet, 5e-3, 3.3), [true; 4]));
    for (name, e) in [("modelled", linear.clone()), ("rigs", on_rigs(&linear))] {
        println!("linear {name} {:?}", FromBelow::of(&e, climb).unwrap());
    }
    for window_m in [[0.5e-3, 2.5e-3], [1.0e-3, 3.0e-3]] {
        for offset_m in [4e-3, 6e-3] {
            let climb = Climb { release: Release { offset_m, window_m, ..release }, ..climb };
            for (name, e) in [("modelled", real.clone()), ("rigs", on_rigs(&real))] {
                let f = FromBelow::of(&e, climb).unwrap();
                println!("real {name} {offset_m} {window_m:?} {:?} {:?} {:?}", f.critical_kmh, f.interval_kmh, f.largest_stroke_m);
                for r in f.ring_downs { println!("    {r:?}"); }
            }
        }
    }
}
