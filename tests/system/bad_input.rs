//! Bad input gets one clear line, exit code 2, and nothing is written.

use crate::support::command::{folder, output, repository, yawbench};

/// Runs a scenario text in a folder that also holds the vehicles; returns the error text.
fn refused(name: &str, scenario: &str, vehicle: Option<(&str, &str)>, args: &[&str]) -> String {
    let place = folder(name);
    let vehicles = place.join("vehicles");
    std::fs::create_dir_all(&vehicles).unwrap();
    let ss9 = std::fs::read_to_string(repository().join("scenarios/vehicles/ss9.toml")).unwrap();
    let ss9 = match vehicle {
        Some((from, to)) => {
            assert!(ss9.contains(from), "{from}");
            ss9.replacen(from, to, 1)
        }
        None => ss9,
    };
    std::fs::write(vehicles.join("ss9.toml"), ss9).unwrap();
    std::fs::write(place.join("case.toml"), scenario).unwrap();
    let out = place.join("out");
    let result = output(
        yawbench()
            .arg("run")
            .arg("case.toml")
            .args(["--pace", "fast", "--out"])
            .arg(&out)
            .args(args)
            .current_dir(&place),
    );
    let text = String::from_utf8_lossy(&result.stderr).trim().to_owned();
    assert_eq!(result.status.code(), Some(2), "{name}: {text}");
    assert!(!out.exists(), "{name}: something was written");
    assert!(result.stdout.is_empty(), "{name}: {:?}", result.stdout);
    let errors = text.lines().filter(|line| !line.starts_with("bus ")).count();
    assert_eq!(errors, 1, "{name}: not one line: {text}");
    let _ = std::fs::remove_dir_all(&place);
    text
}

const GOOD: &str =
    "title = \"a case\"\nvehicle = \"vehicles/ss9.toml\"\nspeed_kmh = 160.0\nduration_s = 1.0\n";

fn has(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "no \"{part}\" in: {text}");
    }
}

#[test]
fn unknown_keys_and_wrong_units_are_named_with_file_and_line() {
    let text = refused("unit", &GOOD.replace("speed_kmh", "speed_m_per_s"), None, &[]);
    has(&text, &["case.toml:3", "speed_m_per_s", "speed_kmh"]);
    let text = refused("key", &format!("{GOOD}[damper]\nke_n_per_mm = 12500.0\n"), None, &[]);
    has(&text, &["case.toml:6", "ke_n_per_mm", "ke_n_per_m"]);
    let text = refused("type", &GOOD.replace("160.0", "\"fast\""), None, &[]);
    has(&text, &["case.toml:3", "expected a number"]);
}

#[test]
fn impossible_numbers_are_named_with_file_and_line() {
    let text = refused("mass", GOOD, Some(("value = 65440.0", "value = -65440.0")), &[]);
    has(&text, &["vehicles/ss9.toml:", "mass_kg = -65440", "positive"]);
    let text = refused("inertia", GOOD, Some(("value = 1.481e5", "value = 0.0")), &[]);
    has(&text, &["vehicles/ss9.toml:", "roll_inertia_kg_m2 = 0", "positive"]);
    let text = refused("body", GOOD, Some(("first = \"bogie_front\"", "first = \"bogie\"")), &[]);
    has(&text, &["vehicles/ss9.toml", "\"bogie\"", "bogie_front"]);
    let text = refused("ke", &format!("{GOOD}[damper]\nke_n_per_m = -1.0\n"), None, &[]);
    has(&text, &["case.toml:6", "ke_n_per_m", "-1"]);
    let text = refused("fast", &GOOD.replace("160.0", "1e9"), None, &[]);
    has(&text, &["case.toml:3", "speed_kmh", "600 km/h"]);
    let text = refused("nan", &GOOD.replace("duration_s = 1.0", "duration_s = nan"), None, &[]);
    has(&text, &["case.toml:4", "duration_s", "NaN"]);
}

#[test]
fn a_speed_at_which_creep_is_too_stiff_is_refused() {
    let text = refused("slow", &GOOD.replace("160.0", "20.0"), None, &[]);
    has(&text, &["case.toml:3", "speed_kmh = 20", "at least", "substeps"]);
}

#[test]
fn unknown_effects_are_refused_with_the_catalogue() {
    let effect = "[[damper.effect]]\nname = \"stiction\"\nforce_n = 100.0\n";
    let text = refused("effect", &format!("{GOOD}{effect}"), None, &[]);
    has(&text, &["case.toml", "stiction", "seal_friction", "rubber_hysteresis"]);
}

#[test]
fn places_nodes_and_buses_that_do_not_exist_are_refused() {
    let slot = |rest: &str| format!("{GOOD}[[slot]]\nplace = \"front left\"\non = \"rig\"\n{rest}");
    let text = refused("place", &slot("").replace("front left", "middle"), None, &[]);
    has(&text, &["case.toml", "middle", "front left, front right, rear left, rear right"]);
    let text = refused("node", &slot("node = 9\n"), None, &[]);
    has(&text, &["case.toml", "node = 9", "1 to 4"]);
    let twice = format!("{}{}", slot(""), &slot("")[GOOD.len()..]);
    let text = refused("twice", &twice, None, &[]);
    has(&text, &["front left", "twice"]);
    let wear = "virtual_wear = { clearance_2a_m = 0.001 }\n";
    let text = refused("wear", &slot(wear).replace("\"rig\"", "\"modelled\""), None, &[]);
    has(&text, &["front left", "modelled", "virtual_wear"]);
    let text = refused("soft", &slot("virtual_wear = { stiffness_n_per_m = 5e6 }\n"), None, &[]);
    has(&text, &["case.toml:8", "stiffness_n_per_m = 5000000", "12500000"]);
    let text = refused("pace", &slot(""), None, &["--bus", "socketcan:nobus0"]);
    has(&text, &["pace fast", "memory bus"]);
}

#[test]
fn an_impossible_comparison_is_refused_before_the_run() {
    let text = refused("compare-key", &format!("{GOOD}[compare]\ndampers = {{}}\n"), None, &[]);
    has(&text, &["case.toml:6", "dampers", "`name` or `damper`"]);
    let compare = |damper: &str| format!("{GOOD}[compare.damper]\n{damper}\n");
    let text = refused("compare-damper", &compare("ke_n_per_mm = 1.0"), None, &[]);
    has(&text, &["case.toml:6", "ke_n_per_mm", "ke_n_per_m"]);
    let text = refused("compare-value", &compare("ke_n_per_m = 0.0"), None, &[]);
    has(&text, &["case.toml:6", "ke_n_per_m = 0", "positive"]);
    let text = refused("compare-effect", &compare("effect = [{ name = \"rust\" }]"), None, &[]);
    has(&text, &["case.toml", "rust", "seal_friction"]);
    let text = refused("compare-file", &compare("file = \"no/sheet.toml\""), None, &[]);
    has(&text, &["no/sheet.toml", "cannot be read"]);
    // A vehicle file is no model of a damper.
    let text = refused("compare-other", &compare("file = \"vehicles/ss9.toml\""), None, &[]);
    has(&text, &["vehicles/ss9.toml:", "unknown field", "`damper`"]);
    let coach = repository().join("scenarios/vehicles/manchester-coach.toml");
    let coach = GOOD.replace("\"vehicles/ss9.toml\"", &format!("{coach:?}"));
    let text = refused("compare-none", &format!("{coach}[compare]\n"), None, &[]);
    has(&text, &["case.toml", "[compare]", "no yaw dampers"]);
}

#[test]
fn options_out_of_range_are_named_with_their_range() {
    for (option, found, expected) in [
        ("--slow-down", "0", "a whole number from 1 to 255"),
        ("--slow-down", "300", "a whole number from 1 to 255"),
        ("--bitrate", "0", "a bit rate in bit/s from 1k to 20M, such as 500k or 1M"),
        ("--bus", "can0", "memory or socketcan:INTERFACE"),
    ] {
        let text = refused("option", GOOD, None, &[option, found]);
        has(&text, &[&format!("{option} {found}: expected {expected}")]);
    }
}

#[test]
fn a_missing_file_is_named() {
    let result = output(yawbench().args(["run", "no/such/scenario.toml"]));
    assert_eq!(result.status.code(), Some(2));
    has(&String::from_utf8_lossy(&result.stderr), &["no/such/scenario.toml", "cannot be read"]);
    let text = refused("vehicle", &GOOD.replace("vehicles/ss9", "vehicles/hxd1"), None, &[]);
    has(&text, &["hxd1.toml", "cannot be read"]);
}

#[test]
fn too_much_load_on_a_bus_is_refused_before_the_run() {
    let mut slots: Vec<String> = Vec::new();
    for (node, place) in ["front left", "front right", "rear left", "rear right"].iter().enumerate()
    {
        slots.push(format!("[[slot]]\nplace = \"{place}\"\non = \"rig\"\nnode = {}\n", node + 1));
    }
    let text = refused("load", &format!("{GOOD}{}", slots.concat()), None, &[]);
    has(&text, &["108 %", "80 %", "fd"]);
}

#[test]
fn an_output_folder_that_cannot_be_created_is_bad_input() {
    let place = folder("no-place");
    std::fs::write(place.join("file"), "").unwrap();
    let scenario = repository().join("scenarios/ss9-160kmh.toml");
    let scenario = scenario.to_str().unwrap();
    let run = ["run", scenario, "--pace", "fast", "--duration", "0.01"];
    let speed = ["critical-speed", scenario, "--method", "fold"];
    for command in [&run[..], &speed[..]] {
        let out = ["--out", "file/out"];
        let result = output(yawbench().args(command).args(out).current_dir(&place));
        let text = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{command:?}: {text}");
        has(&text, &["file/out", "no place for a folder"]);
    }
}

/// Command lines that are refused before anything is read, and the whole line that says so.
const REFUSED: [(&[&str], &str); 26] = [
    (&["runn", "a.toml"], "runn: unknown command; did you mean run?"),
    (&["xyz"], "xyz: unknown command; `yawbench --help` lists the commands"),
    (&["--foo"], "--foo: unknown option"),
    (&["run", "a.toml", "--json=1"], "--json 1: expected no value"),
    (&["run"], "<SCENARIO> is missing"),
    (&["run", "a.toml", "b.toml"], "b.toml: unexpected argument"),
    (&["run", "a.toml", "--durtion", "1"], "--durtion: unknown option; did you mean --duration?"),
    (&["run", "a.toml", "--duration"], "--duration: found no value, expected a value"),
    (
        &["run", "a.toml", "--duration", "-1"],
        "--duration -1: expected a duration from 0.001 to 86400 s",
    ),
    (
        &["run", "a.toml", "--duration=1m"],
        "--duration 1m: expected a duration from 0.001 to 86400 s",
    ),
    (
        &["run", "a.toml", "--speed-kmh", "-1e9"],
        "--speed-kmh -1e9: expected a speed over 0 and up to 600 km/h",
    ),
    (
        &["run", "a.toml", "--pace", "fas"],
        "--pace fas: expected one of realtime, lockstep, fast; did you mean fast?",
    ),
    (
        &["run", "a.toml", "--fifo-priority", "300"],
        "--fifo-priority 300: expected a whole number from 0 to 99",
    ),
    (&["run", "a.toml", "--json", "--json"], "--json: given twice, expected once"),
    (&["rig", "--bus", "can0"], "--bus can0: expected memory or socketcan:INTERFACE"),
    (&["rig", "--bus", "memory", "--node", "x"], "--node x: expected a whole number"),
    (&["characterise", "--seed", "-1", "a"], "--seed -1: expected a whole number, 0 or more"),
    (&["characterise", "a.toml", "--from", "b.csv"], "[MODEL]: cannot be used with --from"),
    (&["identify"], "--train <CSV>... is missing"),
    (
        &["identify", "--campaign", "773", "--seed", "1"],
        "identify --campaign: the campaign is a command of its own: `yawbench campaign --cases N --seed S`",
    ),
    (
        &["campaign", "--cases", "0", "--seed", "1"],
        "--cases 0: expected a whole number from 1 to 1000000",
    ),
    (&["campaign", "--cases", "3"], "--seed <S> is missing"),
    (&["campaign", "--cases", "3", "--merge", "a"], "--cases: cannot be used with --merge"),
    (&["simulate", "a.toml", "b.csv"], "--out <CSV> is missing"),
    (&["critical-speed", "a.toml", "--seeds", "x"], "--seeds x: expected a whole number"),
    (&["reproduce", "--seeds", "0"], "--seeds 0: expected 1 to 1000"),
];

#[test]
fn a_wrong_command_line_is_answered_in_one_line() {
    let place = folder("command-line");
    for (args, expected) in REFUSED {
        let result = output(yawbench().args(args).current_dir(&place));
        let text = String::from_utf8_lossy(&result.stderr);
        assert_eq!(text, format!("error: {expected}\n"), "{args:?}");
        assert_eq!(result.status.code(), Some(2), "{args:?}");
        assert!(result.stdout.is_empty(), "{args:?}: {:?}", result.stdout);
        assert_eq!(std::fs::read_dir(&place).unwrap().count(), 0, "{args:?} wrote something");
    }
}

#[test]
fn control_characters_of_the_command_line_do_not_reach_the_terminal() {
    for args in [&["\u{1b}[31mrun"][..], &["run", "a.toml", "--pace", "\u{1b}[31m"]] {
        let result = output(yawbench().args(args));
        let text = String::from_utf8_lossy(&result.stderr);
        assert!(!text.contains('\u{1b}') && text.contains("\\u{1b}[31m"), "{text:?}");
    }
}

#[test]
fn help_names_the_exit_codes() {
    let result = output(yawbench().arg("--help"));
    assert_eq!(result.status.code(), Some(0));
    let text = String::from_utf8_lossy(&result.stdout);
    for line in ["0    done", "1    a check", "2    bad input", "3    the run", "130  interrupted"]
    {
        assert!(text.contains(line), "{line}: {text}");
    }
}
