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
    let text = refused("soft", &slot("virtual_wear = { stiffness_n_per_m = -5e6 }\n"), None, &[]);
    has(&text, &["case.toml:8", "stiffness_n_per_m = -5000000"]);
    let text = refused("arm", &slot(""), None, &["--bus", "socketcan:nobus0"]);
    has(&text, &["no terminal and no --arm", "key a"]);
    let text = refused("pace", &slot(""), None, &["--arm", "--bus", "socketcan:nobus0"]);
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
const REFUSED: [(&[&str], &str); 42] = [
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
    (&["rig-reset"], "--bus <BUS> is missing"),
    (&["rig-reset", "--bus", "socketcan:can0", "--node", "9"], "--node 9: expected 1 to 4"),
    (
        &["rig-reset", "--bus", "memory"],
        "--bus memory: expected socketcan:INTERFACE: rigs in memory begin anew with every run",
    ),
    (&["track-server", "a.toml"], "--bus: expected socketcan:INTERFACE, or --line SOCKET"),
    (
        &["track-server", "a.toml", "--bus", "memory"],
        "--bus memory: expected socketcan:INTERFACE, where a locomotive can hear it",
    ),
    (
        &["track-server", "a.toml", "--bus", "socketcan:can0", "--line", "l"],
        "--bus: cannot be used with --line",
    ),
    (&["characterise", "--seed", "-1", "a"], "--seed -1: expected a whole number, 0 or more"),
    (&["characterise", "a.toml", "--from", "b.csv"], "[MODEL]: cannot be used with --from"),
    (&["identify"], "--train <FILE>... is missing"),
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
    (&["ride", "a.toml", "--floor-m", "1e300"], "--floor-m 1e300: expected 0 to 6"),
    (&["curve", "a.toml", "--k1", "1e-300", "--seeds", "0"], "--seeds 0: expected 1 to 1000"),
    (&["curve", "a.toml", "--k1", "1e300"], "--k1 1e300: expected more than 0 and at most 1"),
    (
        &["critical-speed", "a.toml", "--stroke-mm", "1,,2"],
        "--stroke-mm: found an empty value, expected a number",
    ),
    (&["ride", "a.toml", "--shard", "-1/4"], "--shard -1/4: expected part/parts, such as 1/4"),
    (
        &["rig", "--bus", "memry"],
        "--bus memry: expected memory or socketcan:INTERFACE; did you mean memory?",
    ),
    (
        &["rig", "--bus", "soketcan:can1"],
        "--bus soketcan:can1: expected memory or socketcan:INTERFACE; did you mean socketcan:can1?",
    ),
    (
        &["characterise", "a.toml", "--tests", "shrt"],
        "--tests shrt (cannot be read as a file): expected full, short or the file of a list; did you mean short?",
    ),
    (
        &["ride", "a.toml", "--vary", "a=1,2", "--vary", "a=3"],
        "`a` is varied twice, expected each key once",
    ),
    (
        &["ride", "a.toml", "--vary", "a=1:2:1000000"],
        "--vary: 1000000 points of 5 tracks each: expected at most 20000 in one command; --shard \
         1/50 computes a part of them",
    ),
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
fn too_many_points_are_counted() {
    let axes = ["--vary", "a=1:2:1001", "--vary", "b=1:2:1000"];
    let result = output(yawbench().args(["ride", "a.toml"]).args(axes));
    assert_eq!(result.status.code(), Some(2));
    let text = String::from_utf8_lossy(&result.stderr);
    has(&text, &["found 1001000 points of all keys together, expected at most 1000000"]);
}

#[test]
fn numbers_of_any_size_are_short_in_a_message() {
    let text = refused("tiny", GOOD, None, &["--speed-kmh", "1e-300"]);
    has(&text, &["--speed-kmh 1e-300: expected at least 88 at 4 substeps"]);
    let text = refused("huge", &GOOD.replace("160.0", "1e300"), None, &[]);
    has(&text, &["case.toml:3: speed_kmh = 1e300, expected"]);
    let text = refused("whole", &GOOD.replace("\"a case\"", "1e300"), None, &[]);
    has(&text, &["case.toml:1: found the number `1e300`, expected a text"]);
    let text = refused("mass", GOOD, Some(("value = 65440.0", "value = 1e308")), &[]);
    has(&text, &["vehicles/ss9.toml:", "mass_kg = 1e308, expected a positive number from 0.001"]);
}

#[test]
fn types_of_the_program_do_not_reach_the_user() {
    let text = refused("struct", &format!("{GOOD}damper = 3\n"), None, &[]);
    has(&text, &["case.toml:5: found the number `3`, expected a table"]);
    let rough = format!("{GOOD}[track]\nirregularity = {{ aar6 = 3 }}\n");
    let text = refused("variant", &rough, None, &[]);
    has(&text, &["case.toml:6: found the number `3`, expected a table"]);
    let node = format!("{GOOD}[[slot]]\nplace = \"front left\"\non = \"rig\"\nnode = 300\n");
    let text = refused("u8", &node, None, &[]);
    has(&text, &["case.toml:8: found the number `300`, expected a whole number from 0 to 255"]);
}

#[test]
fn a_similar_name_is_suggested() {
    let text = refused("key", &GOOD.replace("speed_kmh", "sped_kmh"), None, &[]);
    has(&text, &["unknown field `sped_kmh`", "; did you mean `speed_kmh`?"]);
    let rough = format!("{GOOD}[track]\nirregularity = {{ aar = {{}} }}\n");
    let text = refused("variant", &rough, None, &[]);
    has(&text, &["unknown variant `aar`, expected `aar6` or `csv`; did you mean `aar6`?"]);
    let effect = "[[damper.effect]]\nname = \"seal_fricton\"\nforce_n = 100.0\n";
    let text = refused("effect", &format!("{GOOD}{effect}"), None, &[]);
    has(&text, &["; did you mean seal_friction?"]);
    let slot = "[[slot]]\nplace = \"front lft\"\non = \"rig\"\n";
    let text = refused("place", &format!("{GOOD}{slot}"), None, &[]);
    has(&text, &["; did you mean front left?"]);
    let text = refused("vehicle", &GOOD.replace("ss9.toml", "ss9.tml"), None, &[]);
    has(&text, &["ss9.tml: cannot be read", "did you mean", "ss9.toml?"]);

    let scenario = repository().join("scenarios/ss9-160kmh.toml");
    let scenario = scenario.to_str().unwrap();
    for (args, expected) in [
        (&["run", &scenario.replace(".toml", ".tml")][..], "ss9-160kmh.toml?"),
        (&["reproduce", "--figure", "10x", "--scenario", scenario], "; did you mean 10"),
        (&["ride", scenario, "--vary", "damper.ke_n_per_mm=1,2"], "did you mean `ke_n_per_m`?"),
        (
            &["ride", scenario, "--vary", "vehicle.body.bogie_frnt.mass_kg=1,2"],
            "or *; did you mean bogie_front?",
        ),
    ] {
        let place = folder("similar");
        let result = output(yawbench().args(args).current_dir(&place));
        let text = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{args:?}: {text}");
        has(&text, &[expected]);
    }
}

#[test]
fn a_step_that_is_too_coarse_is_answered_with_the_substeps_that_are_enough() {
    let text = refused("coarse", GOOD, None, &["--speed-kmh", "80"]);
    has(&text, &["--speed-kmh 80: expected at least 88 at 4 substeps", "; substeps = 5 is enough"]);
    let text = refused("slowest", &GOOD.replace("160.0", "0.1"), None, &[]);
    assert!(!text.contains("is enough"), "{text}");
}

#[test]
fn a_negative_clearance_in_software_is_refused() {
    let slot = "[[slot]]\nplace = \"front left\"\non = \"rig\"\n\
                virtual_wear = { clearance_2a_m = -1e-3 }\n";
    let text = refused("negative", &format!("{GOOD}{slot}"), None, &[]);
    has(&text, &["case.toml:8: clearance_2a_m = -0.001, expected zero or more"]);
}

#[test]
fn a_processor_that_does_not_exist_is_refused() {
    let text = refused("cpu", GOOD, None, &["--cpu", "99999"]);
    has(&text, &["--cpu 99999: expected", "processor of this machine"]);
}

#[test]
fn a_socket_is_named_as_such() {
    let place = folder("socket");
    let _bound = std::os::unix::net::UnixListener::bind(place.join("a.toml")).unwrap();
    let result = output(yawbench().args(["run", "a.toml"]).current_dir(&place));
    let text = String::from_utf8_lossy(&result.stderr);
    assert_eq!(
        (result.status.code(), &*text),
        (Some(2), "error: a.toml: found a socket, expected a file\n")
    );
}

#[test]
fn a_result_of_another_command_is_not_replaced() {
    let place = folder("other-command");
    let manifest =
        "{\"format\": 1, \"command\": \"campaign\", \"identity\": null, \"files\": [\"a\"]}";
    std::fs::write(place.join("manifest.json"), manifest).unwrap();
    std::fs::write(place.join("a"), "cases").unwrap();
    let text = {
        let scenario = repository().join("scenarios/ss9-160kmh.toml");
        let mut run = yawbench();
        run.arg("run").arg(scenario).args(["--pace", "fast", "--duration", "0.01", "--overwrite"]);
        let result = output(run.arg("--out").arg(&place));
        assert_eq!(result.status.code(), Some(2));
        String::from_utf8_lossy(&result.stderr).into_owned()
    };
    has(&text, &["holds a result of `campaign`, expected one of `run` or a new folder"]);
    assert_eq!(std::fs::read_to_string(place.join("a")).unwrap(), "cases");
}

#[test]
fn what_is_unusual_about_a_vehicle_is_printed_by_runs_and_studies() {
    let place = folder("unusual");
    let read = |name: &str| std::fs::read_to_string(repository().join(name)).unwrap();
    let vehicle = read("scenarios/vehicles/ss9.toml");
    let from = "wheel_radius_m = ";
    assert!(vehicle.contains(from));
    std::fs::create_dir_all(place.join("vehicles")).unwrap();
    let tall = vehicle.replacen("height_m = { value = ", "height_m = { value = 9", 1);
    std::fs::write(place.join("vehicles/ss9.toml"), tall).unwrap();
    std::fs::write(place.join("case.toml"), GOOD).unwrap();
    let run = ["run", "case.toml", "--pace", "fast", "--duration", "0.01"];
    let study = ["critical-speed", "case.toml", "--method", "linear"];
    for args in [&run[..], &study] {
        let result = output(yawbench().args(args).current_dir(&place));
        let text = [result.stdout, result.stderr].concat();
        let text = String::from_utf8_lossy(&text);
        has(&text, &["warning: body ", ": height_m = 9", "usual are 0 to 5: is the unit right?"]);
    }
}

#[test]
fn help_that_nothing_takes_is_an_error() {
    for args in [&["--help"][..], &["run", "--help"], &["--version"]] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let mut help = yawbench();
        let status =
            help.args(args).stdout(full).stderr(std::process::Stdio::null()).status().unwrap();
        assert_eq!(status.code(), Some(1), "{args:?}");
    }
    let help = output(yawbench().args(["campaign", "--help"]));
    has(
        &String::from_utf8_lossy(&help.stdout),
        &["Seed of the cases, required except with --merge"],
    );
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
