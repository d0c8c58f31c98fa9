//! Files as laboratories write them, and what is wrong with bad ones, word for word.

use crate::columns;
use crate::mapping::Mapping;
use crate::table::Table;
use crate::text::Text;
use crate::{Measurement, MeasurementError, read_tests};
use scenario::source::Source;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

/// What a mapping makes of a file's text.
fn read(mapping: &str, text: &str) -> Result<Vec<Measurement>, String> {
    let source = Source::from_text(Path::new("map.toml"), mapping);
    let read = || -> Result<Vec<Measurement>, MeasurementError> {
        let mapping: Mapping = source.parse()?;
        let layout = mapping.layout(&source, Path::new("a.csv"))?;
        let text = Text { content: text.to_owned(), repairs: Vec::new() };
        let tables = Table::parse(Path::new("a.csv"), &text, &layout)?;
        let series = tables.iter().map(|table| columns::tests_of(table, &layout));
        let series = series.collect::<Result<Vec<_>, _>>()?;
        series.into_iter().flatten().map(Measurement::from_series).collect()
    };
    read().map_err(|error| error.to_string())
}

fn one(mapping: &str, text: &str) -> Measurement {
    let mut tests = read(mapping, text).unwrap();
    assert_eq!(tests.len(), 1);
    tests.remove(0)
}

/// Displacement (m) and force (N) of a sample: 5 mm at 2 Hz, a force of 1 kN ahead by 50 degrees.
fn sample(n: usize) -> (f64, f64) {
    let angle = TAU * 2.0 * n as f64 * 2e-3;
    (5e-3 * libm::sin(angle), 1e3 * libm::sin(angle + 0.87))
}

/// Rows of a good file at 500 Hz, each possibly changed.
fn file(count: usize, row: impl Fn(usize, [f64; 3]) -> Option<String>) -> String {
    let mut text = "time_s,displacement_m,force_n\n".to_owned();
    for n in 0..count {
        let (x, f) = sample(n);
        if let Some(line) = row(n, [n as f64 * 2e-3, x, f]) {
            text.push_str(&line);
            text.push('\n');
        }
    }
    text
}

#[expect(clippy::unnecessary_wraps, reason = "a row of the file")]
fn plain([t, x, f]: [f64; 3]) -> Option<String> {
    Some(format!("{t:.3},{x:.7},{f:.3}"))
}

#[test]
fn a_good_file_is_what_it_says() {
    let test = one("", &file(2000, |_, row| plain(row)));
    assert_eq!((test.name.as_str(), test.len(), test.step_s), ("a", 2000, 2e-3));
    assert_eq!(test.repairs, [""; 0]);
    assert!(test.direction_declared && test.temperature_degc.is_none());
    assert_eq!((test.run_in, test.cycles.len()), (250, 8));
    assert_eq!(test.force_n[7], 865.391);
    let (x, v) = test.motion_between(7, 0.5);
    assert!((x - 5e-3 * libm::sin(TAU * 2.0 * 15e-3)).abs() < 1e-7);
    assert!((v - 5e-3 * TAU * 2.0 * libm::cos(TAU * 2.0 * 15e-3)).abs() < 1e-4);
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table")]
fn every_bad_file_has_its_line() {
    let good = |n: usize, row| (n != 700).then(|| plain(row)).flatten();
    let cut = |line: &'static str| {
        move |n: usize, row| if n == 700 { Some(line.to_owned()) } else { plain(row) }
    };
    let only = |keep: fn(usize) -> bool| move |n: usize, row| keep(n).then(|| plain(row)).flatten();
    let cases: Vec<(&str, String, &str)> = vec![
        (
            "cell",
            file(2000, cut("1.400,0.001,")),
            "a.csv:702: force_n: found an empty cell, expected a finite number; the reading is missing: delete line 702 (up to three missing samples in a row are filled in), or cut the file there",
        ),
        (
            "nan",
            file(2000, cut("1.400,NaN,10")),
            "a.csv:702: displacement_m: found \"NaN\", expected a finite number; the reading is missing: delete line 702 (up to three missing samples in a row are filled in), or cut the file there",
        ),
        (
            "text",
            file(2000, cut("1.400,0.001,1k")),
            "a.csv:702: force_n: found \"1k\", expected a finite number",
        ),
        ("comma", file(2000, cut("1,400,0,001,10,0")), "a.csv:702: row: found 6 cells, expected 3"),
        ("short row", file(2000, cut("1.400,0.001")), "a.csv:702: row: found 2 cells, expected 3"),
        (
            "name",
            file(2000, good).replace("force_n", "F"),
            "a.csv: found the columns time_s, displacement_m, F, expected one called force_n",
        ),
        (
            "separator",
            file(2000, good).replace(',', ";"),
            "a.csv: found the columns time_s;displacement_m;force_n (another separator? a mapping says which), expected one called time_s",
        ),
        (
            "separator and decimal comma",
            file(2000, good).replace(',', ";").replace('.', ","),
            "a.csv:2: row: found 4 cells, expected 1 (another separator? a mapping says which)",
        ),
        (
            "twice",
            file(2000, good).replace("time_s", "force_n"),
            "a.csv: found the columns force_n, displacement_m, force_n, expected one called time_s",
        ),
        (
            "gap",
            file(2000, only(|n| !(700..720).contains(&n))),
            "a.csv:702: time_s: found a gap of 0.042000 s, 20 samples, expected steps of 0.002000 s, each within 30 %; up to 3 missing samples are filled; sample_rate_hz in a mapping takes the place of the time column",
        ),
        (
            "holes",
            file(2000, only(|n| n % 50 != 7)),
            "a.csv: found 40 missing samples in 40 gaps, expected at most one in a hundred; sample_rate_hz in a mapping takes the place of the time column",
        ),
        (
            "unequal",
            file(2000, cut("1.3988,0.001,10")),
            "a.csv:702: time_s: found a step of 0.000800 s, expected steps of 0.002000 s, each within 30 %; sample_rate_hz in a mapping takes the place of the time column",
        ),
        (
            "back",
            file(2000, cut("0.400,0.001,10")),
            "a.csv:702: time_s: found 0.4 s after 1.398 s, expected rising time; split_by separates several tests of a file, and sample_rate_hz in a mapping takes the place of the time column",
        ),
        (
            "repeated",
            file(2000, cut("1.398,0.001,10")),
            "a.csv:702: time_s: found 1.398 s after 1.398 s, with other values, expected rising time, or the same values at the same time; sample_rate_hz in a mapping takes the place of the time column",
        ),
        ("few", file(49, only(|_| true)), "a.csv: found 49 samples, expected at least 50"),
        (
            "short",
            file(100, only(|_| true)),
            "a.csv: found 0.20 s with a travel of 1.4 times the range, expected about a whole cycle at least, or a hold",
        ),
        (
            "slow",
            file(4000, only(|n| n % 40 == 0)),
            "a.csv: found 12.500000 samples per second, expected at least 20: is the time in milliseconds? [time] unit = \"ms\" in a mapping says so",
        ),
        (
            "still",
            file(2000, |_, [t, _, f]| plain([t, 0.01, f])),
            "a.csv: found displacement_m constant within 0 m, expected a damper that moves",
        ),
        (
            "dead",
            file(2000, |_, [t, x, _]| plain([t, x, 3.0])),
            "a.csv: found force_n constant within 0 N, expected a force that answers",
        ),
        (
            "swapped",
            file(2000, |_, [t, x, f]| plain([t, f, x])),
            "a.csv: found displacement_m over 1.99999e3 m and force_n over 1.00000e-2 N, expected a travel below 2 m: another unit, or columns swapped?",
        ),
        (
            "empty",
            String::new(),
            "a.csv: found no rows, expected a row of names and rows of numbers",
        ),
        (
            "names only",
            "time_s,displacement_m,force_n\n".to_owned(),
            "a.csv: found no rows, expected a row of names and rows of numbers",
        ),
        (
            "direction",
            format!("# extension: up\n{}", file(2000, good)),
            "a.csv:1: extension: found \"up\", expected positive, negative or unknown",
        ),
    ];
    for (name, text, expected) in cases {
        assert_eq!(read("", &text).unwrap_err(), expected, "{name}");
    }
    for (mapping, expected) in [
        (
            "where = { force_n = 1e9 }",
            "a.csv: found no row that fits where.force_n, expected one of force_n = 764.329, 780.292, 795.762, 810.730, 825.186, 839.120, ...",
        ),
        (
            "where = { amp = 1 }",
            "a.csv: found the columns time_s, displacement_m, force_n, expected one called amp",
        ),
        (
            "split_by = [\"test\"]",
            "a.csv: found the columns time_s, displacement_m, force_n, expected one called test",
        ),
        (
            "[temperature]\nunit = \"K\"",
            "a.csv: found the columns time_s, displacement_m, force_n, expected one called temperature_degc",
        ),
        (
            "units_row = true",
            "a.csv: found unit \"0.000\" of time_s, expected one of s, ms, us, min",
        ),
        (
            "[force]\nunit = \"MN\"",
            "a.csv: found force_n over 1.99999e9 N, expected less than 20000000 N: another unit?",
        ),
    ] {
        assert_eq!(
            read(mapping, &file(2000, |_, row| plain(row))).unwrap_err(),
            expected,
            "{mapping}"
        );
    }
}

#[test]
fn columns_swapped_at_sizes_that_could_be_are_seen_by_their_shape() {
    // +-20 N of a friction damper, taken for millimetres; +-10 mm, taken for newtons.
    let text = file(2000, |n, [t, x, _]| {
        let force = 20.0 * libm::copysign(1.0, sample(n + 60).0);
        Some(format!("{t:.3},{force:.2},{:.4}", x * 2e3))
    });
    let error = read("[displacement]\nunit = \"mm\"", &text).unwrap_err();
    assert!(
        error.contains("displacement_m rougher than force_n") && error.contains("swapped?"),
        "{error}"
    );
}

#[test]
fn every_repair_is_reported() {
    let cases: Vec<(&str, String, &str)> = vec![
        (
            "sign",
            file(2000, |_, [t, x, f]| plain([t, x, -f])),
            "force_n: sign turned, the damper took up -",
        ),
        (
            "filled",
            file(2000, |n, row| (n != 700 && n != 701).then(|| plain(row)).flatten()),
            "time_s: 2 missing samples filled in after line 701, by cubic interpolation",
        ),
        (
            "repeated",
            file(2000, |n, row| {
                if n == 700 {
                    file(2000, |_, row| plain(row)).lines().nth(700).map(str::to_owned)
                } else {
                    plain(row)
                }
            }),
            "1 repeated rows left out: line 702",
        ),
        (
            "jitter",
            file(2000, |n, [t, x, f]| {
                Some(format!(
                    "{:.5},{x:.7},{f:.3}",
                    t + 3e-4 * libm::sin(n as f64 * std::f64::consts::PI / 1999.0 * 700.0)
                ))
            }),
            "time_s: steps of 0.001",
        ),
        (
            "rounded",
            file(2000, |_, [t, x, f]| Some(format!("{t:.2},{x:.7},{f:.3}"))),
            "time_s: stamps rounded to 0.01 s taken as equal steps of 0.002000 s",
        ),
        (
            "clipped",
            file(2000, |_, [t, x, f]| plain([t, x, f.clamp(-900.0, 900.0)])),
            "left as it is: force_n at its extreme 900 N in ",
        ),
        (
            "spike",
            file(2000, |n, [t, x, f]| plain([t, x, if n == 700 { f + 5e4 } else { f }])),
            "force_n: 1 spikes of one sample replaced by the mean of their neighbours, lines 702",
        ),
        ("spring", file(2000, |_, [t, x, _]| plain([t, x, 1e5 * x])), "left as it is: "),
        (
            "velocity",
            file(2000, |_, [t, x, f]| Some(format!("{t:.3},{x:.7},{f:.3},{x:.7}"))).replacen(
                "force_n",
                "force_n,velocity_m_per_s",
                1,
            ),
            "velocity column not used, as always; it differs from the slope of displacement_m by ",
        ),
    ];
    for (name, text, expected) in cases {
        let test = one("", &text);
        assert!(
            test.repairs.iter().any(|line| line.starts_with(expected)),
            "{name}: {:?}",
            test.repairs
        );
        assert!(test.repairs.len() <= 2, "{name}: {:?}", test.repairs);
        assert_eq!(test.step_s, 2e-3, "{name}");
        let kept = one("", &file(2000, |_, row| plain(row)));
        let worst =
            test.displacement_m.iter().zip(&kept.displacement_m).map(|(a, b)| (a - b).abs());
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 2e-5, "{name}: {worst}");
    }
}

#[test]
fn a_clipped_force_with_noise_was_taken_for_an_asymmetric_damper() {
    let rattle = |n: usize| [3.0, -2.0, 1.0, -4.0, 2.0][n % 5];
    let error = read("", &file(2000, |n, [t, x, f]| plain([t, x, (f + rattle(n)).min(900.0)])))
        .unwrap_err();
    assert!(
        error.starts_with("a.csv: found force_n at its extreme 900 N in ")
            && error.ends_with(
                "expected a force that was not clipped: measure again over a wider range"
            ),
        "{error}"
    );
}

#[test]
fn a_blow_of_some_samples_is_no_spike() {
    let blow = |n: usize| match n {
        700..=703 => 5e4 * libm::sin(0.7 * (n - 699) as f64),
        _ => 0.0,
    };
    let test = one("", &file(2000, |n, [t, x, f]| plain([t, x, f + blow(n)])));
    assert_eq!(test.repairs, [""; 0]);
}

#[test]
fn a_laboratory_file_of_another_country_is_read() {
    let mut text =
        "Prüfstand 3;;;\nDämpfer 7;;;\nZeit;Weg;Kraft;Temperatur;\n[ms];[mm];(kN);[°F];\n"
            .to_owned();
    for n in 0..1500 {
        let (x, f) = sample(n);
        let line = format!("{};{:.4};{:.6};68,0;\n", n * 2, -x * 1e3 + 12.5, f * 1e-3);
        text.push_str(&line.replace('.', ","));
    }
    let mapping = "separator = \"semicolon\"\ndecimal = \"comma\"\nskip_lines = 2\nunits_row = true\n\
        extension = \"negative\"\ntime = { column = \"Zeit\" }\n\
        displacement = { column = \"Weg\", offset = 12.5 }\nforce = { column = \"Kraft\", sign = -1 }\n\
        temperature = { column = \"Temperatur\" }\n";
    let test = one(mapping, &text);
    assert_eq!((test.step_s, test.direction_declared), (2e-3, true));
    assert_eq!(test.repairs, [""; 0]);
    for n in [0, 100, 1499] {
        let (x, f) = sample(n);
        assert!((test.displacement_m[n] - x).abs() < 1e-7 && (test.force_n[n] - f).abs() < 1e-3);
        assert!((test.temperature_degc.as_ref().unwrap()[n] - 20.0).abs() < 1e-12);
    }
    // A file that writes in Latin-1, and one of a spreadsheet, say the same.
    let folder = std::env::temp_dir().join(format!("yawbench-records-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (map, latin, wide) = (folder.join("m.toml"), folder.join("l.csv"), folder.join("w.csv"));
    std::fs::write(&map, mapping).unwrap();
    std::fs::write(&latin, text.chars().map(|c| c as u8).collect::<Vec<u8>>()).unwrap();
    let units = "\u{feff}".encode_utf16().chain(text.encode_utf16());
    std::fs::write(&wide, units.flat_map(u16::to_le_bytes).collect::<Vec<u8>>()).unwrap();
    let tests = read_tests(&[latin.clone(), wide, latin], Some(&map)).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(tests[1].force_n, test.force_n);
    assert_eq!(tests[0].force_n, test.force_n);
    assert_eq!(tests[0].repairs, ["the text is not UTF-8: read as Latin-1"]);
    assert_eq!(tests.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["l", "w", "l-2"]);
}

#[test]
fn one_test_of_a_visit_was_turned_alone_where_its_force_came_late() {
    let late = |degree: f64| {
        file(2000, move |n, [t, x, _]| {
            let angle = TAU * 2.0 * n as f64 * 2e-3;
            plain([t, x, 1e3 * libm::sin(angle + degree.to_radians())])
        })
    };
    let folder = std::env::temp_dir().join(format!("yawbench-signs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let [soft, stiff] = ["soft.csv", "stiff.csv"].map(|name| folder.join(name));
    std::fs::write(&soft, late(80.0)).unwrap();
    std::fs::write(&stiff, late(-10.0)).unwrap();
    let tests = read_tests(&[soft, stiff.clone()], None).unwrap();
    let alone = read_tests(&[stiff], None).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!(tests[0].repairs, [""; 0]);
    assert!(tests[1].repairs[0].contains("whose force_n comes late"), "{:?}", tests[1].repairs);
    assert_eq!(alone[0].repairs, tests[1].repairs);
    assert_eq!(tests[1].force_n, alone[0].force_n);
}

#[test]
fn several_tests_of_a_file_come_apart_in_order_of_appearance() {
    let mut text = "b,amp,x,F_a,F_b\n".to_owned();
    for (test, current) in [("z", "0.5"), ("y", "0.5"), ("x", "1.0")] {
        for n in 0..600 {
            let (x, f) = sample(n);
            text.push_str(
                &format!("{test},{current} {x:.7} {f:.3} {:.3}\n", 2.0 * f).replace(' ', ","),
            );
        }
    }
    let mapping = "sample_rate_hz = 500\nsplit_by = [\"b\"]\nwhere = { amp = 0.5 }\n\
        displacement = { column = \"x\" }\nforce_column = [\"F_b\", \"F_a\"]\n";
    let tests = read(mapping, &text).unwrap();
    let names: Vec<&str> = tests.iter().map(|test| test.name.as_str()).collect();
    assert_eq!(names, ["a-bz-F_b", "a-bz-F_a", "a-by-F_b", "a-by-F_a"]);
    assert!(tests.iter().all(|test| !test.direction_declared && test.len() == 600));
    assert_eq!(tests[0].force_n[3], 2.0 * tests[1].force_n[3]);
    let declared = one(
        "sample_rate_hz = 500\nwhere = { b = \"x\" }\nextension = \"positive\"\n\
        displacement = { column = \"x\" }\nforce_column = \"F_a\"\n",
        &text,
    );
    assert!(declared.direction_declared);
}

#[test]
fn a_file_may_declare_its_direction() {
    let good = file(2000, |_, row| plain(row));
    let unknown = one("", &format!("# extension: unknown\n{good}"));
    assert!(!unknown.direction_declared);
    let turned = one("", &format!("# extension: negative\n{good}"));
    assert!(turned.direction_declared);
    assert_eq!(turned.displacement_m[30], -unknown.displacement_m[30]);
    assert_eq!(turned.force_n[30], -unknown.force_n[30]);
}

#[test]
fn what_is_written_on_the_uniform_clock_reads_back_to_the_same_motion() {
    // 300 Hz with stamps in whole milliseconds, read, written with all digits, read again.
    let text =
        file(2000, |_, [t, x, f]| Some(format!("{:.3},{x:.7},{f:.3}", t / 2e-3 / 300.0 + 7.0)));
    let first = one("", &text);
    assert_eq!(first.step_s, 1.0 / 300.0);
    let mut written = "time_s,displacement_m,force_n\n".to_owned();
    for n in 0..first.len() {
        let (x, f) = (first.displacement_m[n], first.force_n[n]);
        writeln!(written, "{},{x},{f}", first.time_s(n)).unwrap();
    }
    let again = one("", &written);
    assert_eq!(again.step_s, first.step_s);
    assert_eq!(again.velocity_m_per_s, first.velocity_m_per_s);
    assert_eq!(again.repairs, [""; 0]);
}

#[test]
fn records_of_other_laboratories_are_read_by_the_mappings_that_ship() {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = here.join("../../shared/data/measured");
    if !folder.is_dir() {
        files::say!("skipped: no folder of measured records next to the repository");
        return;
    }
    for (mapping, file, tests, samples, cyclic) in [
        ("utfsm-sine", "utfsm_mr_damper_sine", 30, 122_691, 30),
        ("utfsm-earthquake", "utfsm_mr_damper_earthquake", 5, 5 * 16_162, 0),
        ("labcontrol", "labcontrol_mr_damper", 38, 87_038, 38),
        ("utfsm-1.0A", "utfsm_mr_damper_sine", 6, 23_223, 6),
        ("utfsm-1.0A", "utfsm_mr_damper_earthquake", 1, 16_162, 0),
    ] {
        let mapping = here.join("../scenarios/mappings").join(format!("{mapping}.toml"));
        let read = read_tests(&[folder.join(file).with_extension("csv")], Some(&mapping)).unwrap();
        let found: usize = read.iter().map(Measurement::len).sum();
        assert_eq!((read.len(), found), (tests, samples), "{file}");
        assert_eq!(read.iter().filter(|test| !test.cycles.is_empty()).count(), cyclic, "{file}");
        for test in &read {
            assert_eq!(test.repairs, [""; 0], "{}", test.name);
            assert!(!test.direction_declared);
        }
    }
}

#[test]
fn lines_of_two_directions_were_taken_for_the_first_of_them() {
    let good = file(2000, |_, row| plain(row));
    let text = format!("# extension: negative\n# extension: positive\n{good}");
    assert_eq!(
        read("", &text).unwrap_err(),
        "a.csv:2: extension: found \"positive\" after \"negative\" in line 1, expected one direction"
    );
    // A mapping decides before the file; twice the same is no contradiction.
    assert!(read("extension = \"positive\"", &text).is_ok());
    assert!(read("", &format!("# extension: negative\n# extension: negative\n{good}")).is_ok());
}

#[test]
fn messages_held_hundreds_of_digits_and_no_line() {
    let with = |line: &'static str| {
        move |n: usize, row| if n == 700 { Some(line.to_owned()) } else { plain(row) }
    };
    for (text, said) in [
        (
            file(2000, with("1.4,1e300,0")),
            "a.csv:702: displacement_m: found 1e300, expected at most 2,",
        ),
        (
            file(2000, with("1.4,0,-1e308")),
            "a.csv:702: force_n: found -1e308, expected at most 20000000,",
        ),
        (
            file(2000, with("1e300,0,10")),
            "a.csv:703: time_s: found 1.402 s after 1e300 s, expected",
        ),
        (
            file(2000, |_, [t, x, f]| Some(format!("{t:.3},{:e},{f:.3}", 1e-300 * x))),
            "a.csv: found displacement_m constant within",
        ),
        (
            file(2000, |_, [t, x, f]| Some(format!("{:e},{x},{f:.3}", 1e-300 * t))),
            "a.csv: found 5e302 samples per second, expected a clock",
        ),
        (
            file(2000, |_, [_, x, f]| Some(format!("5,{x},{f:.3}"))),
            "a.csv:3: time_s: found 1999 of 2000 rows with the stamp of the row before and other \
             values, a timer that stands still, expected a stamp for every row: sample_rate_hz in \
             a mapping takes the place of the time column, if the rows are equally spaced",
        ),
    ] {
        let found = read("", &text).unwrap_err();
        assert!(found.starts_with(said) && found.len() < 260, "{found}");
        assert!(!found.contains("00000000000"), "{found}");
    }
}

#[test]
fn the_rate_of_stamps_in_whole_seconds_counted_parts_of_seconds() {
    // 1000 rows a second from 0.3 s to 5.1 s: 700, four times 1000, and 100 rows.
    let text = file(4800, |n, [_, x, f]| Some(format!("{},{x},{f}", (300 + n) / 1000)));
    let found = read("", &text).unwrap_err();
    assert!(found.ends_with("equally spaced (here about 1000 a second)"), "{found}");
    // Two stamps have no whole second between them.
    let text = file(1000, |n, [_, x, f]| Some(format!("{},{x},{f}", (300 + n) / 1000)));
    assert!(read("", &text).unwrap_err().ends_with("equally spaced"));
}

#[test]
fn a_temperature_of_another_unit_was_taken_as_it_was() {
    let with = |degc: f64| {
        let text = file(2000, |_, [t, x, f]| Some(format!("{t:.3},{x:.7},{f:.3},{degc}")));
        let text = text.replacen("force_n", "force_n,temperature_degc", 1);
        one("", &text).repairs.join("\n")
    };
    assert!(with(9000.0).contains("temperature_degc: 9000 to 9000 degC: another unit?"));
    assert!(with(-273.0).contains("another unit?"));
    assert!(!with(21.5).contains("another unit?") && !with(299.0).contains("another unit?"));
}
