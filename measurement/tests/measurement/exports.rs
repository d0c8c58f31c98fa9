//! Files as the programs of laboratories export them, with and without a mapping.

use crate::support::Folder;
use measurement::{Measurement, read_tests};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// A sample: 10 mm at 2 Hz and a dashpot with relief; time (s), displacement (mm), force (N).
fn sample(n: usize, rate_hz: f64) -> [f64; 3] {
    let time_s = n as f64 / rate_hz;
    let angle = TAU * 2.0 * time_s;
    let ripple = ((n * 7919 + n * n * 104_729) % 997) as f64 / 997.0 - 0.5;
    let force_n = 4200.0 * libm::tanh(2.0 * libm::cos(angle)) + 4.0 * ripple;
    [time_s, 10.0 * libm::sin(angle), force_n]
}

/// How a program writes a sample.
type Row = fn([f64; 3]) -> String;

/// A head and rows at 1 kHz, of which each is as the program writes it.
fn export(head: &str, count: usize, row: impl Fn(usize, [f64; 3]) -> String) -> String {
    let rows = (0..count).map(|n| row(n, sample(n, 1e3)) + "\n");
    format!("{head}{}", rows.collect::<String>())
}

/// Reads a file that has a mapping, or none.
fn read(file: &str, mapping: Option<&str>) -> Result<Vec<Measurement>, String> {
    use std::sync::atomic::{AtomicUsize, Ordering};
    static NUMBER: AtomicUsize = AtomicUsize::new(0);
    let folder = Folder::new(&format!("export-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
    let path: PathBuf = folder.write("a.csv", file);
    let mapping = mapping.map(|text| folder.write("map.toml", text));
    read_tests(&[path], mapping.as_deref()).map_err(|error| error.to_string())
}

/// The record of every export here.
fn check(test: &Measurement, what: &str) {
    assert!((test.rate_hz() - 1000.0).abs() < 1e-6, "{what}: {} Hz", test.rate_hz());
    assert!((test.amplitude_m() - 10e-3).abs() < 2e-5, "{what}: {} m", test.amplitude_m());
    assert!(test.cycles.len() >= 3, "{what}: {:?}", test.cycles);
    let greatest = test.force_n.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    assert!((greatest / 4050.0 - 1.0).abs() < 0.01, "{what}: {greatest} N");
}

fn check_text(what: &str, file: &str, mapping: Option<&str>) -> Measurement {
    let mut tests = read(file, mapping).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(tests.len(), 1, "{what}");
    check(&tests[0], what);
    tests.remove(0)
}

#[test]
fn headers_that_say_what_their_columns_hold_needed_a_mapping() {
    let rows: [(&str, &str, Row); 12] = [
        ("plain", "Time (s),Displacement (mm),Force (N)\n", |[t, x, f]| {
            format!("{t:.3},{x:.5},{f:.3}")
        }),
        ("slashes", "Zeit/s;Weg/mm;Kraft/kN\n", |[t, x, f]| {
            format!("{t:.3};{x:.5};{:.6}", f * 1e-3).replace('.', ",")
        }),
        ("German words", "Zeit in ms\tWeg in mm\tKraft in kN\n", |[t, x, f]| {
            format!("{:.0}\t{x:.5}\t{:.6}", t * 1e3, f * 1e-3).replace('.', ",")
        }),
        ("French", "Temps (s);Déplacement (mm);Effort (daN)\n", |[t, x, f]| {
            format!("{t:.3};{x:.5};{:.4}", f * 0.1).replace('.', ",")
        }),
        ("units row", "Time\tAxial Force\tAxial Displacement\nSec\tkN\tmm\n", |[t, x, f]| {
            format!("{t:.6}\t{:.6}\t{x:.6}", f * 1e-3)
        }),
        ("brackets", "Time,Load,Stroke\n(sec),(lbf),(inches)\n", |[t, x, f]| {
            format!("{t:.3},{:.5},{:.7}", f / 4.448_221_615_260_5, x / 25.4)
        }),
        ("text above", "Dyno 7\nTest: 3\n\nTime [s],Disp [mm],Load [lbs]\n", |[t, x, f]| {
            format!("{t:.3},{x:.5},{:.5}", f / 4.448_221_615_260_5)
        }),
        ("other columns", "No,Time_s,Command_mm,Disp_mm,Force_kN,Mode\n", |[t, x, f]| {
            format!("{:.0},{t:.3},{x:.1},{x:.5},{:.6},run", t * 1e3, f * 1e-3)
        }),
        ("quoted", "\"Time (s)\",\"Disp (mm)\",\"Force (N)\"\n", |[t, x, f]| {
            format!("\"{t:.3}\",\"{x:.5}\",\"{f:.3}\"")
        }),
        ("quoted commas", "\"Zeit [s]\",\"Weg [mm]\",\"Kraft [kN]\"\n", |[t, x, f]| {
            let comma = |text: String| format!("\"{}\"", text.replace('.', ","));
            let cells = [format!("{t:.4}"), format!("{x:.5}"), format!("{:.5}", f * 1e-3)];
            cells.map(comma).join(",")
        }),
        ("blanks", "t_s   x_mm   F_N\n", |[t, x, f]| format!("{t:8.3} {x:10.5} {f:10.3}")),
        ("comments", "# rig 3\nTime (ms),Position (mm),Load cell (N)\n", |[t, x, f]| {
            format!("{:.1},{x:.5},{f:.3}", t * 1e3)
        }),
    ];
    for (what, head, row) in rows {
        let test = check_text(what, &export(head, 3000, |_, sample| row(sample)), None);
        let said = test.repairs.iter().any(|line| line.starts_with("understood without a mapping"));
        assert!(said && !test.direction_declared, "{what}: {:?}", test.repairs);
    }
}

#[test]
fn a_header_that_leaves_a_question_open_is_refused_with_the_way_out() {
    for head in ["Time,Disp,Force\n", "Time (s),Disp (mm),Force 1 (N),Force 2 (N)\n", "a,b,c\n"] {
        let more = if head.contains("Force 2") { ",1.0" } else { "" };
        let file = export(head, 300, |_, [t, x, f]| format!("{t:.3},{x:.4},{f:.2}{more}"));
        let message = read(&file, None).unwrap_err();
        assert!(message.contains("--propose-mapping"), "{message}");
    }
}

#[test]
fn clocks_as_they_are_printed_were_no_numbers() {
    let clock = |t: f64, from_s: f64, before: &str, after: &str| {
        let at = from_s + t;
        let (hour, minute) = ((at / 3600.0).floor(), (at / 60.0).floor() % 60.0);
        format!("{before}{hour:02.0}:{minute:02.0}:{:06.3}{after}", at % 60.0)
    };
    let at = |from_s: f64, before: &'static str, after: &'static str| {
        export("Time,Disp (mm),Force (N)\n", 3000, move |_, [t, x, f]| {
            format!("{},{x:.5},{f:.3}", clock((t * 1e3).round() * 1e-3, from_s, before, after))
        })
    };
    for (what, file) in [
        ("time of day", at(0.0, "", "")),
        ("date", at(36_000.0, "2021-03-04 ", "")),
        ("ISO", at(36_000.0, "2021-03-04T", "Z")),
        ("German date", at(36_000.0, "04.03.2021 ", "")),
        ("American date", at(36_000.0, "3/4/2021 ", " AM")),
        ("a date in words", at(36_000.0, "4-Mar-2021 ", "")),
    ] {
        let test = check_text(what, &file, None);
        assert!(test.repairs.iter().any(|line| line.contains("taken as seconds since")), "{what}");
    }
    let midnight = export("Time,Disp (mm),Force (N)\n", 3000, |_, [t, x, f]| {
        let at = ((86_399.0 + t) * 1e3).round() * 1e-3 % 86_400.0;
        format!("{},{x:.5},{f:.3}", clock(at, 0.0, "", ""))
    });
    let test = check_text("midnight", &midnight, None);
    assert!(test.repairs.iter().any(|line| line.contains("past midnight")), "{:?}", test.repairs);
    let whole = export("Time,Disp (mm),Force (N)\n", 3000, |n, [_, x, f]| {
        format!("10:11:{:02},{x:.5},{f:.3}", n / 1000)
    });
    let message = read(&whole, None).unwrap_err();
    assert!(message.contains("sample_rate_hz"), "{message}");
    let mapping = "sample_rate_hz = 1000\ndisplacement = { column = \"Disp (mm)\", unit = \"mm\" }\n\
                   force = { column = \"Force (N)\", unit = \"N\" }\n";
    check_text("the way out", &whole, Some(mapping));
}

#[test]
fn stamps_with_few_digits_lie_on_a_line_within_their_own_last_digit() {
    // %.Ng, as C prints it.
    let short = |value: f64, digits: usize| -> String {
        if value == 0.0 {
            return "0".to_owned();
        }
        let power = libm::log10(value.abs()).floor() as i32;
        if power < -4 {
            return format!("{value:.*e}", digits - 1).replace("e-5", "e-05");
        }
        let text = format!("{value:.*}", usize::try_from(digits as i32 - 1 - power).unwrap());
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    };
    for (rate_hz, digits, begin_s) in [
        (3004.8, 5, 0.0),
        (3004.8, 4, 1e-5),
        (1706.7, 5, 0.0),
        (1024.0, 5, 0.0),
        (1024.0, 4, 0.0),
        (2441.4, 6, 0.0),
        (3004.8, 5, 0.01),
    ] {
        let rows = (0..12_000).map(|n| {
            let [t, x, f] = sample(n, rate_hz);
            format!("{},{:.8},{f:.3}\n", short(begin_s + t, digits), x * 1e-3)
        });
        let file = format!("time_s,displacement_m,force_n\n{}", rows.collect::<String>());
        let tests = read(&file, None).unwrap_or_else(|error| panic!("{rate_hz} {digits}: {error}"));
        let (test, what) = (&tests[0], format!("{rate_hz} Hz, {digits} digits"));
        assert!((test.rate_hz() / rate_hz - 1.0).abs() < 3e-5, "{what}: {}", test.rate_hz());
        assert_eq!(test.len(), 12_000, "{what}");
        assert!(test.repairs[0].contains("stamps rounded to"), "{what}: {:?}", test.repairs);
    }
}

#[test]
fn a_coarse_timer_is_refused_with_the_rate_as_the_way_out() {
    for tick_s in [0.015_625, 0.01, 0.1] {
        let file = export("time_s,displacement_m,force_n\n", 3000, |_, [t, x, f]| {
            format!("{},{:.7},{f:.3}", (t / tick_s).floor() * tick_s, x * 1e-3)
        });
        let message = read(&file, None).unwrap_err();
        assert!(message.contains("sample_rate_hz") && message.contains("timer"), "{message}");
    }
}

#[test]
fn numbers_with_marks_between_thousands_were_refused() {
    let mapping = "decimal = \"comma\"\nseparator = \"semicolon\"\ntime = { column = \"t\" }\n\
        displacement = { column = \"x\", unit = \"mm\" }\nforce = { column = \"F\", unit = \"N\" }\n";
    for mark in [".", " ", "\u{a0}", "\u{202f}", "'", "\u{2019}"] {
        let file = export("t;x;F\n", 3000, |_, [t, x, f]| {
            let (whole, part) = (f.abs().trunc(), (f.abs().fract() * 100.0).floor());
            let sign = if f < 0.0 { "-" } else { "" };
            let whole = match whole {
                whole if whole >= 1000.0 => {
                    format!("{:.0}{mark}{:03.0}", (whole / 1e3).floor(), whole % 1e3)
                }
                whole => format!("{whole:.0}"),
            };
            let motion = format!("{t:.3};{x:.5}").replace('.', ",");
            format!("{motion};{sign}{whole},{part:02.0}")
        });
        check_text(&format!("mark {mark:?}"), &file, Some(mapping));
        check_text(
            &format!("mark {mark:?} without a mapping"),
            &file.replacen("t;x;F", "Zeit [s];Weg [mm];Kraft [N]", 1),
            None,
        );
    }
    let english = export("Time (s),Disp (mm),Force (N)\n", 3000, |_, [t, x, f]| {
        let sign = if f < 0.0 { "-" } else { "" };
        let f = f.abs();
        let force = match f {
            f if f >= 1000.0 => format!("{:.0},{:06.2}", (f / 1e3).floor(), f % 1e3),
            f => format!("{f:.2}"),
        };
        format!("{t:.3},{x:.5},\"{sign}{force}\"")
    });
    check_text("English thousands", &english, None);
    let bad = export("t;x;F\n", 300, |n, [t, x, f]| {
        let line = format!("{t:.3};{x:.5};{f:.2}").replace('.', ",");
        if n == 200 { line.rsplit_once(';').unwrap().0.to_owned() + ";42.01" } else { line }
    });
    let message = read(&bad, Some(mapping)).unwrap_err();
    assert!(
        message.contains("a.csv:202: F: found \"42.01\", expected a finite number"),
        "{message}"
    );
}

#[test]
fn decimal_commas_between_commas_have_to_be_quoted() {
    let mapping = "decimal = \"comma\"\nseparator = \"comma\"\n";
    let file = export("time_s,displacement_m,force_n\n", 300, |_, [t, x, f]| {
        format!("{t:.3},{:.7},{f:.3}", x * 1e-3).replace('.', ",")
    });
    let message = read(&file, Some(mapping)).unwrap_err();
    assert!(message.contains("decimal = \"comma\" with commas"), "{message}");
}

#[test]
fn rows_of_separators_below_the_last_row_are_blank() {
    for tail in [",,\n", "\"\",\"\",\"\"\n", " , ,\n", ",,\r\n"] {
        let file = export("time_s,displacement_m,force_n\n", 3000, |_, [t, x, f]| {
            format!("{t:.3},{:.8},{f:.3}", x * 1e-3)
        });
        let test = check_text(tail, &(file + &tail.repeat(500)), None);
        assert_eq!(test.len(), 3000);
    }
    let holey = export("time_s,displacement_m,force_n\n", 300, |n, [t, x, f]| {
        if n == 200 { format!("{t:.3},,{f:.3}") } else { format!("{t:.3},{:.8},{f:.3}", x * 1e-3) }
    });
    let message = read(&holey, None).unwrap_err();
    assert!(message.contains("a.csv:202: displacement_m: found an empty cell"), "{message}");
}

#[test]
fn a_slow_temperature_has_blanks_between_its_readings() {
    for blank in ["", "NaN"] {
        let names = "time_s,displacement_m,force_n,temperature_degc\n";
        let file = export(names, 3000, |n, [t, x, f]| {
            let degc =
                if n % 100 == 50 { format!("{:.1}", 20.0 + n as f64 * 1e-3) } else { blank.into() };
            format!("{t:.3},{:.8},{f:.3},{degc}", x * 1e-3)
        });
        let test = check_text("slow temperature", &file, None);
        let degc = test.temperature_degc.as_ref().unwrap();
        assert!((degc[0] - 20.1).abs() < 0.06 && (degc[1000] - 21.0).abs() < 0.06);
        assert_eq!(degc[2999], degc[2950]);
        let said = "temperature_degc: 30 readings in 3000 rows, interpolated between them";
        assert_eq!(test.repairs, [said]);
    }
}

#[test]
fn a_file_of_several_blocks_holds_several_tests() {
    let block = |head: &str, from_s: f64| {
        export(head, 3000, move |_, [t, x, f]| {
            format!("{:.4}\t{:.6}\t{x:.6}", from_s + t, f * 1e-3)
        })
    };
    let names = "Time\tAxial Force\tAxial Displacement\nSec\tkN\tmm\n";
    let head =
        format!("MTS793|x\n\nData Header:\tTime:\t12.5\tSec\t10/7/2025 3:05 PM\nTest: 3\n{names}");
    let mapping = "separator = \"tab\"\nskip_lines = 4\nunits_row = true\n\
        time = { column = \"Time\" }\ndisplacement = { column = \"Axial Displacement\" }\n\
        force = { column = \"Axial Force\" }\n";
    let again = format!("\n\nData Header:\tTime:\t99.5\tSec\t10/7/2025 3:15 PM\nTest: 3\n{names}");
    for (what, second) in [("preamble", again.as_str()), ("names alone", names)] {
        for from_s in [0.0, 3.0, 50.0] {
            let file = block(&head, 0.0) + &block(second, from_s) + &block(second, from_s);
            for mapping in [Some(mapping), None] {
                let tests = read(&file, mapping).unwrap_or_else(|why| panic!("{what}: {why}"));
                let names: Vec<&str> = tests.iter().map(|test| test.name.as_str()).collect();
                assert_eq!(names, ["a-1", "a-2", "a-3"], "{what}");
                for test in &tests {
                    check(test, what);
                    assert!(test.repairs[0].contains(" of 3: the names of the columns stand in"));
                }
            }
        }
    }
    let other = block(&head, 0.0) + "Data Header: Fatigue\nTime\tCycles\nSec\tcycles\n1.0\t1\n";
    let message = read(&other, Some(mapping)).unwrap_err();
    assert!(message.contains("a new block with other columns?"), "{message}");
}

#[test]
fn a_measurement_file_of_labview_has_numbers_in_its_preamble() {
    let preamble = "Channels\t2\t\t\nSamples\t3000\t3000\t\nDate\t2021/03/04\t2021/03/04\t\n\
        Time\t10:11:12.1\t10:11:12.1\t\nX0\t0.0E+0\t0.0E+0\t\nDelta_X\t0.001\t0.001\t\n\
        ***End_of_Header***\t\t\t\nX_Value\tForce (kN)\tStroke (mm)\tComment\n";
    let block = |head: &str| {
        export(head, 3000, |_, [t, x, f]| format!("{t:.6}\t{:.6}\t{x:.6}\t", f * 1e-3))
    };
    let head = format!("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\n\n{preamble}");
    check_text("one block", &block(&head), None);
    let tests = read(&(block(&head) + "\n" + &block(preamble)), None).unwrap();
    assert_eq!(tests.len(), 2);
    for test in &tests {
        check(test, "two blocks");
    }
}

#[test]
fn lines_of_spreadsheets_and_old_computers_are_read() {
    let file = export("Time (s);Disp (mm);Force (N)\n", 3000, |_, [t, x, f]| {
        format!("{t:.3};{x:.5};{f:.3}").replace('.', ",")
    });
    check_text("sep=", &format!("sep=;\n{file}"), None);
    check_text("carriage returns", &file.replace('\n', "\r"), None);
    check_text("both", &file.replace('\n', "\r\n"), None);
    let mapping = "separator = \"semicolon\"\ndecimal = \"comma\"\ntime = { column = \"Time (s)\" }\n\
        displacement = { column = \"Disp (mm)\", unit = \"mm\" }\nforce = { column = \"Force (N)\" }\n";
    check_text("sep= with a mapping", &format!("sep=;\n{file}"), Some(mapping));
    let own = export("time_s;displacement_m;force_n\n", 3000, |_, [t, x, f]| {
        format!("{t:.3};{:.8};{f:.3}", x * 1e-3)
    });
    assert!(check_text("own names", &own, None).direction_declared);
}

#[test]
fn a_velocity_without_a_displacement_is_integrated() {
    let speed = |n: usize| TAU * 2.0 * 10.0 * libm::cos(TAU * 2.0 * n as f64 * 1e-3) + 3.0;
    let file = export("Time (s),Velocity (mm/s),Force (N)\n", 3300, |n, [t, _, f]| {
        format!("{t:.3},{:.4},{f:.3}", speed(n))
    });
    let mapping = "time = { column = \"Time (s)\" }\nvelocity = { column = \"Velocity (mm/s)\", \
                   unit = \"mm/s\" }\nforce = { column = \"Force (N)\" }\n";
    for mapping in [None, Some(mapping)] {
        let test = check_text("velocity", &file, mapping);
        assert!(
            test.repairs.iter().any(|line| line.contains("a drift of 3.0")),
            "{:?}",
            test.repairs
        );
        let untestable: Vec<&str> = test.destroyed.keys().copied().collect();
        assert_eq!(
            untestable,
            ["bump_stop", "position_dependent_damping", "stroke_dependent_stiffness"]
        );
    }
}

#[test]
fn units_that_nobody_stated_are_suspected_aloud() {
    let with = |row: fn([f64; 3]) -> String| export("t,x,F\n", 3000, move |_, sample| row(sample));
    let mapping = "time = { column = \"t\" }\nforce = { column = \"F\" }\n\
                   displacement = { column = \"x\", unit = \"mm\" }\n";
    let milliseconds = with(|[t, x, f]| format!("{:.0},{x:.5},{f:.3}", t * 1e3));
    let message = read(&milliseconds, Some(mapping)).unwrap_err();
    assert!(message.contains("is the time in milliseconds? [time] unit = \"ms\""), "{message}");
    let kilonewtons = with(|[t, x, f]| format!("{t:.3},{x:.5},{:.6}", f * 1e-3));
    let test = &read(&kilonewtons, Some(mapping)).unwrap()[0];
    assert!(test.repairs.iter().any(|line| line.contains("is it in kN?")), "{:?}", test.repairs);
    let stated = mapping.replace("\"F\"", "\"F\", unit = \"kN\"");
    check_text("stated", &kilonewtons, Some(&stated));
}

#[test]
fn counts_become_values_by_a_scale() {
    let file = export("ms,F,x\n", 3000, |n, [_, x, f]| {
        format!("{n},{:.0},{:.0}", 512.0 + f / 10.0, 512.0 + x / 0.025)
    });
    let mapping = "time = { column = \"ms\", unit = \"ms\" }\n\
        displacement = { column = \"x\", scale = 0.025, offset = 512, unit = \"mm\" }\n\
        force = { column = \"F\", scale = 10, offset = 512 }\n";
    check_text("counts", &file, Some(mapping));
    let test = read(&file, Some(&mapping.replace(", offset = 512", ""))).unwrap().remove(0);
    let said = test.repairs.iter().filter(|line| line.contains("a scale without an offset"));
    assert_eq!(said.count(), 2, "{:?}", test.repairs);
}

#[test]
fn few_samples_a_second_are_read_where_the_motion_is_slow() {
    let slow = |rate_hz: f64, hz: f64| {
        let rows = (0..600).map(f64::from).map(|n| {
            let angle = TAU * hz * n / rate_hz;
            let (x, f) = (10e-3 * libm::sin(angle), 4e3 * libm::cos(angle));
            format!("{:.4},{x:.8},{f:.3}\n", n / rate_hz)
        });
        read(&format!("time_s,displacement_m,force_n\n{}", rows.collect::<String>()), None)
    };
    for (rate_hz, hz) in [(20.0, 0.5), (50.0, 2.0), (64.0, 5.0)] {
        let test = slow(rate_hz, hz).unwrap().remove(0);
        assert!((test.rate_hz() / rate_hz - 1.0).abs() < 1e-4 && test.cycles.len() > 3);
        assert!(test.repairs[0].contains("does not show"), "{:?}", test.repairs);
        assert!(test.destroyed.contains_key("clearance_impact"));
        // At the ends, where the window has one side, the velocity is worse.
        let inside = &test.velocity_m_per_s[2..test.len() - 2];
        let worst = inside.iter().fold(0.0_f64, |most, v| most.max(*v));
        assert!((worst / (10e-3 * TAU * hz) - 1.0).abs() < 0.02, "{rate_hz}: {worst}");
    }
    let message = slow(20.0, 3.0).unwrap_err();
    assert!(message.contains("ten in a period of the fastest motion"), "{message}");
    let message = slow(15.0, 0.5).unwrap_err();
    assert!(message.contains("expected at least 20"), "{message}");
}

#[test]
fn files_that_are_no_tables_are_named() {
    let folder = Folder::new("named-kinds");
    for (bytes, what) in [
        (b"MATLAB 7.3 MAT-file, Platform: GLNXA64".as_slice(), "MATLAB 7.3"),
        (b"MATLAB 5.0 MAT-file, Platform", "MATLAB file"),
        (b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'}", "NumPy"),
        (b"TDSm\x0e\x00\x00\x00", "TDMS"),
        (b"MDF     4.10    ", "MDF"),
        (b"{\"time\": [0.0, 0.1]}", "JSON"),
        (b"[{\"time\": 0.0}]", "JSON"),
        (b"<?xml version=\"1.0\"?><Workbook>", "XML"),
        (b"\x01\x02\x00\x00\x03\x04", "binary file"),
    ] {
        let message = read_tests(&[folder.write("a.csv", bytes)], None).unwrap_err().to_string();
        assert!(message.contains(what) && message.contains("CSV"), "{message}");
    }
}
