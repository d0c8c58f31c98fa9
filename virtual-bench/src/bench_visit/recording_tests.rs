use super::*;
use crate::bench_visit::{protocol, scaled};
use crate::modelled::Modelled;
use crate::series_model::{NullGenerator, SeriesModel};
use firmware_core::damper::effects::CATALOGUE;
use firmware_core::damper::{Damper, Effect, Nominal};
use signal::statistics::rms;

fn null() -> NullGenerator {
    let model = SeriesModel {
        ce_n_s_per_m: 1e6,
        ke_n_per_m: 12.5e6,
        clearance_2a_m: 1e-3,
        f_relief_n: 15e3,
        c2_n_s_per_m: 60e3,
    };
    NullGenerator { model, outside: Vec::new() }
}

fn modelled() -> Modelled {
    let nominal =
        Nominal { clearance_2a_m: 1e-3, f_relief_n: 15e3, c2_n_s_per_m: 60e3, ..Nominal::NEW };
    Modelled { damper: Damper::new(nominal, &[]).unwrap() }
}

#[test]
fn two_simulators_of_the_same_damper_give_the_same_visit() {
    let sensors = Sensors::exact(1000.0);
    let (own, core) = (null(), modelled());
    for (index, test) in protocol::short().iter().enumerate() {
        let a = record(&own, test, &sensors, 40 + index as u64);
        let b = record(&core, test, &sensors, 40 + index as u64);
        let apart = a.displacement_m.iter().zip(&b.displacement_m).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f64::max) < 1e-15, "{}", test.name);
        let difference: Vec<f64> = a.force_n.iter().zip(&b.force_n).map(|(a, b)| a - b).collect();
        let share = rms(&difference) / rms(&a.force_n);
        assert!(share < 5e-4, "{}: {share}", test.name);
        assert!((a.end_degc - b.end_degc).abs() < 1e-3, "{}", test.name);
    }
}

#[test]
fn the_same_seed_gives_the_same_record_and_another_seed_another() {
    let sensors = Sensors::of_range(50e3, 0.1);
    let test = &protocol::short()[3];
    let first = record(&null(), test, &sensors, 1);
    assert!(first == record(&null(), test, &sensors, 1));
    assert!(first.force_n != record(&null(), test, &sensors, 2).force_n);
    // 1 um and 0.1 % of the range, and the quantiser's share.
    let exact =
        record(&null(), test, &Sensors { anti_alias_hz: Some(400.0), ..Sensors::exact(1e3) }, 1);
    let noise: Vec<f64> = first.force_n.iter().zip(&exact.force_n).map(|(a, b)| a - b).collect();
    assert!((rms(&noise) / 50.0 - 1.0).abs() < 0.05, "{}", rms(&noise));
    let noise: Vec<f64> =
        first.displacement_m.iter().zip(&exact.displacement_m).map(|(a, b)| a - b).collect();
    assert!((rms(&noise) / 1e-6 - 1.0).abs() < 0.05, "{}", rms(&noise));
}

#[test]
fn oil_warms_from_test_to_test_by_the_work_done() {
    let mut sensors = Sensors::exact(1000.0);
    sensors.temperature_noise_k = Some(0.0);
    let tests = vec![protocol::short()[0].clone(); 3];
    let records = visit(&null(), &tests, &sensors, 1);
    // 140 J per cycle at 3.5 Hz into 21 kJ/K.
    let steady_s = tests[0].duration_s - 0.3;
    let expected = 140.4 * 3.5 * steady_s / 21e3;
    let first = records[0].end_degc - LABORATORY_DEGC;
    assert!((first / expected - 1.0).abs() < 0.05, "{first} and {expected}");
    assert!(records[2].end_degc - LABORATORY_DEGC > 2.9 * first);
    let degc = records[1].temperature_degc.as_ref().unwrap();
    assert_eq!(degc.len(), records[1].force_n.len());
    assert!((degc[0] - records[0].end_degc).abs() < 0.01);
}

#[test]
fn a_file_has_the_columns_of_the_project() {
    let mut sensors = Sensors::of_range(50e3, 0.1);
    let mut text = Vec::new();
    record(&null(), &protocol::short()[6], &sensors, 1).write_csv(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("time_s,displacement_m,force_n"));
    let third: Vec<f64> = lines.nth(2).unwrap().split(',').map(|v| v.parse().unwrap()).collect();
    assert_eq!((third.len(), third[0]), (3, 0.002));
    sensors.temperature_noise_k = Some(0.05);
    let mut text = Vec::new();
    record(&null(), &protocol::short()[6], &sensors, 1).write_csv(&mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    assert!(text.lines().next().unwrap().ends_with(",temperature_degc"));
    assert_eq!(text.lines().nth(5).unwrap().split(',').count(), 4);
}

#[test]
fn every_effect_of_the_catalogue_can_be_visited() {
    let scale = Nominal::NEW.scale();
    let test = &protocol::short()[0];
    // Wide enough for a bump stop.
    let sensors = Sensors::of_range(1e6, 0.1);
    for info in CATALOGUE {
        let values: Vec<f64> = info.parameters.iter().map(|row| row.usual(&scale)).collect();
        let effect = Effect::from_values(info.name, &values).unwrap();
        let damper = Modelled { damper: Damper::new(Nominal::NEW, &[effect]).unwrap() };
        let record = record(&damper, test, &sensors, 3);
        assert_eq!(record.doubtful_steps, 0, "{}", info.name);
        let read = record.measurement();
        assert!(read.is_ok(), "{}: {read:?}", info.name);
    }
}

#[test]
fn a_quick_test_of_a_virtual_visit_with_a_late_sensor_was_turned() {
    let late = Effect::from_values("sensor_delay", &[0.01]).unwrap();
    let damper = Modelled { damper: Damper::new(Nominal::NEW, &[late]).unwrap() };
    let visit = visit(&damper, &scaled::brief(1.0), &Sensors::of_range(50e3, 0.1), 4);
    let quick = visit.iter().position(|record| record.name == "sine-quick").unwrap();
    let together = measurements(&visit).unwrap();
    for (record, test) in visit.iter().zip(&together) {
        assert_eq!(record.force_n, test.force_n, "{}", record.name);
    }
    assert!(together[quick].repairs.iter().any(|repair| repair.contains("comes late")));
    assert_eq!(visit[quick].measurement().unwrap().force_n, together[quick].force_n);
}

#[test]
fn a_triangle_of_a_simulation_in_full_digits_was_refused_as_clipped() {
    let triangle =
        scaled::whole(1.0).into_iter().find(|test| test.name == "triangle-wide").unwrap();
    let record = record(&null(), &triangle, &Sensors::exact(1000.0), 1);
    assert!(record.is_flat_but_for_rounding());
    let repairs = record.measurement().unwrap().repairs;
    let is_clipped =
        |repair: &String| repair.starts_with("left as it is") && repair.ends_with("clipped?");
    assert!(repairs.iter().any(is_clipped), "{repairs:?}");
}

#[test]
fn at_high_rates_the_filter_still_acts() {
    let test = &protocol::short()[6];
    for rate_hz in [10e3, 50e3] {
        let filtered = Sensors { anti_alias_hz: Some(0.02 * rate_hz), ..Sensors::exact(rate_hz) };
        let (with, without) = (
            record(&null(), test, &filtered, 1),
            record(&null(), test, &Sensors::exact(rate_hz), 1),
        );
        assert_eq!(with.force_n.len(), without.force_n.len());
        assert!(with.displacement_m != without.displacement_m, "{rate_hz} Hz");
    }
}
