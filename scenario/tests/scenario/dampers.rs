//! What a run says about its dampers: the title that it computes, and what is unusual about them.

use crate::support::{Folder, shipped};
use scenario::run::{Overrides, Run};
use std::fs;

fn load(name: &str) -> Run {
    Run::load(&shipped().join(name), Overrides::default()).unwrap()
}

/// A run on perfect track with something more; the title is the program's.
fn run(more: &str) -> Run {
    let folder = Folder::new("dampers");
    let vehicle = shipped().join("vehicles/ss9.toml");
    let text =
        format!("vehicle = \"{}\"\nspeed_kmh = 160.0\nduration_s = 1.0\n{more}", vehicle.display());
    let path = folder.write(&format!("{:x}.toml", more.len()), &text);
    Run::load(&path, Overrides::default()).unwrap()
}

#[test]
fn titles_of_the_shipped_scenarios_are_computed_from_their_dampers() {
    assert_eq!(load("ss9-160kmh.toml").title, "SS9 at 160 km/h, all yaw dampers as new");
    assert_eq!(
        load("ss9-worn-2a-4mm.toml").title,
        "SS9 at 160 km/h, all yaw dampers with 2a = 4 mm"
    );
    assert_eq!(
        load("ss9-one-worn-of-four.toml").title,
        "SS9 at 160 km/h, yaw dampers as new, front left as new plus 3.8 mm of clearance in software"
    );
    // A title that is given is kept.
    assert!(load("ss9-curve-400m.toml").title.starts_with("SS9 through a curve"));
}

/// The recipe of the README puts another damper into a shipped scenario.
#[test]
fn an_edited_damper_is_not_titled_as_new() {
    let folder = Folder::new("recipe");
    let text = fs::read_to_string(shipped().join("ss9-160kmh.toml")).unwrap();
    let (before, _) = text.split_once("[damper]").unwrap();
    let vehicles = format!("\"{}/vehicles", shipped().display());
    let before = before.replace("\"vehicles", &vehicles);
    let effect = "[[damper.effect]]\nname = \"asymmetric_damping\"\ndamping_asymmetry = 0.05\n\
                  relief_asymmetry = 0.05\n";
    folder.write("model.toml", &format!("[damper]\n{effect}"));
    let path = folder.write("run.toml", &format!("{before}[damper]\nfile = \"model.toml\"\n"));
    let run = Run::load(&path, Overrides::default()).unwrap();
    assert_eq!(run.title, "SS9 at 160 km/h, all yaw dampers with asymmetric damping");
    assert!(!run.effective.scenario.contains("title"), "{}", run.effective.scenario);
    // Another speed is another title.
    let faster = Overrides { speed_kmh: Some(200.0), ..Overrides::default() };
    let faster = Run::load(&path, faster).unwrap();
    assert_eq!(faster.title, "SS9 at 200 km/h, all yaw dampers with asymmetric damping");
    assert_eq!(
        self::run("[[slot]]\nplace = \"rear left\"\non = \"modelled\"\ndamper.ke_n_per_m = 5e6\n")
            .title,
        "SS9 at 160 km/h, yaw dampers as new, rear left with Ke = 5.0 MN/m"
    );
}

#[test]
fn a_clearance_of_four_metres_passes_with_a_warning() {
    assert_eq!(load("ss9-worn-2a-4mm.toml").warnings, Vec::<String>::new());
    let all = run("[damper]\nclearance_2a_m = 4.0\n");
    assert_eq!(
        all.warnings,
        [
            "front left, front right, rear left, rear right: clearance_2a_m = 4, usual are 0 to 0.02: \
          is the unit right?"
        ]
    );
    let one =
        run("[[slot]]\nplace = \"rear left\"\non = \"modelled\"\ndamper.ce_n_s_per_m = 1e3\n\
                   damper.c2_n_s_per_m = 10\ndamper.f_relief_n = 11.1\n");
    assert_eq!(one.warnings.len(), 2, "{:?}", one.warnings);
    assert!(one.warnings[0].starts_with("rear left: ce_n_s_per_m = 1000, "), "{:?}", one.warnings);
    let rig = run("[[slot]]\nplace = \"rear left\"\non = \"rig\"\n\
                   virtual_wear = { clearance_2a_m = 3.8 }\n[compare]\ndamper.ke_n_per_m = 12.5\n");
    assert_eq!(rig.warnings.len(), 2, "{:?}", rig.warnings);
    assert!(rig.warnings[0].starts_with("rear left: virtual_wear.clearance_2a_m = 3.8, "));
    assert!(rig.warnings[1].starts_with("the other damper: ke_n_per_m = 12.5, "));
    // A damper without relief is meant so.
    assert!(run("[damper]\nf_relief_n = inf\n").warnings.is_empty());
}
