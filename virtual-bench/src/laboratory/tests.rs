use super::*;
use crate::bench_visit::sensors::Sensors;
use crate::bench_visit::{self, protocol};
use crate::series_model::{NullGenerator, SeriesModel};

const DAMPER: SeriesModel = SeriesModel {
    ce_n_s_per_m: 1e6,
    ke_n_per_m: 12.5e6,
    clearance_2a_m: 1e-3,
    f_relief_n: 15e3,
    c2_n_s_per_m: 60e3,
};

fn visit(model: SeriesModel, sensors: &Sensors) -> Vec<Measurement> {
    let damper = NullGenerator { model, outside: Vec::new() };
    let records = bench_visit::visit(&damper, &protocol::short(), sensors, 3);
    bench_visit::measurements(&records).unwrap()
}

#[test]
fn a_maxwell_element_has_its_closed_form() {
    let model = SeriesModel { clearance_2a_m: 0.0, f_relief_n: f64::INFINITY, ..DAMPER };
    let figures = Laboratory::of(&visit(model, &Sensors::exact(1000.0)), &[]);
    for test in &figures.tests {
        let (Some(dynamic), Some(hz)) = (&test.dynamic, test.frequency_hz) else { continue };
        // K* = Ke jwT/(1 + jwT), T = Ce/Ke.
        let wt = TAU * hz * 1e6 / 12.5e6;
        let size = 12.5e6 * wt / (1.0 + wt * wt).sqrt();
        let phase = 90.0 - libm::atan(wt).to_degrees();
        assert!((dynamic.stiffness_n_per_m / size - 1.0).abs() < 1e-4, "{}", test.name);
        assert!((dynamic.phase_deg - phase).abs() < 0.02, "{}: {}", test.name, dynamic.phase_deg);
        assert!(dynamic.harmonics[3].force_n < 1e-4 * dynamic.harmonics[1].force_n);
        // W = pi X^2 K''.
        let x = dynamic.amplitude_m;
        let work = std::f64::consts::PI * x * x * dynamic.stiffness_imaginary_n_per_m;
        let found = test.work_per_cycle_j.unwrap();
        assert!((found / work - 1.0).abs() < 2e-3, "{}: {found} {work}", test.name);
    }
    assert_eq!(figures.tests.iter().filter(|test| test.dynamic.is_some()).count(), 6);
}

#[test]
fn the_printed_figures_of_the_working_sine_come_out() {
    // 3.5 Hz, 3.46 mm, 2a = 1 mm: peak 18.45 kN, |F1| 19.00 kN, K' 4.03 MN/m, C 170 kN s/m, 42.8
    // degrees, 140.4 J, worked out for this project by another program to 0.2 %.
    let figures = Laboratory::of(&visit(DAMPER, &Sensors::of_range(50e3, 0.1)), &[]);
    let test = &figures.tests[0];
    let dynamic = test.dynamic.as_ref().unwrap();
    let known = [
        (test.work_per_cycle_j.unwrap(), 140.4),
        (dynamic.harmonics[1].force_n, 19.00e3),
        (dynamic.stiffness_real_n_per_m, 4.03e6),
        (dynamic.damping_n_s_per_m, 170e3),
        (dynamic.phase_deg, 42.8),
    ];
    for (found, expected) in known {
        assert!((found / expected - 1.0).abs() < 4e-3, "{found} and {expected}");
    }
    assert!((test.force_max_n / 18.45e3 - 1.0).abs() < 0.015, "{}", test.force_max_n);
    let third = dynamic.harmonics[3].force_n / dynamic.harmonics[1].force_n;
    assert!((0.03..0.3).contains(&third), "{third}");
    assert!(test.force_mean_n.abs() < 20.0, "{}", test.force_mean_n);
}

#[test]
fn slow_triangles_show_the_curve_of_the_dashpot_and_its_tolerance() {
    let row = |velocity_m_per_s, force: f64| Limit {
        velocity_m_per_s,
        extension_n: Some(force),
        compression_n: Some(0.8 * force),
        tolerance: 0.1,
    };
    let rows = [row(0.015, 15e3), row(0.1, 20.1e3)];
    let figures = Laboratory::of(&visit(DAMPER, &Sensors::of_range(50e3, 0.1)), &rows);
    let point = |name: &str| figures.force_velocity.iter().find(|p| p.test == name).unwrap();
    let slow = point("triangle-5mm-s");
    assert!((slow.velocity_m_per_s - 5e-3).abs() < 2e-5, "{}", slow.velocity_m_per_s);
    assert!((slow.extension_n / 5e3 - 1.0).abs() < 0.01, "{}", slow.extension_n);
    let fast = point("triangle-20mm-s");
    assert!((fast.extension_n / 15.3e3 - 1.0).abs() < 0.01, "{}", fast.extension_n);
    let limit = fast.limit.unwrap();
    assert!((limit.extension_n.unwrap() - 15.3e3).abs() < 20.0);
    // Extension is right, compression a quarter above what the sheet says.
    assert_eq!(fast.within_limit, Some(false));
    assert!(limit.holds(15.3e3, 0.8 * 15.3e3));
    let text = figures.to_string();
    for part in ["OUTSIDE", "extension kN", "J/cycle", "Forces at rest", "sine-10hz-1mm"] {
        assert!(text.contains(part), "no {part} in\n{text}");
    }
}

#[test]
fn rests_are_found_with_their_forces() {
    let figures = Laboratory::of(&visit(DAMPER, &Sensors::of_range(50e3, 0.1)), &[]);
    let ramps = figures.tests.iter().find(|test| test.name == "ramps").unwrap();
    let at: Vec<f64> =
        ramps.holds.iter().map(|hold| (hold.displacement_m * 1e4).round() / 10.0).collect();
    assert_eq!(at, [4.0, -4.0, 4.0, 0.0]);
    // Relaxed: nothing but noise over half a hold of 1.5 s.
    assert!(ramps.holds.iter().all(|hold| hold.force_n.abs() < 20.0), "{:?}", ramps.holds);
    assert!(ramps.dynamic.is_none() && ramps.frequency_hz.is_none());
}

#[test]
fn phases_of_harmonics_are_those_against_the_displacement_wherever_the_record_begins() {
    for begin in [0.0, 0.7, 2.9] {
        let angle = |n: usize| TAU * 0.0351 * n as f64 + begin;
        let x: Vec<f64> = (0..600).map(|n| 2e-3 * libm::sin(angle(n))).collect();
        let force: Vec<f64> = (0..600)
            .map(|n| 900.0 * libm::sin(angle(n) + 0.6) + 100.0 * libm::sin(3.0 * angle(n) - 0.5))
            .collect();
        let dynamic = Dynamic::of(&x, &force, 3.51, 0.01).unwrap();
        assert!((dynamic.phase_deg - 0.6f64.to_degrees()).abs() < 1e-6, "{begin}");
        let third = &dynamic.harmonics[3];
        assert!((third.force_n - 100.0).abs() < 1e-6, "{begin}: {third:?}");
        assert!((third.phase_deg + 0.5f64.to_degrees()).abs() < 1e-6, "{begin}: {third:?}");
    }
}

/// A dashpot of 40 kN s/m that rests for a second, makes three cycles of 1 Hz at each amplitude
/// (mm), and rests again.
fn runs(amplitudes_mm: &[f64]) -> measurement::Measurement {
    let (mut x, mut force) = (Vec::new(), Vec::new());
    for amplitude_mm in amplitudes_mm {
        for n in 0..4000 {
            let t = f64::from(n) * 1e-3 - 1.0;
            let moves = if t < 0.0 { 0.0 } else { 1e-3 * amplitude_mm };
            x.push(moves * libm::sin(TAU * t));
            force.push(40e3 * TAU * moves * libm::cos(TAU * t) + f64::from(n % 7) - 3.0);
        }
    }
    x.extend([0.0; 1000]);
    force.extend((0..1000).map(|n| f64::from(n % 5) - 2.0));
    measurement::Measurement::from_series(measurement::Series::sampled("steps", 1e3, x, force))
        .unwrap()
}

#[test]
fn three_cycles_between_rests_had_no_figures() {
    let figures = Laboratory::of(&[runs(&[10.0])], &[]);
    let test = &figures.tests[0];
    assert!(figures.tests.len() == 1 && test.name == "steps" && test.cycles_used >= 2);
    // pi c w X^2
    let work_j = 0.5 * TAU * 40e3 * TAU * 1e-4;
    assert!((test.work_per_cycle_j.unwrap() / work_j - 1.0).abs() < 2e-3, "{test:?}");
    assert!((test.dynamic.as_ref().unwrap().damping_n_s_per_m / 40e3 - 1.0).abs() < 2e-3);
    let point = &figures.force_velocity[0];
    assert!((point.velocity_m_per_s / (TAU * 0.01) - 1.0).abs() < 0.01, "{point:?}");
    assert!((point.extension_n / 2513.0 - 1.0).abs() < 0.01, "{point:?}");
}

#[test]
fn a_record_with_a_run_for_each_speed_has_a_row_for_each() {
    let figures = Laboratory::of(&[runs(&[10.0, 5.0, 2.5])], &[]);
    let names: Vec<&str> = figures.tests.iter().map(|test| test.name.as_str()).collect();
    assert_eq!(names, ["steps run 1", "steps run 2", "steps run 3"]);
    for (test, amplitude_m) in figures.tests.iter().zip([10e-3, 5e-3, 2.5e-3]) {
        assert!((test.amplitude_m / amplitude_m - 1.0).abs() < 0.01, "{test:?}");
        let work_j = 0.5 * TAU * 40e3 * TAU * amplitude_m * amplitude_m;
        assert!((test.work_per_cycle_j.unwrap() / work_j - 1.0).abs() < 3e-3, "{test:?}");
    }
    let speeds: Vec<f64> = figures.force_velocity.iter().map(|p| p.velocity_m_per_s).collect();
    assert!(speeds.len() == 3 && speeds.is_sorted(), "{speeds:?}");
    assert!(!figures.tests[0].holds.is_empty() && figures.tests[1].holds.is_empty());
}
