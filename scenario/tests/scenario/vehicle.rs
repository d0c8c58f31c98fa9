//! Vehicles that are refused, with the reason, and the shipped ones, which are not.

use crate::support::{Folder, shipped};
use scenario::ScenarioError;
use scenario::source::Source;
use scenario::vehicle::VehicleFile;
use std::path::Path;

fn build(path: &Path) -> Result<(), ScenarioError> {
    let source = Source::read(path)?;
    source.parse::<VehicleFile>()?.build(&source).map(|_| ())
}

#[test]
fn every_shipped_vehicle_is_built() {
    for name in ["ss9", "manchester-coach", "cooperrider-bogie"] {
        build(&shipped().join(format!("vehicles/{name}.toml"))).unwrap();
    }
}

/// The coach with another text in its first primary suspension.
fn refused(name: &str, from: &str, to: &str) -> String {
    let text = std::fs::read_to_string(shipped().join("vehicles/manchester-coach.toml")).unwrap();
    assert!(text.contains(from), "{from}");
    let folder = Folder::new(name);
    build(&folder.write("coach.toml", &text.replacen(from, to, 1))).unwrap_err().to_string()
}

/// 13.5 mm above the axle the wheel load drifted by 0.7 kN a second on perfect track.
#[test]
fn a_longitudinal_element_off_the_axle_is_refused_with_the_reason() {
    let height = "height_m = { value = 0.46, provenance = \"estimated\", note = \"at the axle\" }";
    let said = refused("above", height, "height_m = 0.4735");
    let expected = "suspension \"primary\" acts 0.0135 m above the axle of \
                    \"wheelset_1\", expected 0: the wheelset's spin adds up, and with a \
                    longitudinal force off the axle the wheel load would drift";
    assert!(said.ends_with(expected) && said.contains("coach.toml:"), "{said}");
    let element = "[[bump_stop]]\n";
    let slot = "[[damper_slot]]\nplace = \"axle\"\nfirst = \"bogie_front\"\n\
                second = \"wheelset_1\"\nlateral_m = 1.0\nheight_m = 0.5\n[[bump_stop]]\n";
    let said = refused("slot", element, slot);
    assert!(said.contains("damper_slot \"axle\" acts 0.0400 m above the axle"), "{said}");
    let turned = "[[suspension]]\nname = \"turned\"\nfirst = \"wheelset_1\"\n\
                  second = [\"bogie_front\"]\nlateral_m = 1.0\nheight_m = 0.46\n\
                  stiffness_z_n_per_m = 1e6\n[[bump_stop]]\n";
    let said = refused("ahead", element, turned);
    assert!(said.contains("m ahead of the axle of \"wheelset_1\""), "{said}");
}

/// A pitch spring between bogie and wheelset winds up with the spin of the wheelset.
#[test]
fn a_pitch_torsion_on_a_spinning_wheelset_is_refused_with_the_reason() {
    let torsion = |key: &str| {
        format!(
            "[[torsion]]\nname = \"winding\"\nfirst = \"bogie_front\"\n\
             second = [\"wheelset_1\"]\n{key} = 1e5\n[[bump_stop]]\n"
        )
    };
    for key in ["stiffness_pitch_n_m_per_rad", "damping_pitch_n_m_s_per_rad"] {
        let said = refused("winding", "[[bump_stop]]\n", &torsion(key));
        let expected = "torsion \"winding\" acts about the pitch axis of \"wheelset_1\", expected \
                        roll or yaw alone";
        assert!(said.contains(expected) && said.contains("its spin adds up"), "{said}");
    }
    let zero = torsion("stiffness_pitch_n_m_per_rad").replace("1e5", "0.0");
    let text = std::fs::read_to_string(shipped().join("vehicles/manchester-coach.toml")).unwrap();
    let folder = Folder::new("unwound");
    for harmless in [zero, torsion("stiffness_yaw_n_m_per_rad")] {
        let text = text.replacen("[[bump_stop]]\n", &harmless, 1);
        build(&folder.write("coach.toml", &text)).unwrap();
    }
}

/// It used to be reported as a speed that must be at least infinite.
#[test]
fn a_number_far_beyond_any_vehicle_is_refused_where_it_stands() {
    let said = refused("heavy", "mass_kg = {", "mass_kg = 1e308 #");
    let expected = "mass_kg = 1e308, expected a positive number from 0.001 to 10000000";
    assert!(said.ends_with(expected) && said.contains("coach.toml:"), "{said}");
    let said = refused(
        "stiff",
        "[[bump_stop]]\n",
        "[[torsion]]\nname = \"stiff\"\n\
        first = \"carbody\"\nsecond = []\nstiffness_roll_n_m_per_rad = 1e300\n[[bump_stop]]\n",
    );
    assert!(said.ends_with("= 1e300, expected zero or more and at most 1e15"), "{said}");
}
