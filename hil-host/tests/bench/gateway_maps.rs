//! Maps that do not fit their DBC: every one is refused in one line that names the map, its line,
//! the key, what was found and what is expected.

use crate::support::own_messages::{planned, planned_with};
use hil_host::gateway::{GatewayPlan, Loss};

/// Replaces a part that is there.
fn replaced(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

/// Checks the line that refuses a plan.
fn assert_refused(plan: Result<GatewayPlan, hil_host::gateway::GatewayError>, expected: &str) {
    let why = plan.expect_err(expected);
    let said = why.to_string();
    assert!(said.starts_with(expected), "found    {said}\nexpected {expected}");
    assert!(why.is_bad_input() && !said.contains('\n') && said.contains(", expected "), "{said}");
}

/// Changes of the servo's map: from, to, and how the refusal begins.
fn assert_maps_refused(changes: &[(&str, &str, &str)]) {
    for (from, to, expected) in changes {
        let map = |map: String| replaced(&map, from, to);
        assert_refused(planned("servo", map, Loss::ALL), &format!("servo-map.toml:{expected}"));
    }
}

/// The same with a constant of the command, which stands in line 9.
fn assert_constants_refused(name: &str, changes: &[(&str, &str)]) {
    for (constant, expected) in changes {
        let map = |map: String| {
            let to = format!("constants = {{ {constant} }}\n\n[measurement]");
            replaced(&map, "[measurement]", &to)
        };
        assert_refused(planned(name, map, Loss::ALL), &format!("{name}-map.toml:{expected}"));
    }
}

/// Changes of the servo's DBC: from, to, and how the refusal begins.
fn assert_dbcs_refused(changes: &[(&str, &str, &str)]) {
    for (from, to, expected) in changes {
        let plan = planned_with("servo", |dbc| replaced(&dbc, from, to), |map| map, Loss::ALL);
        assert_refused(plan, expected);
    }
}

#[test]
fn a_name_or_a_key_that_is_not_known_is_found_in_the_map() {
    assert_maps_refused(&[
        (
            "\"LoadCell\"",
            "\"LoadCel\"",
            "10: [measurement] force: found no signal \"LoadCel\" in servo.dbc, expected the name of \
             one; did you mean LoadCell?",
        ),
        ("force = ", "forces = ", "10: "),
        (
            "velocity = \"SetVelocity\"",
            "velocity = { signal = \"SetVelocity\", unit = \"mm\" }",
            "5: [command] velocity: found unit \"mm\", expected m/s or mm/s",
        ),
        ("counter = \"Sequence\"\n", "", "12: [measurement] echo: found an echo alone"),
        (
            "counter = \"Alive\"",
            "counter = \"LoadCell\"",
            "12: [measurement] counter: found signal Measured.LoadCell, expected an unsigned",
        ),
        ("[measurement]", "crc = \"Alive\"\n\n[measurement]", "9: [command] crc: found a CRC"),
    ]);
    let ambiguous = |dbc: String| replaced(&dbc, "ServoState :", "LoadCell :");
    assert_refused(
        planned_with("servo", ambiguous, |map| map, Loss::ALL),
        "servo-map.toml:10: [measurement] force: found several signals \"LoadCell\" in servo.dbc, \
         expected one of Measured.LoadCell, State.LoadCell",
    );
    let sign = |map: String| replaced(&map, "sign = -1 }\n\n", "sign = 2 }\n\n");
    let said = planned("plain", sign, Loss::ALL).unwrap_err().to_string();
    assert!(said.contains("found sign 2, expected 1 or -1"), "{said}");
    let unit = |map: String| replaced(&map, "\"LoadCell\"", "\"SensorsOk\"");
    assert_refused(
        planned("servo", unit, Loss::ALL),
        "servo.dbc:19: signal Measured.SensorsOk: found unit \"\"",
    );
}

#[test]
fn codes_are_values_of_their_signals_and_different() {
    let mode = "6: [command] enable: found";
    let of_mode = "expected a value of SetPoint.Mode: 0 to 3 in steps of 1";
    let state = "17: [status] state: found";
    let of_state = "expected a value of State.ServoState: 0 to 15 in steps of 1";
    let valid = "14: [measurement] valid: found";
    let of_valid = "expected a value of Measured.SensorsOk: 0 to 1 in steps of 1";
    assert_maps_refused(&[
        ("armed = 1", "armed = 0", &format!("{mode} 0 for armed and stopped, expected two values")),
        ("stopped = 0", "stopped = 1.4", &format!("{mode} 1.4, {of_mode}")),
        ("armed = 1, stopped = 0", "armed = 7, stopped = 9", &format!("{mode} 7, {of_mode}")),
        ("armed = 1", "armed = nan", &format!("{mode} NaN, {of_mode}")),
        ("armed = 1", "armed = inf", &format!("{mode} inf, {of_mode}")),
        ("stopped = 0", "stopped = -1", &format!("{mode} -1, {of_mode}")),
        ("fault = 4", "fault = 2", &format!("{state} 2 for running and fault, expected two")),
        ("fault = 4", "fault = 2.3", &format!("{state} 2.3, {of_state}")),
        ("running = 2", "running = 200", &format!("{state} 200, {of_state}")),
        ("value = 1", "value = nan", &format!("{valid} NaN, {of_valid}")),
        ("value = 1", "value = 5", &format!("{valid} 5, {of_valid}")),
        ("value = 1", "value = 0.5", &format!("{valid} 0.5, {of_valid}")),
    ]);
    let spare = "[0|3] \"\" SERVO\n SG_ Spare : 44|2@1+ (1,0) [0|0] \"\" SERVO\n";
    for value in ["nan", "1e30", "-1", "4"] {
        let dbc = |dbc: String| replaced(&dbc, "[0|3] \"\" SERVO\n", spare);
        let map = |map: String| {
            let to = format!("constants = {{ Spare = {value} }}\n\n[measurement]");
            replaced(&map, "[measurement]", &to)
        };
        let value = files::number(value.parse().unwrap());
        assert_refused(
            planned_with("servo", dbc, map, Loss::ALL),
            &format!(
                "servo-map.toml:9: [command] constants Spare: found {value}, expected a value of \
                 SetPoint.Spare: 0 to 3 in steps of 1"
            ),
        );
    }
    // A code of tenths that its author has rounded is one.
    let tenths = |dbc: String| replaced(&dbc, "40|4@1+ (1,0) [0|3]", "40|4@1+ (0.1,0) [0|0]");
    let map = |map: String| replaced(&map, "armed = 1,", "armed = 0.3,");
    assert!(planned_with("servo", tenths, map, Loss::ALL).is_ok());
}

#[test]
fn limits_and_times_are_those_of_a_rig_and_of_its_signals() {
    let too_long = "expected at most 0.838861, which SetPoint.SetPosition holds to either side";
    assert_maps_refused(&[
        ("stroke_m = 0.1", "stroke_m = -0.1", "22: [limits] stroke_m: found -0.1, expected 0.001"),
        ("stroke_m = 0.1", "stroke_m = nan", "22: [limits] stroke_m: found NaN, expected 0.001"),
        ("stroke_m = 0.1", "stroke_m = 1e-300", "22: [limits] stroke_m: found 1e-300, expected"),
        ("stroke_m = 0.1", "stroke_m = 1e300", "22: [limits] stroke_m: found 1e300, expected"),
        (
            "stroke_m = 0.1",
            "stroke_m = 0.9",
            &format!("22: [limits] stroke_m: found 0.9, {too_long} ([command] displacement)"),
        ),
        (
            "velocity_m_per_s = 0.5",
            "velocity_m_per_s = 0.7",
            "23: [limits] velocity_m_per_s: found 0.7, expected at most 0.65534, which \
             SetPoint.SetVelocity holds",
        ),
        ("= 20.0", "= 1e-300", "24: [limits] acceleration_m_per_s2: found 1e-300, expected 0.1 to"),
        ("= 20.0", "= 1e300", "24: [limits] acceleration_m_per_s2: found 1e300, expected 0.1 to"),
        (
            "force_n = 50e3",
            "force_n = 300e3",
            "25: [limits] force_n: found 300000, expected at most 262143.5, which Measured.LoadCell",
        ),
        ("timeout_s = 0.1", "timeout_s = 2.0", "19: [status] timeout_s: found 2 s, expected one"),
        (
            "timeout_s = 0.1",
            "timeout_s = 0.0005",
            "19: [status] timeout_s: found 0.0005 s, expected one cycle (0.001 s) to 1 s",
        ),
        ("timeout_s = 0.1", "timeout_s = nan", "19: [status] timeout_s: found NaN s, expected one"),
    ]);
}

#[test]
fn a_signal_that_holds_no_useful_range_is_refused() {
    let (position, least) = (
        "SetPosition : 0|24@1- (0.0001,0) [0|0]",
        "at least -0.001 to 0.001 m in steps of at most",
    );
    assert_dbcs_refused(&[
        (
            position,
            "SetPosition : 0|24@1- (0.0001,0) [1|2]",
            &format!(
                "servo-map.toml:4: [command] displacement: found SetPoint.SetPosition with 0.001 to \
                 0.002 m in steps of 1e-7 m, expected {least} 0.0001 m"
            ),
        ),
        (position, "SetPosition : 0|1@1- (0.0001,0) [0|0]", "servo-map.toml:4: [command] displace"),
        (position, "SetPosition : 0|24@1- (1000,0) [0|0]", "servo-map.toml:4: [command] displace"),
        (position, "SetPosition : 0|24@1- (0.0001,1e9) [0|0]", "servo-map.toml:4: [command] displ"),
        (
            "20@1- (0.5,0)",
            "20@1- (1e6,0)",
            "servo-map.toml:10: [measurement] force: found Measured",
        ),
    ]);
    let velocity = "velocity = \"SetVelocity\"";
    for (scale, expected) in [
        ("1e-320", "5: [command] velocity: found SetPoint.SetVelocity with -6.5"),
        ("1e300", "5: [command] velocity: found SetPoint.SetVelocity with -6.5"),
    ] {
        let to = format!("velocity = {{ signal = \"SetVelocity\", scale = {scale} }}");
        assert_maps_refused(&[(velocity, &to, expected)]);
    }
    // A float has no steps, and 1 mm is rounded to nothing all the same.
    let float = |map: String| replaced(&map, "\"Force\",", "\"Force\", scale = 1e300,");
    assert_refused(planned("plain", float, Loss::ALL), "plain-map.toml:8: [measurement] force:");
}

#[test]
fn every_key_has_a_signal_and_bits_of_its_own() {
    assert_maps_refused(&[
        (
            "velocity = \"SetVelocity\"",
            "velocity = { signal = \"SetPosition\", unit = \"mm/s\" }",
            "5: [command] velocity: found SetPoint.SetPosition, as for [command] displacement, \
             expected another signal",
        ),
        (
            "counter = \"Sequence\"",
            "counter = \"Mode\"",
            "7: [command] counter: found SetPoint.Mode, as for [command] enable",
        ),
        (
            "counter = \"Alive\"",
            "counter = \"SequenceSeen\"",
            "13: [measurement] echo: found Measured.SequenceSeen, as for [measurement] counter",
        ),
        (
            "force = \"LoadCell\"",
            "force = { signal = \"Position\", scale = 1000.0 }",
            "11: [measurement] displacement: found Measured.Position, as for [measurement] force",
        ),
    ]);
    assert_constants_refused(
        "servo",
        &[
            ("Mode = 1", "9: [command] constants Mode: found SetPoint.Mode, as for [command] enab"),
            ("\"SetPoint.SetPosition\" = 5", "9: [command] constants SetPoint.SetPosition: found"),
        ],
    );
    assert_dbcs_refused(&[
        (
            "Position : 20|24",
            "Position : 0|24",
            "servo-map.toml:11: [measurement] displacement: found Measured.Position on bits of \
             Measured.LoadCell ([measurement] force), expected bits of its own",
        ),
        ("Mode : 40|4", "Mode : 50|4", "servo-map.toml:7: [command] counter: found SetPoint.Seq"),
        (
            "Mode : 40|4",
            "Mode : 20|4",
            "servo-map.toml:6: [command] enable: found SetPoint.Mode on",
        ),
        (
            "SequenceSeen : 56|8",
            "SequenceSeen : 56|2",
            "servo-map.toml:13: [measurement] echo: found Measured.SequenceSeen with 4 values, \
             expected at least 256",
        ),
    ]);
}

#[test]
fn a_message_has_one_sender() {
    assert_maps_refused(&[
        (
            "displacement = \"Position\"",
            "displacement = \"SetPosition\"",
            "11: [measurement] displacement: found SetPoint.SetPosition in message 18FF0101 next to \
             [command] displacement, expected a message that the rig alone sends",
        ),
        ("\"SequenceSeen\"", "\"Sequence\"", "13: [measurement] echo: found SetPoint.Sequence in"),
        ("\"SensorsOk\"", "\"Mode\"", "14: [measurement] valid: found SetPoint.Mode in message"),
        ("\"ServoState\", running = 2, fault = 4", "\"Mode\", running = 2, fault = 3", "17: [stat"),
        (
            "signal = \"Mode\"",
            "signal = \"SensorsOk\"",
            "6: [command] enable: found Measured.SensorsOk in message 18FF0201 next to \
             [measurement] force, expected a message that the host alone sends",
        ),
        ("signal = \"Mode\"", "signal = \"ServoState\"", "6: [command] enable: found State.Servo"),
    ]);
    assert_constants_refused(
        "servo",
        &[
            ("Alive = 1", "9: [command] constants Alive: found Measured.Alive in message 18FF0201"),
            ("OilTemperature = 1", "9: [command] constants OilTemperature: found State.Oil"),
        ],
    );
}

#[test]
fn a_command_is_one_page_of_each_message() {
    assert_constants_refused(
        "plain",
        &[
            (
                "Gain = 1",
                "7: [command] constants Gain: found Drive.Gain for another page than other signals \
                 of the command, expected one page in each message",
            ),
            ("Page = 2", "7: [command] constants Page: found Drive.Page for another page"),
        ],
    );
    let constant =
        |map: String| replaced(&map, "[measurement]", "constants = { Page = 1 }\n\n[measurement]");
    assert!(planned("plain", constant, Loss::ALL).is_ok());
    let signed = |dbc: String| replaced(&dbc, "15|16@0+", "15|16@0-");
    let velocity = |map: String| {
        let to = "velocity = { signal = \"Gain\", scale = 1.0 }\n\n[measurement]";
        replaced(&map, "[measurement]", to)
    };
    assert_refused(
        planned_with("plain", signed, velocity, Loss::ALL),
        "plain-map.toml:5: [command] displacement: found Drive.Target for another page",
    );
    let selector = |map: String| {
        let to = "enable = { signal = \"Page\", armed = 1, stopped = 0 }\n\n[measurement]";
        replaced(&map, "[measurement]", to)
    };
    assert_refused(
        planned("plain", selector, Loss::ALL),
        "plain-map.toml:7: [command] enable: found Drive.Page on bits of Drive.Target",
    );
}

#[test]
fn faults_of_the_dbc_name_its_line() {
    let again =
        "BO_ 2566849025 Measured: 8 SERVO\n SG_ LoadCell : 0|20@1- (0.5,0) [0|0] \"N\" X\n\n";
    assert_dbcs_refused(&[
        (
            "(0.5,0) [0|0]",
            "(0.5,0) [5|-5]",
            "servo.dbc:17: signal Measured.LoadCell: found limits [5|-5], expected the lower one",
        ),
        (
            "CM_ \"The",
            &format!("{again}CM_ \"The"),
            "servo.dbc:27: message Measured: found a second message of this name (line 16)",
        ),
        (
            "2566849025",
            "2566848769",
            "servo.dbc:10: message SetPoint: found the identifier of message Measured as well",
        ),
    ]);
}
