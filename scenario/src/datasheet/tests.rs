//! Datasheets as makers give them.

use super::*;
use std::fmt::Write as _;

fn sheet(text: &str) -> Result<Datasheet, ScenarioError> {
    let source = Source::from_text(Path::new("sheet.toml"), text);
    Datasheet::from_source(&source)
}

#[test]
fn each_way_to_know_the_dashpot_is_taken() {
    let direct = sheet("[damper]\nce_n_s_per_m = 2e5\nke_n_per_m = 5e6\n").unwrap();
    assert_eq!(direct.nominal.ce_n_s_per_m, 2e5);
    assert!(direct.nominal.f_relief_n.is_infinite() && direct.nominal.clearance_2a_m == 0.0);
    assert_eq!(
        direct.given,
        Given { ce: true, ke: true, clearance_2a: false, f_relief: false, c2: false }
    );
    let by_speed =
        sheet("[damper]\nce_n_s_per_m = 2e5\nv_relief_m_per_s = 0.05\nclearance_2a_m = 1e-3\n");
    let by_speed = by_speed.unwrap();
    assert_eq!(by_speed.nominal.f_relief_n, 1e4);
    assert_eq!(by_speed.nominal.c2_n_s_per_m, 0.06 * 2e5);
    assert_eq!(by_speed.nominal.ke_n_per_m, 2e7);
    assert!(by_speed.given.clearance_2a && by_speed.given.f_relief && !by_speed.given.ke);
    let by_both = sheet("[damper]\nf_relief_n = 1e4\nv_relief_m_per_s = 0.05\nc2_n_s_per_m = 0\n");
    let by_both = by_both.unwrap();
    assert_eq!((by_both.nominal.ce_n_s_per_m, by_both.nominal.c2_n_s_per_m), (2e5, 0.0));
    assert!(by_both.given.c2 && by_both.warnings.is_empty());
    assert_eq!(by_both.conversion[0], "Ce = F_relief / v_relief = 2.000000e5 N s/m");
}

#[test]
fn tables_give_all_but_the_clearance() {
    // The new damper without clearance, as its maker would measure it.
    let truth = Nominal { clearance_2a_m: 0.0, ..Nominal::NEW };
    let damper = firmware_core::damper::Damper::new(truth, &[]).unwrap();
    let mut text = String::new();
    for v in [0.005, 0.01, 0.015, 0.05, 0.1] {
        let force = damper.steady_force_n(v);
        let (one, other) = (1.02 * force, -0.98 * force);
        let _ = write!(
            text,
            "[[force]]\nvelocity_m_per_s = {v}\nextension_n = {one:?}\ncompression_n = {other:?}\n"
        );
    }
    for (hz, x) in [(1.0, 1e-3), (5.0, 0.5e-3)] {
        let point =
            Point { frequency_hz: hz, amplitude_m: x, stiffness_n_per_m: 1.0, phase_deg: None };
        let found = first_harmonic::harmonic(&damper, &point);
        let _ = write!(
            text,
            "[[dynamic]]\nfrequency_hz = {hz}\namplitude_m = {x}\nstiffness_n_per_m = {:?}\nphase_deg = {:?}\n",
            found.stiffness_n_per_m, found.phase_deg
        );
    }
    let found = sheet(&text).unwrap();
    let Nominal { ce_n_s_per_m, ke_n_per_m, clearance_2a_m, f_relief_n, c2_n_s_per_m } =
        found.nominal;
    for (value, expected) in [
        (ce_n_s_per_m, truth.ce_n_s_per_m),
        (ke_n_per_m, truth.ke_n_per_m),
        (f_relief_n, truth.f_relief_n),
        (c2_n_s_per_m, truth.c2_n_s_per_m),
    ] {
        assert!((value / expected - 1.0).abs() < 1e-3, "{value} {expected}");
    }
    assert_eq!(clearance_2a_m, 0.0);
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    assert!(found.given.ke && found.given.c2 && found.given.f_relief);
    assert_eq!(found.conversion.len(), 5, "{:?}", found.conversion);
    // A stated Ce that the table contradicts is taken, with a warning.
    let other = sheet(&format!("[damper]\nce_n_s_per_m = 1.3e6\n{text}")).unwrap();
    assert_eq!(other.nominal.ce_n_s_per_m, 1.3e6);
    assert_eq!(other.warnings[0], "Ce 1.300000e6 N s/m is taken; the tables say 1.000000e6 N s/m");
}

#[test]
fn what_does_not_agree_is_told() {
    let sides = "[[force]]\nvelocity_m_per_s = 0.1\nextension_n = 1000\ncompression_n = 600\n";
    let warned = sheet(sides).unwrap();
    assert_eq!(
        warned.warnings,
        [
            "at 0.1 m/s extension 1000 N and compression 600 N differ by 50 %: the nominal damper takes their mean"
        ]
    );
    let falling = "[[force]]\nvelocity_m_per_s = 0.2\nextension_n = 900\n\
        [[force]]\nvelocity_m_per_s = 0.1\nextension_n = 1000\n";
    assert!(sheet(falling).unwrap().warnings[0].starts_with("the force falls from 1000 N at 0.1"));
    let steep = sheet("[damper]\nce_n_s_per_m = 1e5\nf_relief_n = 1e3\nc2_n_s_per_m = 2e5\n");
    assert!(steep.unwrap().warnings[0].contains("not below Ce"));
}

#[test]
fn every_bad_datasheet_has_its_line() {
    let row = "[[force]]\nvelocity_m_per_s = 0.1\nextension_n = 1000\n";
    for (text, expected) in [
        (
            "",
            "sheet.toml: no way to know Ce, expected ce_n_s_per_m, or f_relief_n and v_relief_m_per_s, or [[force]] rows",
        ),
        ("[damper]\nke_n_per_m = 5e6\n", "sheet.toml: no way to know Ce"),
        (
            "[damper]\nce_n_s_per_m = -1\n",
            "sheet.toml:2: ce_n_s_per_m = -1, expected a positive number",
        ),
        (
            "[damper]\nce_n_s_per_m = nan\n",
            "sheet.toml:2: ce_n_s_per_m = NaN, expected a positive number",
        ),
        ("[damper]\n\nce = 1\n", "sheet.toml:3: unknown field `ce`"),
        (
            "[[force]]\nvelocity_m_per_s = 0\nextension_n = 1\n",
            "sheet.toml:2: velocity_m_per_s = 0, expected a positive number",
        ),
        (
            "[[force]]\nvelocity_m_per_s = 0.1\n",
            "sheet.toml:2: a row without force, expected extension_n or compression_n",
        ),
        (
            "[[force]]\nvelocity_m_per_s = 0.1\nextension_n = 0\n",
            "sheet.toml:3: extension_n = 0, expected a force",
        ),
        (
            &format!("{row}tolerance = 15\n"),
            "sheet.toml:4: tolerance = 15, expected a share, 0 to 1",
        ),
        (
            &format!("{row}{row}"),
            "sheet.toml:5: velocity_m_per_s = 0.1 twice, expected one row each",
        ),
        (
            &format!(
                "{row}[[dynamic]]\nfrequency_hz = 1\namplitude_m = 1e-3\nstiffness_n_per_m = 1e6\nphase_deg = 135\n"
            ),
            "sheet.toml:8: phase_deg = 135, expected 0 (a spring) to 90 (a dashpot)",
        ),
        (
            &format!("{row}[[dynamic]]\nfrequency_hz = 1\namplitude_m = 1e-3\n"),
            "sheet.toml:4: missing field `stiffness_n_per_m`",
        ),
    ] {
        let found = sheet(text).unwrap_err().to_string();
        assert!(found.starts_with(expected), "{found} / {expected}");
    }
}
