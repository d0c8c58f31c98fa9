use super::compensators::OURS;
use super::condition::CONDITIONS;
use super::data_sheet::DataSheet;
use super::errors::Errors;
use super::recording::Recording;
use super::regime::{REGIMES, Regime};
use crate::trip::{Equipped, Rigs};
use firmware_core::compensation::Compensator;
use scenario::rig::RigSetup;
use scenario::run::{Overrides, Run};
use std::path::Path;

#[test]
fn prototype() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    let sheet = DataSheet::of(&Run::load(&path, overrides).unwrap().rig);
    for l in &sheet.0 {
        println!(
            "{} Hz {:.2} mm gain {:.4} delay {:.3} ms",
            l.frequency_hz,
            1e3 * l.stroke_m,
            l.gain,
            1e3 * l.delay_s()
        );
    }
    println!("{:?} {:?}", sheet.inverse(2), sheet.inverse(3));
    for condition in CONDITIONS {
        let run = Run::load_with(&path, overrides, &condition.settings()).unwrap();
        let equipped = Equipped::of(&run).unwrap();
        let sheet = DataSheet::of(&run.rig);
        println!(
            "{:?} {:?} {:.3} ms",
            sheet.inverse(2),
            sheet.inverse(3),
            1e3 * sheet.delay_s(3.5)
        );
        let band = run.band.unwrap();
        let mut hz = 3.3;
        for regime in [Regime::Hunting, Regime::Track] {
            let speed = match regime {
                Regime::Track => run.speed_m_per_s,
                Regime::Hunting => condition.hunting_kmh() / 3.6,
            };
            let track = regime.track(&band, speed);
            let t0 = std::time::Instant::now();
            let reference = Recording::of(&equipped, regime, &track, speed).unwrap();
            let Some(reference) = reference.and_then(|r| r.observed(hz)) else {
                println!("no reference {condition:?} {regime:?}");
                continue;
            };
            if regime == Regime::Hunting {
                hz = reference.frequency_hz;
            }
            println!("{condition:?} {regime:?} {reference:?} {:.2} s", t0.elapsed().as_secs_f64());
            let ideal = Rigs::late_by(&run.rig, 0.0, [true; 4]).unwrap();
            let rigid = Rigs::late_by(
                &RigSetup { fixture_m_per_n: 0.0, ..run.rig.clone() },
                0.0,
                [true; 4],
            )
            .unwrap();
            let _ = ideal;
            for (name, rigs) in [("ideal rigid", rigid)] {
                let found = Recording::of(&equipped.behind(rigs), regime, &track, speed)
                    .unwrap()
                    .and_then(|r| r.observed(hz));
                println!("   {name} {:?}", found.map(|f| Errors::of(&f, &reference)));
            }
            for dead in [5] {
                for ours in OURS {
                    if matches!(ours, super::compensators::Ours::None) {
                        continue;
                    }
                    let rig = RigSetup { delay_cycles: dead, ..run.rig.clone() };
                    let c: Compensator = ours.compensator(&sheet, f64::from(dead) * 1e-3, hz);
                    let t0 = std::time::Instant::now();
                    let found = Recording::of(
                        &equipped.behind(Rigs::compensated(&rig, c, [true; 4])),
                        regime,
                        &track,
                        speed,
                    )
                    .unwrap()
                    .and_then(|r| r.observed(hz));
                    match found {
                        None => println!("   {dead:2} ms {:13} none", ours.name()),
                        Some(f) => {
                            let e = Errors::of(&f, &reference);
                            println!(
                                "   {dead:2} ms {:13} work {:7.2} % stroke {:6.2} % phase {:7.3} deg  {:.3} Hz {:.2} s",
                                ours.name(),
                                e.work_percent,
                                e.stroke_percent,
                                e.phase_deg,
                                f.frequency_hz,
                                t0.elapsed().as_secs_f64()
                            );
                        }
                    }
                }
            }
        }
    }
    let _ = REGIMES;
}

#[test]
fn prototype_below() {
    use super::compensators::Ours;
    use super::from_below::{Climb, FromBelow};
    use super::ring_down::{Release, RingDown};
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    for condition in CONDITIONS {
        let run = Run::load_with(&path, overrides, &condition.settings()).unwrap();
        let sheet = DataSheet::of(&run.rig);
        let real = Equipped::of(&run).unwrap();
        let release = Release {
            burst_m: 8e-3,
            burst_hz: 3.4,
            window_m: [1e-3, 4e-3],
            watched_s: 6.0,
            stroke_limit_m: 30e-3,
        };
        for window_m in [[1e-3, 3e-3], [1.0e-3, 5e-3], [2.5e-3, 5e-3], [3e-3, 6e-3]] {
            for kmh in [160.0, 180.0, 200.0, 220.0, 240.0, 250.0] {
                println!(
                    "{condition:?} {window_m:?} {:?}",
                    RingDown::of(&real, &Release { window_m, ..release }, kmh).unwrap()
                );
            }
            let climb = Climb {
                from_kmh: 150.0,
                step_kmh: 5.0,
                margin: 0.03,
                release: Release { window_m, ..release },
            };
            let on_rigs = |e: &Equipped<'static>| {
                e.behind(Rigs::compensated(
                    &RigSetup { delay_cycles: 5, ..run.rig.clone() },
                    Ours::Inverse.compensator(&sheet, 5e-3, 3.4),
                    [true; 4],
                ))
            };
            for (name, e) in [("modelled", real.clone()), ("rigs", on_rigs(&real))] {
                if name == "rigs" && window_m[0] != 2.5e-3 {
                    continue;
                }
                let f = FromBelow::of(&e, climb).unwrap();
                println!(
                    "real {condition:?} {name} {window_m:?} {:?} {:?} {:?} top {:?} n {}",
                    f.critical_kmh,
                    f.interval_kmh,
                    f.largest_stroke_m,
                    f.ring_downs.last().map(|r| r.kmh),
                    f.ring_downs.len()
                );
            }
        }
    }
}

#[test]
fn prototype_settles() {
    use crate::trip::Trip;
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let overrides = Overrides { duration_s: Some(1.0), speed_kmh: None };
    for (condition, speeds) in [
        (CONDITIONS[1], [255.0, 260.0, 265.0, 270.0, 280.0]),
        (CONDITIONS[2], [260.0, 265.0, 270.0, 275.0, 280.0]),
    ] {
        let run = Run::load_with(&path, overrides, &condition.settings()).unwrap();
        let equipped = Equipped::of(&run).unwrap();
        for kmh in speeds {
            let owned = Regime::Hunting.track(&run.band.unwrap(), kmh / 3.6);
            let track = owned.view();
            let trip = Trip::new(&equipped, &track, kmh / 3.6, 2);
            let mut state = trip.begin(&[]).unwrap();
            print!("{condition:?} {kmh}:");
            for _ in 0..20 {
                let (mut s, mut n) = ([0.0; 4], 0.0);
                let ok = trip
                    .go(&mut state, 2.0, |l| {
                        let m = trip.damper_motions(l);
                        for (s, m) in s.iter_mut().zip(m) {
                            *s += m.displacement_m.powi(2);
                        }
                        n += 1.0;
                    })
                    .unwrap();
                if !ok {
                    print!(" off");
                    break;
                }
                print!(
                    " {:.2}/{:.2}",
                    1e3 * (s[0] * 2.0 / n as f64).sqrt(),
                    1e3 * (s[2] * 2.0 / n as f64).sqrt()
                );
            }
            println!();
        }
    }
}

#[test]
fn prototype_full() {
    use super::*;
    use std::sync::atomic::AtomicBool;
    static GO: AtomicBool = AtomicBool::new(false);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml");
    let question = Question::full(1);
    let problem = Problem::load(&path, &question.dampers, &GO).unwrap();
    let t0 = std::time::Instant::now();
    let done = |n: usize, of: usize| {
        if n % 20 == 0 {
            eprintln!("{n} of {of}, {:.0} s", t0.elapsed().as_secs_f64());
        }
    };
    let answer = problem.score(&question, &OURS.map(Candidate::Ours), &GO, &done).unwrap();
    println!("{}", text(&answer));
    println!("{:#?}", answer.from_below);
    println!("{:.0} s", t0.elapsed().as_secs_f64());
}
