//! What a yaw damper and a vehicle usually have: a number far off is run all the same, with a
//! warning.
//!
//! A clearance of 4 m is possible, and takes the damper off; more often it was meant in
//! millimetres. So is a carbody of 65 kg, which was meant in tonnes.

use crate::quantity::Quantity;
use crate::vehicle::{BodyFile, SuspensionFile, VehicleFile};
use files::{number, quoted};
use firmware_core::damper::{Damper, Nominal};

/// The key of a number, how to read it, its usual range.
type Range = (&'static str, fn(&Nominal) -> f64, f64, f64);

/// Around the dampers of locomotives and coaches, with room for worn and for very soft ones.
const RANGES: [Range; 5] = [
    ("ce_n_s_per_m", |nominal| nominal.ce_n_s_per_m, 1e4, 1e7),
    ("ke_n_per_m", |nominal| nominal.ke_n_per_m, 5e5, 1e8),
    ("clearance_2a_m", |nominal| nominal.clearance_2a_m, 0.0, CLEARANCE_MAX_M),
    ("f_relief_n", |nominal| nominal.f_relief_n, 1e3, 1e5),
    ("c2_n_s_per_m", |nominal| nominal.c2_n_s_per_m, 0.0, 1e6),
];

/// Largest usual total clearance (m); the study of worn dampers goes to 8 mm.
const CLEARANCE_MAX_M: f64 = 0.02;

/// Usual masses of a wheelset, and of any other body (kg).
const WHEELSET_KG: [f64; 2] = [300.0, 6e3];
const BODY_KG: [f64; 2] = [300.0, 2e5];
/// Usual stiffness of a suspension (N/m) and damping (N s/m), where it is not zero.
const STIFFNESS_N_PER_M: [f64; 2] = [1e4, 1e9];
const DAMPING_N_S_PER_M: [f64; 2] = [1e2, 1e7];
/// Usual heights above the rail head (m), lateral free play (m) and wheel radii (m).
const HEIGHT_M: [f64; 2] = [0.0, 5.0];
const PLAY_M: [f64; 2] = [0.0, 0.1];
const WHEEL_RADIUS_M: [f64; 2] = [0.15, 1.2];

/// What is unusual about a damper, one line each without the place:
/// `clearance_2a_m = 4, usual are 0 to 0.02: is the unit right?`
pub(crate) fn damper_warnings(damper: &Damper) -> Vec<String> {
    let nominal = damper.nominal();
    let unusual = |(key, read, lowest, highest): &Range| {
        let value = read(nominal);
        // A damper without relief says so on purpose.
        let usual = (*lowest..=*highest).contains(&value) || value.is_infinite();
        (!usual).then(|| line(key, value, *lowest, *highest))
    };
    RANGES.iter().filter_map(unusual).collect()
}

/// What is unusual about wear in software.
pub(crate) fn wear_warning(clearance_2a_m: f64) -> Option<String> {
    let key = "virtual_wear.clearance_2a_m";
    (clearance_2a_m > CLEARANCE_MAX_M).then(|| line(key, clearance_2a_m, 0.0, CLEARANCE_MAX_M))
}

/// What is unusual about a vehicle, one line each with the place:
/// `body carbody: mass_kg = 65.4, usual are 300 to 200000: is the unit right?`
pub(crate) fn vehicle_warnings(file: &VehicleFile) -> Vec<String> {
    let radius = unusual("wheel_radius_m", &file.wheel_rail.wheel_radius_m, WHEEL_RADIUS_M);
    let bodies = file
        .body
        .iter()
        .flat_map(|body| of(&format!("body {}", quoted(&body.name)), body_warnings(body)));
    let suspensions = file.suspension.iter().flat_map(|suspension| {
        of(&format!("suspension {}", quoted(&suspension.name)), suspension_warnings(suspension))
    });
    of("wheel_rail", radius.into_iter().collect())
        .into_iter()
        .chain(bodies)
        .chain(suspensions)
        .collect()
}

fn body_warnings(body: &BodyFile) -> Vec<String> {
    let mass = unusual("mass_kg", &body.mass_kg, if body.wheelset { WHEELSET_KG } else { BODY_KG });
    let height = unusual("height_m", &body.height_m, HEIGHT_M);
    mass.into_iter().chain(height).collect()
}

fn suspension_warnings(file: &SuspensionFile) -> Vec<String> {
    let stiffness = [
        ("stiffness_x_n_per_m", &file.stiffness_x_n_per_m),
        ("stiffness_y_n_per_m", &file.stiffness_y_n_per_m),
        ("stiffness_z_n_per_m", &file.stiffness_z_n_per_m),
    ];
    let damping = [
        ("damping_x_n_s_per_m", &file.damping_x_n_s_per_m),
        ("damping_y_n_s_per_m", &file.damping_y_n_s_per_m),
        ("damping_z_n_s_per_m", &file.damping_z_n_s_per_m),
    ];
    let ranged = stiffness.map(|(key, given)| (key, given, STIFFNESS_N_PER_M));
    let ranged = ranged.into_iter().chain(damping.map(|row| (row.0, row.1, DAMPING_N_S_PER_M)));
    let given = ranged.filter_map(|(key, given, range)| Some((key, given.as_ref()?, range)));
    // Zero is an element that does not act in that direction.
    let rates = given.filter(|(_, given, _)| given.value != 0.0);
    let play = file.play_y_m.iter().filter_map(|play| unusual("play_y_m", play, PLAY_M));
    let height = unusual("height_m", &file.height_m, HEIGHT_M);
    rates
        .filter_map(|(key, given, range)| unusual(key, given, range))
        .chain(play)
        .chain(height)
        .collect()
}

/// Lines with what they are about.
fn of(place: &str, lines: Vec<String>) -> Vec<String> {
    lines.into_iter().map(|line| format!("{place}: {line}")).collect()
}

fn unusual(key: &str, given: &Quantity, [lowest, highest]: [f64; 2]) -> Option<String> {
    let usual = (lowest..=highest).contains(&given.value);
    (!usual).then(|| line(key, given.value, lowest, highest))
}

fn line(key: &str, value: f64, lowest: f64, highest: f64) -> String {
    let [value, lowest, highest] = [value, lowest, highest].map(number);
    format!("{key} = {value}, usual are {lowest} to {highest}: is the unit right?")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Source;
    use std::path::Path;

    const VEHICLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios/vehicles");

    #[test]
    fn a_clearance_in_metres_is_unusual_and_a_new_damper_is_not() {
        let worn = Nominal { clearance_2a_m: 4.0, ..Nominal::NEW };
        let damper = Damper::new(worn, &[]).unwrap();
        let expected = "clearance_2a_m = 4, usual are 0 to 0.02: is the unit right?";
        assert_eq!(damper_warnings(&damper), [expected]);
        assert!(damper_warnings(&Damper::new(Nominal::NEW, &[]).unwrap()).is_empty());
    }

    #[test]
    fn nothing_is_unusual_about_the_vehicles_of_this_repository() {
        let mut vehicles = 0;
        for entry in std::fs::read_dir(VEHICLES).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                let file: VehicleFile = Source::read(&path).unwrap().parse().unwrap();
                assert_eq!(vehicle_warnings(&file), [""; 0], "{}", path.display());
                vehicles += 1;
            }
        }
        assert!(vehicles > 1);
    }

    #[test]
    fn numbers_in_other_units_are_unusual() {
        let ss9 = Path::new(VEHICLES).join("ss9.toml");
        let mut file: VehicleFile = Source::read(&ss9).unwrap().parse().unwrap();
        file.body[0].mass_kg = Quantity::plain(65.44);
        file.suspension[0].stiffness_z_n_per_m = Some(Quantity::plain(1.2));
        file.wheel_rail.wheel_radius_m = Quantity::plain(625.0);
        let said = vehicle_warnings(&file);
        assert_eq!(said.len(), 3, "{said:?}");
        let expected = "wheel_radius_m = 625, usual are 0.15 to 1.2: is the unit right?";
        assert_eq!(said[0], format!("wheel_rail: {expected}"));
        assert!(said[1].starts_with("body ") && said[1].contains("mass_kg = 65.44"), "{said:?}");
        assert!(said[2].contains("stiffness_z_n_per_m = 1.2"), "{said:?}");
    }
}
