//! Profiles against the files of the Manchester contact benchmark, and their own promises.

use super::rails::head;
use super::*;
use crate::contact_geometry::{PlacedRail, Placement};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Points `(outward, down)` in metres of a benchmark file, or none with a loud note.
fn benchmark_points(file: &str) -> Option<Vec<(f64, f64)>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/profiles");
    let Ok(text) = fs::read_to_string(folder.join(file)) else {
        // Past the test's captured output: a skip is never quiet.
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED: no benchmark profile {file}, its deviation was not checked"
        );
        return None;
    };
    let points = text.lines().skip_while(|line| !line.contains("point.begin")).skip(1);
    let points = points.take_while(|line| !line.contains("point.end"));
    let pair = |line: &str| {
        let mut numbers = line.split_whitespace().map(str::parse::<f64>);
        match (numbers.next(), numbers.next()) {
            (Some(Ok(y_mm)), Some(Ok(z_mm))) => Some((y_mm * 1e-3, z_mm * 1e-3)),
            _ => None,
        }
    };
    Some(points.filter_map(pair).collect())
}

#[test]
fn s1002_is_the_benchmark_profile() {
    let Some(points) = benchmark_points("MBench_S1002_v3.prw") else { return };
    assert!(points.len() > 300);
    let wheel = s1002();
    let mut worst_m = 0.0_f64;
    // The wheel file counts towards the track centre.
    for (inward_m, down_m) in points.iter().filter(|(inward_m, _)| *inward_m < 0.0695) {
        worst_m = worst_m.max((wheel.at(-inward_m).down_m - down_m).abs());
    }
    println!("s1002 deviates by at most {:.4} micrometres", worst_m * 1e6);
    assert!(worst_m < 1e-8, "{worst_m} m");
}

/// Largest distance (m, along the normal) between a placed head and points in any position.
fn deviation_m(rail: &PlacedRail, points: &[(f64, f64)]) -> f64 {
    let (mut shift_m, mut lift_m) = (0.0105, 0.0);
    for _ in 0..20 {
        let (mut a, mut b, mut aa, mut ab, mut n) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (outward_m, down_m) in points {
            let point = rail.at(outward_m + shift_m);
            let miss = down_m - point.down_m - lift_m;
            let weight = 1.0 / (1.0 + point.slope * point.slope);
            a += weight * point.slope * miss;
            b += weight * miss;
            aa += weight * point.slope * point.slope;
            ab += weight * point.slope;
            n += weight;
        }
        let determinant = aa * n - ab * ab;
        shift_m += (a * n - b * ab) / determinant;
        lift_m += (aa * b - ab * a) / determinant;
    }
    let distance = |(outward_m, down_m): &(f64, f64)| {
        let point = rail.at(outward_m + shift_m);
        ((down_m - point.down_m - lift_m) / libm::sqrt(1.0 + point.slope * point.slope)).abs()
    };
    points.iter().map(distance).fold(0.0, f64::max)
}

/// The benchmark's rail is a UIC 60 with other break points; with those it is ours, cant included.
#[test]
fn uic60_is_the_benchmark_rail_up_to_its_break_points() {
    let Some(points) = benchmark_points("MBench_UIC60_v3.prr") else { return };
    let points: Vec<_> = points.into_iter().filter(|(_, down_m)| *down_m < 12.5e-3).collect();
    assert!(points.len() > 200);
    let drawn = PlacedRail::new(uic60(), &Placement::UIC).unwrap();
    let theirs = head("uic60", Provenance::Derived, "", 10.5027e-3, 25.9866e-3);
    let theirs = PlacedRail::new(theirs, &Placement::UIC).unwrap();
    let (drawn_m, theirs_m) = (deviation_m(&drawn, &points), deviation_m(&theirs, &points));
    println!("uic60: {:.2} and {:.2} micrometres", drawn_m * 1e6, theirs_m * 1e6);
    assert!(theirs_m < 2e-6, "{theirs_m} m");
    assert!(drawn_m < 25e-6, "{drawn_m} m");
}

#[test]
fn chains_are_tangent_continuous_and_pass_their_datum() {
    let wheels = [lma(), jm3_like(&Jm3Like::default()).unwrap()];
    for profile in wheels.iter().chain(&[cn60(), uic60()]) {
        assert!(profile.at(0.0).down_m.abs() < 1e-15, "{}", profile.name());
        let joints = profile.breakpoints_m();
        for joint_m in &joints[1..joints.len() - 1] {
            let (inside, outside) = (profile.at(joint_m - 1e-11), profile.at(joint_m + 1e-11));
            let jump_m = (inside.down_m - outside.down_m).abs();
            let bend = (libm::atan(inside.slope) - libm::atan(outside.slope)).abs();
            assert!(jump_m < 2e-9, "{} jumps by {jump_m} m at {joint_m} m", profile.name());
            assert!(bend < 1e-6, "{} bends by {bend} rad at {joint_m} m", profile.name());
        }
    }
}

#[test]
fn lma_has_its_published_radii_and_height() {
    let wheel = lma();
    for (outward_mm, radius_m) in [(-35.0, 0.014), (-20.0, 0.090), (-5.0, 0.450)] {
        let curvature = wheel.at(outward_mm * 1e-3).curvature_per_m;
        assert!((curvature * radius_m - 1.0).abs() < 1e-9, "{outward_mm} mm");
    }
    assert!((wheel.at(20.0e-3).slope + 1.0 / 40.0).abs() < 1e-12);
    // Points of the published cloud: the root within 0.06 mm, the tip within 0.1 mm in height.
    for (outward_mm, down_mm) in [(-33.5, 5.8485), (-34.98, 7.1831), (-36.003, 8.3891)] {
        let miss_mm = wheel.at(outward_mm * 1e-3).down_m * 1e3 - down_mm;
        assert!(miss_mm.abs() < 0.06, "{miss_mm} mm at {outward_mm} mm");
    }
    let tip_m = (0..200).map(|step| wheel.at(-0.060 + 1e-4 * f64::from(step)).down_m);
    assert!((tip_m.fold(0.0, f64::max) - 28.02e-3).abs() < 2e-6);
}

#[test]
fn jm3_like_refuses_what_it_cannot_build() {
    let shape = Jm3Like { small_amplitude_conicity: 0.9, ..Jm3Like::default() };
    let message = jm3_like(&shape).unwrap_err().to_string();
    assert_eq!(message, "small_amplitude_conicity is 0.9, must be within 0.1 and 0.4");
}

#[test]
fn every_profile_says_where_it_comes_from() {
    let shape = jm3_like(&Jm3Like::default()).unwrap();
    let expected = [
        (lma(), Provenance::Derived),
        (s1002(), Provenance::Published),
        (shape, Provenance::Calibrated),
        (cn60(), Provenance::Derived),
        (uic60(), Provenance::Published),
    ];
    for (profile, provenance) in expected {
        assert_eq!(profile.provenance(), provenance, "{}", profile.name());
        assert!(profile.source().len() > 20, "{}", profile.name());
    }
}

/// Writes a CSV into the target folder and hands its path.
fn csv(name: &str, text: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("yawbench-{}-{name}.csv", std::process::id()));
    fs::write(&path, text).unwrap();
    path
}

fn rows_of(profile: &Profile, first_mm: f64, last_mm: f64, noise_um: f64) -> String {
    let mut text = String::from("# sampled\ny_mm, z_mm\n");
    let mut random = 1_u64;
    let mut outward_mm = first_mm;
    while outward_mm < last_mm {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let unit = (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        let down_mm = profile.at(outward_mm * 1e-3).down_m * 1e3 + unit * 2e-3 * noise_um;
        writeln!(text, "{outward_mm:.4},{down_mm:.5}").unwrap();
        outward_mm += 0.1 + 0.1 * (unit + 0.5);
    }
    text
}

#[test]
fn a_wheel_from_points_follows_the_profile_it_was_sampled_from() {
    let truth = s1002();
    for (noise_um, worst_m, worst_curvature) in [(0.0, 9e-6, 0.5), (5.0, 11e-6, 8.0)] {
        let path = csv("wheel", &rows_of(&truth, -62.0, 55.0, noise_um));
        let read = Profile::from_csv(&path, Part::Wheel).unwrap();
        fs::remove_file(&path).unwrap();
        let (mut deviation_m, mut curvature) = (0.0_f64, 0.0_f64);
        for step in -5000..4500 {
            let place_m = f64::from(step) * 1e-5;
            let (got, wanted) = (read.at(place_m), truth.at(place_m));
            let normal = libm::sqrt(1.0 + wanted.slope * wanted.slope);
            deviation_m = deviation_m.max((got.down_m - wanted.down_m).abs() / normal);
            if (-2000..3000).contains(&step) {
                curvature = curvature.max((got.curvature_per_m - wanted.curvature_per_m).abs());
            }
        }
        println!("noise {noise_um}: {:.2} um, curvature {curvature:.2} 1/m", deviation_m * 1e6);
        assert!(deviation_m < worst_m, "{deviation_m} m at noise {noise_um}");
        assert!(curvature < worst_curvature, "{curvature} 1/m at noise {noise_um}");
    }
}

#[test]
fn bad_points_are_named_by_row() {
    let expect = |name: &str, text: &str, part: Part, end: &str| {
        let path = csv(name, text);
        let message = Profile::from_csv(&path, part).unwrap_err().to_string();
        fs::remove_file(&path).unwrap();
        assert!(message.ends_with(end), "{message}");
    };
    let good = rows_of(&s1002(), -62.0, 55.0, 0.0);
    let header = "found `y;z`, expected the header `y_mm,z_mm` or `y_m,z_m`";
    expect("header", "y;z\n1;2\n", Part::Wheel, &format!("row 1: {header}"));
    let cell = good.replacen("-62.0000,", "-62.0000,x", 1);
    expect("cell", &cell, Part::Wheel, "expected a number");
    let back = good.clone() + "54.0,1.0\n";
    expect("back", &back, Part::Wheel, "found y = 54.0, expected y larger than in the row before");
    let gap = good.clone() + "70.0,1.0\n";
    expect("gap", &gap, Part::Wheel, "expected points no further apart than 5 mm");
    expect("few", "y_m,z_m\n0,0\n", Part::Wheel, "found 1 points, expected at least 20 points");
    let up: String = good.replace(",-", ",+").lines().map(flip).collect();
    expect("up", &up, Part::Wheel, "expected z pointing down, the flange at negative y");
    let rail = rows_of(&cn60(), 1.0, 30.0, 0.0);
    expect("rail", &rail, Part::Rail, "expected z pointing down, the crown between the sides");
    let absent = Profile::from_csv(Path::new("/no/such.csv"), Part::Rail).unwrap_err();
    let expected = "/no/such.csv: cannot be read: No such file or directory (os error 2)";
    assert_eq!(absent.to_string(), expected);
}

/// A row with the sign of its second cell turned.
fn flip(row: &str) -> String {
    match row.split_once(',') {
        Some((y, z)) if z.parse::<f64>().is_ok() => format!("{y},-{}\n", z.trim_start_matches('+')),
        _ => format!("{row}\n"),
    }
}

#[test]
fn a_rail_from_points_is_the_rail() {
    let path = csv("rail", &rows_of(&cn60(), -35.0, 35.0, 0.0));
    let read = Profile::from_csv(&path, Part::Rail).unwrap();
    fs::remove_file(&path).unwrap();
    let truth = cn60();
    for step in -300..=300 {
        let place_m = f64::from(step) * 1e-4;
        let miss_m = read.at(place_m).down_m - truth.at(place_m).down_m;
        assert!(miss_m.abs() < 6e-6, "{miss_m} m at {place_m} m");
    }
}
