//! One wheel under constant load, pushed outward until its flange climbs: the force has no jump.

use super::locomotive::scenario_from;
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::ContactTable;
use firmware_core::wheel_rail::wheel::{Wheel, WheelForce, WheelMotion};
use scenario::contact_geometry::{ContactPair, Placement};
use scenario::profile::{self, Jm3Like, Profile};

const LOAD_N: f64 = 103.0e3;

/// The SS9's wheel, rolling at 20 m/s and turned 3 mrad towards the rail.
fn motion(shift_m: f64, drop_m: f64) -> WheelMotion {
    WheelMotion {
        shift_m,
        drop_m,
        yaw_rad: 3e-3,
        spin_rad_per_s: -20.0 / 0.625,
        speed_m_per_s: 20.0,
        ..WheelMotion::default()
    }
}

/// The force at the drop at which the rail carries the load.
pub(crate) fn under_load(wheel: &Wheel, table: &ContactTable, shift_m: f64) -> WheelForce {
    // Normal forces alone settle the drop, so that creep cannot make it ambiguous.
    let smooth = Wheel { friction: 0.0, ..*wheel };
    let (mut high, mut low) = (-0.05, 0.01);
    for _ in 0..60 {
        let middle = 0.5 * (high + low);
        if -smooth.force(Some(table), &motion(shift_m, middle)).vertical_n < LOAD_N {
            high = middle;
        } else {
            low = middle;
        }
    }
    wheel.force(Some(table), &motion(shift_m, low))
}

/// Largest change of the total force from one shift to the next, and whether both zones carried.
fn sweep(wheel: &Wheel, table: &ContactTable, step_m: f64) -> (f64, bool) {
    let steps = libm::round(5e-3 / step_m) as u32;
    let forces: Vec<WheelForce> =
        (0..=steps).map(|step| under_load(wheel, table, 5e-3 + f64::from(step) * step_m)).collect();
    let jump = |pair: &[WheelForce]| {
        let (x, y, z) = (
            pair[1].longitudinal_n - pair[0].longitudinal_n,
            pair[1].lateral_n - pair[0].lateral_n,
            pair[1].vertical_n - pair[0].vertical_n,
        );
        libm::sqrt(x * x + y * y + z * z)
    };
    let largest = forces.windows(2).map(jump).fold(0.0, f64::max);
    let both = forces.iter().any(|force| force.tread_n > 5e3 && force.flange_n > 5e3);
    let climbs = forces.last().is_some_and(|last| last.flange_n > last.tread_n);
    (largest, both && climbs)
}

#[test]
fn the_force_is_continuous_and_two_patches_carry_for_every_pair() {
    let run = scenario_from(
        "title = \"sweep\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = 160.0\nduration_s = 1.0\n",
    );
    let wheel = run.vehicle.axles[0].wheel;
    let cn = placement(1.353, 0.016);
    let uic = placement(1.360, 0.014);
    let jm3 = profile::jm3_like(&Jm3Like::default()).unwrap();
    let pairs: [(&str, Profile, Profile, Placement); 3] = [
        ("jm3_like on cn60", jm3, profile::cn60(), cn),
        ("lma on cn60", profile::lma(), profile::cn60(), cn),
        ("s1002 on uic60", profile::s1002(), profile::uic60(), uic),
    ];
    for (name, wheel_profile, rail_profile, placement) in pairs {
        let pair = ContactPair::new(&wheel_profile, rail_profile, placement).unwrap();
        let table = ContactTable::new(&pair.tables(), wheel.radius_m, Material::STEEL);
        let (coarse_n, both) = sweep(&wheel, &table, 10e-6);
        let (fine_n, _) = sweep(&wheel, &table, 1.25e-6);
        println!("{name}: {coarse_n:.0} N per 10 um, {fine_n:.0} N per 1.25 um");
        assert!(both, "{name}: tread and flange never carry together");
        // A jump would stay as large as it is; what is continuous shrinks with the step.
        assert!(fine_n < coarse_n / 5.0, "{name}: {coarse_n} N per 10 um, {fine_n} N per 1.25 um");
    }
}

fn placement(back_to_back_m: f64, gauge_depth_m: f64) -> Placement {
    Placement {
        rail_cant: 0.025,
        gauge_m: 1.435,
        gauge_depth_m,
        back_to_back_m,
        tape_circle_m: 0.070,
    }
}
