//! The report of an identification, as a person opens it: it says what was found, of every test, and
//! every plot is drawn.

use firmware_core::damper::effects::Effect;
use firmware_core::damper::{Damper, Nominal};
use identification::result::Verdict;
use identification::{Identification, Question, identify, page};
use measurement::{Measurement, Series};
use std::path::PathBuf;
use virtual_bench::bench_visit::excitation::Excitation;
use virtual_bench::bench_visit::sensors::Sensors;
use virtual_bench::bench_visit::{self, Modelled, NullGenerator, protocol};
use virtual_bench::series_model::SeriesModel;
use virtual_bench::series_model::outside::Outside;

const NOMINAL: Nominal = Nominal {
    ce_n_s_per_m: 1e6,
    ke_n_per_m: 12.5e6,
    clearance_2a_m: 1e-3,
    f_relief_n: 15e3,
    c2_n_s_per_m: 60e3,
};

/// The same damper for the generator that shares nothing with the core.
const SERIES: SeriesModel = SeriesModel {
    ce_n_s_per_m: NOMINAL.ce_n_s_per_m,
    ke_n_per_m: NOMINAL.ke_n_per_m,
    clearance_2a_m: NOMINAL.clearance_2a_m,
    f_relief_n: NOMINAL.f_relief_n,
    c2_n_s_per_m: NOMINAL.c2_n_s_per_m,
};

/// Records of a damper with these effects in the named tests of the short protocol.
fn records(effects: &[Effect], names: &[&str]) -> Vec<Measurement> {
    let damper = Damper::new(NOMINAL, effects).unwrap();
    let specimen = Modelled { damper };
    let sensors = Sensors::of_range(50e3, 0.1);
    let tests = protocol::short();
    let chosen = names.iter().map(|name| tests.iter().find(|test| test.name == *name).unwrap());
    let measured = chosen.enumerate().map(|(seed, test)| {
        let raw = bench_visit::record(&specimen, test, &sensors, seed as u64);
        let (x, f) = (raw.displacement_m, raw.force_n);
        Measurement::from_series(Series::sampled(&raw.name, raw.rate_hz, x, f)).unwrap()
    });
    measured.collect()
}

/// Writes the page, opens it, and returns its text without the scripts' own.
fn opened(found: &Identification, name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    page::page(found).write_to(&path).unwrap();
    if let Some(page) = report::browser::open(&path).unwrap() {
        page.assert_complete();
    }
    let html = std::fs::read_to_string(&path).unwrap();
    assert!(html.len() < 6_000_000, "{} bytes", html.len());
    let main = html.split_once("<main>").unwrap().1.split_once("</main>").unwrap().0;
    main.replace('\u{a0}', " ")
}

#[test]
fn the_page_tells_what_was_found_and_shows_every_held_out_test() {
    let asymmetry = Effect::from_values("asymmetric_damping", &[0.15, 0.1]).unwrap();
    let train = ["sine-3.5hz-3.46mm", "sine-3.5hz-8mm", "sine-1hz-1.5mm", "sine-10hz-1mm"];
    let holdout = ["sine-3.5hz-3.46mm-plus-40mm", "service"];
    let question = Question {
        train: records(&[asymmetry], &train),
        holdout: records(&[asymmetry], &holdout),
        datasheet: Some(Nominal { ce_n_s_per_m: 1.2e6, f_relief_n: 16e3, ..NOMINAL }),
        empirical: false,
        thorough: false,
        notes: vec!["a note <that is told>".to_owned()],
    };
    let found = identify(question, &|_| ()).unwrap();
    let (effects, rejected) = (&found.result.effects, &found.result.rejected);
    assert!(effects.iter().any(|effect| effect.name == "asymmetric_damping"), "{rejected:?}");
    let text = opened(&found, "identify-asymmetry.html");
    let title = text.split_once("<h1>").unwrap().1.split_once("</h1>").unwrap().0;
    let verdict =
        text.split_once("<p class=\"subtitle\">").unwrap().1.split_once("</p>").unwrap().0;
    for effect in effects {
        let spoken = effect.name.replace('_', " ");
        assert!(title.contains(&spoken) && verdict.to_lowercase().contains(&spoken), "{verdict}");
    }
    assert!(verdict.contains("explain"), "{verdict}");
    assert!(text.contains("positive is extension, as declared"), "no direction");
    for effect in effects {
        assert!(
            text.contains(&format!("<td>{}</td><td>added</td>", effect.name)),
            "{}",
            effect.name
        );
        for name in effect.parameters.keys() {
            assert!(text.contains(&format!("<td>{name}</td>")), "{name}");
        }
    }
    assert!(text.contains("<pre>Ce (1 + g sgn v), F_r (1 + g_r sgn v)</pre>"), "no equation");
    for rejected in rejected {
        assert!(text.contains(&format!("<td>{}</td><td>not added</td>", rejected.name)));
    }
    for name in holdout {
        assert!(text.contains(&format!("{name} (held out): force over displacement")), "{name}");
        assert!(text.contains(&format!("{name} (held out): residual over displacement")), "{name}");
    }
    for name in train.iter().chain(&holdout) {
        assert!(text.contains(&format!("<td>{name}</td>")), "{name} is in no error table");
    }
    for hidden in &found.result.not_testable {
        assert!(text.contains(&format!("<td>{}</td>", hidden.name)), "{}", hidden.name);
    }
    assert!(text.contains("a note &lt;that is told&gt;"), "no note");
    assert!(!text.contains("mpirical"), "a word of a map that nobody asked for");
}

#[test]
fn a_page_of_one_test_without_datasheet_and_holdout_says_so() {
    let question = Question {
        train: records(&[], &["sine-3.5hz-3.46mm"]),
        holdout: Vec::new(),
        datasheet: None,
        empirical: false,
        thorough: false,
        notes: Vec::new(),
    };
    let found = identify(question, &|_| ()).unwrap();
    assert_eq!(found.result.verdict, Verdict::NoMissingEffect, "{:?}", found.result.unexplained);
    let text = opened(&found, "identify-one-test.html");
    assert!(text.contains("<h1>Damper identification: nothing is missing</h1>"), "no verdict");
    assert!(text.contains("The nominal model lacks nothing that these records can show"), "{text}");
    assert!(text.contains("No datasheet was given"), "it does not say that there is no datasheet");
    assert!(text.contains("No test was held out"), "it does not say that nothing was held out");
    assert!(
        text.contains("<h2>No effect was added</h2>"),
        "it does not say that nothing was added"
    );
    assert!(!text.contains("datasheet (N)"), "a column of nothing");
}

#[test]
fn a_map_that_was_asked_for_comes_last_and_is_called_no_physics() {
    let worn = Outside::WornBand { depth: 0.12, at_m: 0.8e-3, width_m: 3e-3 };
    let specimen = NullGenerator { model: SERIES, outside: vec![worn] };
    let sensors = Sensors::of_range(50e3, 0.1);
    let sines = [(4.0, 3.5), (6.0, 1.5), (5.0, 2.5), (8.0, 2.0), (4.5, 3.0), (6.0, 3.0)];
    let mut train: Vec<Measurement> = sines
        .iter()
        .enumerate()
        .map(|(seed, (amplitude_mm, frequency_hz))| {
            let sine = Excitation::sine(amplitude_mm * 1e-3, *frequency_hz);
            let test = protocol::Test::new(format!("{amplitude_mm}mm-{frequency_hz}hz"), sine, 5.0);
            bench_visit::record(&specimen, &test, &sensors, seed as u64).measurement().unwrap()
        })
        .collect();
    let holdout = train.split_off(5);
    let question = Question {
        train,
        holdout,
        datasheet: None,
        empirical: true,
        thorough: false,
        notes: Vec::new(),
    };
    let found = identify(question, &|_| ()).unwrap();
    assert!(found.empirical.as_ref().unwrap().kept, "{:?}", found.result.empirical);
    let text = opened(&found, "identify-empirical.html");
    let section = text.split_once("<h2>An empirical map (no physics)</h2>").unwrap().1;
    assert!(section.contains("Empirical map over displacement"), "no curve");
    assert!(section.contains("<td>empirical map, kept</td>"), "no errors");
    assert!(section.contains("valid only inside the range of these records"), "no limits");
    let (_, after) = section.split_once("<h2>").unwrap();
    assert!(after.starts_with("How this was done") && !after.contains("<h2>"), "not last");
    // A bump stop may be named beside it: five short sines do not tell a worn band from one everywhere.
    let verdict = found.result.verdict;
    let unexplained = [Verdict::Unexplained, Verdict::EffectsFoundAndUnexplained];
    assert!(unexplained.contains(&verdict), "the map has changed the verdict: {verdict:?}");
    let titles = ["something is left without a name", "and more is left"];
    assert!(titles.iter().any(|title| text.contains(title)), "the page does not say so");
}
