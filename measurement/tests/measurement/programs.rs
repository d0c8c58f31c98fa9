//! Files as other programs write them: understood, or refused with what was found and the key or
//! the edit that helps.

use crate::support::Folder;
use measurement::{Measurement, propose_mapping, read_tests};
use std::f64::consts::TAU;
use std::path::PathBuf;

/// Samples of a record.
const COUNT: usize = 1200;

/// A sample at 1 kHz: 10 mm at 2 Hz and a dashpot with relief; time (s), travel (mm), force (kN).
fn sample(n: usize) -> [f64; 3] {
    let time_s = n as f64 * 1e-3;
    let angle = TAU * 2.0 * time_s;
    let ripple = ((n * 7919 + n * n * 104_729) % 997) as f64 / 997.0 - 0.5;
    [time_s, 10.0 * libm::sin(angle), 4.2 * libm::tanh(2.0 * libm::cos(angle)) + 4e-3 * ripple]
}

/// A head, and rows between whose cells `mark` stands.
fn table(head: &str, mark: &str) -> String {
    let rows = (0..COUNT).map(|n| {
        let [t, x, f] = sample(n);
        format!("{t:.4}{mark}{x:.5}{mark}{f:.6}\n")
    });
    format!("{head}\n{}", rows.collect::<String>())
}

/// The same with decimal commas.
fn with_commas(head: &str, mark: &str) -> String {
    let text = table("", mark).replace('.', ",");
    format!("{head}{text}")
}

const NAMES: &str = "Time (s),Disp (mm),Force (kN)";

/// A record with another force in line 702.
fn with_cell(cell: &str) -> String {
    let text = table(NAMES, ",");
    let line = text.lines().nth(701).unwrap();
    let (before, _) = line.rsplit_once(',').unwrap();
    text.replacen(line, &format!("{before},{cell}"), 1)
}

struct Place(Folder, PathBuf);

impl Place {
    fn new(content: impl AsRef<[u8]>) -> Self {
        use std::sync::atomic::{AtomicUsize, Ordering};
        static NUMBER: AtomicUsize = AtomicUsize::new(0);
        let folder = Folder::new(&format!("program-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
        let path = folder.write("a.csv", content);
        Self(folder, path)
    }

    fn read(&self) -> Result<Vec<Measurement>, String> {
        read_tests(std::slice::from_ref(&self.1), None).map_err(|error| error.to_string())
    }

    /// The message about a file that is refused, and the mapping proposed for it or why none.
    fn refused(&self) -> (String, String) {
        let message = self.read().map(|tests| tests.len()).expect_err("a refusal");
        assert!(!message.contains('\n') && message.len() < 1000, "{message}");
        let proposal = propose_mapping(&self.1);
        (message, proposal.unwrap_or_else(|error| error.to_string()))
    }

    fn read_with(&self, mapping: &str) -> Result<Vec<Measurement>, String> {
        let mapping = self.0.write("m.toml", mapping);
        let tests = read_tests(std::slice::from_ref(&self.1), Some(&mapping));
        tests.map_err(|error| error.to_string())
    }
}

fn check(test: &Measurement, what: &str) {
    assert!((test.rate_hz() - 1000.0).abs() < 1e-6, "{what}: {} Hz", test.rate_hz());
    assert!((test.amplitude_m() - 10e-3).abs() < 2e-5, "{what}: {} m", test.amplitude_m());
    assert_eq!(test.len(), COUNT, "{what}");
    let greatest = test.force_n.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    assert!((greatest / 4050.0 - 1.0).abs() < 0.01, "{what}: {greatest} N");
}

/// A file is understood, and the mapping proposed for it reads the same.
fn understood(what: &str, content: impl AsRef<[u8]>) -> Vec<Measurement> {
    let place = Place::new(content);
    let tests = place.read().unwrap_or_else(|message| panic!("{what}: {message}"));
    let mapping = propose_mapping(&place.1).unwrap();
    let again = place.read_with(&mapping);
    let again = again.unwrap_or_else(|message| panic!("{what}: {message}\n{mapping}"));
    assert_eq!(tests.len(), again.len(), "{what}");
    for (test, other) in tests.iter().zip(&again) {
        check(test, what);
        assert_eq!(test.force_n, other.force_n, "{what}");
        assert_eq!(test.displacement_m, other.displacement_m, "{what}");
    }
    tests
}

/// The beginning of a measurement file of `LabVIEW`, up to its names.
fn labview(x_columns: &str, units: &str) -> String {
    format!(
        "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n\
         Multi_Headings\tNo\nX_Columns\t{x_columns}\nTime\t10:11:12,938945770263671875\n\
         ***End_of_Header***\t\n\t\n{}",
        labview_block(units)
    )
}

fn labview_block(units: &str) -> String {
    format!(
        "Channels\t2\t\t\t\nSamples\t1200\t1200\t\t\nDate\t2021/03/04\t2021/03/04\t\t\n\
         Y_Unit_Label\t{units}\t\t\nX_Dimension\tTime\tTime\t\t\n\
         X0\t0,0000000000000000E+0\t0,0000000000000000E+0\t\t\n\
         Delta_X\t1,000000E-3\t1,000000E-3\t\t\n***End_of_Header***\t\t\t\t\n"
    )
}

/// Rows of numbers alone, each as `row` writes it.
fn rows(row: impl Fn([f64; 3]) -> String) -> String {
    (0..COUNT).map(|n| row(sample(n)).replace('.', ",") + "\r\n").collect()
}

#[test]
fn a_labview_file_without_a_time_column_has_its_rate_in_delta_x() {
    let names = "X_Value\tForce\tStroke\tComment\n";
    let without = rows(|[_, x, f]| format!("\t{f:.6}\t{x:.5}"));
    let file = labview("No", "kN\tmm") + names + &without;
    let test = &understood("no time", &file)[0];
    assert!(test.repairs[0].contains("1000 samples a second"), "{:?}", test.repairs);
    let two = format!("{file}\r\n{}{names}{without}", labview_block("kN\tmm"));
    assert_eq!(understood("two blocks", two).len(), 2);
    let one = rows(|[t, x, f]| format!("{t:.6}\t{f:.6}\t{x:.5}\t"));
    understood("a time", labview("One", "kN\tmm") + names + &one);
    let multi = rows(|[t, x, f]| format!("{t:.6}\t{f:.6}\t{t:.6}\t{x:.5}"));
    let names = "X_Value\tForce\tX_Value\tStroke\tComment\n";
    understood("a time for each", labview("Multi", "kN\tmm") + names + &multi);
    let unnamed = labview("No", "kN\tmm") + "X_Value\tUntitled\tUntitled 1\tComment\n" + &without;
    let (message, proposal) = Place::new(unnamed).refused();
    assert!(message.contains("no column name that means displacement or force"), "{message}");
    assert!(
        message.contains("X_Value, Untitled, Untitled 1") && message.contains("decimal commas")
    );
    assert!(proposal.contains("sample_rate_hz = 1000.0"), "{proposal}");
    let volts = labview("No", "Volts\tmm") + "X_Value\tForce\tStroke\tComment\n" + &without;
    let (message, _) = Place::new(volts).refused();
    assert!(message.contains("the force \"Force\" in Volts"), "{message}");
}

#[test]
fn rows_between_the_names_and_the_numbers_were_taken_for_numbers() {
    let heads = [
        ("DIAdem", "Zeit;Weg;Kraft\ns;mm;kN\nREAL64;REAL64;REAL64"),
        ("DIAdem with another type", "Zeit;Weg;Kraft\ns;mm;kN\nFloat;Float;Float"),
        ("types below names", "Zeit [s];Weg [mm];Kraft [kN]\nDOUBLE;DOUBLE;DOUBLE"),
        ("FAMOS", "Zeit;Weg;Kraft\n[s];[mm];[kN]"),
        ("FAMOS with x", "imc FAMOS ASCII\nAbtastzeit: 0,001 s\n\nx;Weg;Kraft\ns;mm;kN"),
        ("Zwick", "\"Prüfzeit\";\"Standardweg\";\"Standardkraft\"\n\"s\";\"mm\";\"kN\""),
        (
            "catman",
            "HBM catmanEasy/AP V5.4.2;;\nDatum: 04.03.2021;;\nAnzahl Kanäle: 3;;\n\
             Zeit  1 - Standardmessrate;Weg;Kraft\nT0=04.03.2021 10:11:12;MX840_CH 1;MX840_CH 2\n\
             Abtastrate: 1000 Hz;Abtastrate: 1000 Hz;Abtastrate: 1000 Hz\n\
             Filter: aus;Filter: BE 200 Hz;Filter: BE 200 Hz\nSensor: -;Sensor: WA100;Sensor: U10M\n\
             s;mm;kN",
        ),
        ("MGC", "HBM MGCplus;;\nMessrate;1000 Hz;\nZeit;Kanal 1;Kanal 2\n[s];Weg [mm];Kraft [kN]"),
        ("Czech", "Čas (s);Dráha (mm);Síla (kN)"),
        ("Chinese", "时间(s);位移(mm);力(kN)"),
    ];
    for (what, head) in heads {
        let file = with_commas(head, ";");
        // catman and MGC write tabs.
        let is_tabbed = what.starts_with(['c', 'M']);
        understood(what, if is_tabbed { file.replace(';', "\t") } else { file });
    }
}

#[test]
fn names_in_a_comment_of_matlab_or_numpy_were_not_read() {
    for (what, head, mark) in [
        ("MATLAB", "% Damper 7\n% time_s displacement_mm force_kN", " "),
        ("MATLAB with tabs", "% Damper 7\n% time (s)\tdisplacement (mm)\tforce (kN)", "\t"),
        ("units in a comment", "% time\tdisplacement\tforce\n% s\tmm\tkN", "\t"),
        ("a comment above", "% exported by MATLAB\nTime (s),Disp (mm),Force (kN)", ","),
        ("numpy.savetxt", "# time_s displacement_mm force_kN", " "),
        ("numpy.savetxt with commas", "# t (s),x (mm),F (kN)", ","),
    ] {
        understood(what, table(head, mark));
    }
    let (message, proposal) = Place::new(table("% no names here", " ")).refused();
    assert!(
        message.contains("rows of 3 cells from line 2 on") && message.contains("header = false")
    );
    assert!(proposal.contains("header = false"), "{proposal}");
}

#[test]
fn row_numbers_of_r_have_no_name() {
    let numbered = |head: &str, mark: &str| {
        let text = table("", mark);
        let rows = text.lines().skip(1).zip(1..);
        let rows = rows.map(|(row, n)| format!("\"{n}\"{mark}{row}\n"));
        format!("{head}\n{}", rows.collect::<String>())
    };
    understood("write.csv", numbered("\"\",\"time_s\",\"disp_mm\",\"force_kN\"", ","));
    understood("write.table", numbered("\"time_s\" \"disp_mm\" \"force_kN\"", " "));
    let (message, _) = Place::new(table("time_s,disp_mm", ",")).refused();
    assert!(message.contains("no column name that means force"), "{message}");
}

#[test]
fn two_columns_that_may_be_one_are_named_with_the_key() {
    let doubled = |head: &str, again: usize| {
        let text = table("", ",");
        let rows = text
            .lines()
            .skip(1)
            .map(|row| format!("{row},{}\n", row.split(',').nth(again).unwrap()));
        format!("{head}\n{}", rows.collect::<String>())
    };
    for (head, again, kind, first, second) in [
        (
            "Time (s),Disp (mm),Force A (kN),Force B (kN)",
            2,
            "force",
            "Force A (kN)",
            "Force B (kN)",
        ),
        ("Time (s),Disp (mm),Force (kN),Test Time (s)", 0, "time", "Time (s)", "Test Time (s)"),
        ("Time (s),Disp 1 (mm),Force (kN),Disp 2 (mm)", 1, "displacement", "Disp 1", "Disp 2 (mm)"),
    ] {
        let place = Place::new(doubled(head, again));
        let (message, proposal) = place.refused();
        assert!(
            message.contains(&format!("2 columns that could be the {kind}, \"{first}")),
            "{message}"
        );
        assert!(message.contains(&format!("and \"{second}\"")), "{message}");
        assert!(message.contains(&format!("a mapping with {kind} = {{ column = \"{first}")));
        assert!(message.contains("--propose-mapping"), "{message}");
        assert!(proposal.contains(&format!("# QUESTION: which one of \"{first}")), "{proposal}");
        assert!(proposal.contains(&format!("is the {kind}?")), "{proposal}");
        check(&place.read_with(&proposal).unwrap()[0], kind);
    }
}

#[test]
fn a_force_in_volts_needs_a_scale() {
    for head in
        ["Time [s],Disp [mm],Force [V]", "Time,Disp,Force\ns,mm,V", "time_s,disp_mm,force_V"]
    {
        let place = Place::new(table(head, ","));
        let (message, proposal) = place.refused();
        let column = head.lines().next().unwrap().rsplit(',').next().unwrap();
        let way_out =
            format!("force = {{ column = \"{column}\", unit = \"N\", scale = (N per V) }}");
        assert!(
            message.contains(&format!("the force \"{column}\" in V, which is not a unit of force"))
        );
        assert!(message.contains(&way_out), "{message}");
        assert!(proposal.contains("how many kN is one V?"), "{proposal}");
        let unanswered = place.read_with(&proposal).unwrap_err();
        assert!(unanswered.contains("scale = NaN, expected a finite number"), "{unanswered}");
        let answered = proposal.replace("scale = nan", "scale = 1.0");
        check(&place.read_with(&answered).unwrap()[0], head);
    }
    let (message, _) = Place::new(table("Time [s],Disp [mm],Force [counts]", ",")).refused();
    assert!(message.contains("in counts, which is not a unit of force"), "{message}");
}

#[test]
fn a_cell_without_a_reading_is_named_with_the_way_out() {
    for cell in ["NaN", "1.#QNAN", "-1.#IND", "1.#INF", "-", "#N/A", "OVERFLOW", "*****"] {
        let (message, _) = Place::new(with_cell(cell)).refused();
        let found = format!("a.csv:702: Force (kN): found \"{cell}\", expected a finite number");
        assert!(message.contains(&found), "{message}");
        assert!(message.contains("delete line 702 (up to three missing samples"), "{message}");
    }
    let without = with_cell("-");
    let rows = without.lines().filter(|line| !line.ends_with('-'));
    let without = rows.collect::<Vec<_>>().join("\n");
    let test = &Place::new(without).read().unwrap()[0];
    assert!(test.len() == COUNT && test.repairs.iter().any(|line| line.contains("filled in")));
    let (message, _) = Place::new(with_cell("(751.6)")).refused();
    assert!(message.contains(":702: Force (kN): found \"(751.6)\""), "{message}");
    assert!(message.contains("plain numbers with a minus sign"), "{message}");
    let good = table(NAMES, ",");
    let force = good.lines().nth(1).and_then(|line| line.rsplit(',').next()).unwrap();
    let first = good.replacen(force, "1.#QNAN", 1);
    let many: String = good
        .lines()
        .enumerate()
        .map(|(n, line)| match n % 10 {
            9 => format!("{},-\n", line.rsplit_once(',').unwrap().0),
            _ => format!("{line}\n"),
        })
        .collect();
    for (what, file) in [("many", many), ("the first", first)] {
        let (message, proposal) = Place::new(file).refused();
        assert!(message.contains("Force (kN): found \""), "{what}: {message}");
        assert!(proposal.contains("column = \"Force (kN)\""), "{what}: {proposal}");
    }
}

#[test]
fn text_below_the_last_row_was_a_row_without_numbers() {
    let good = table(NAMES, ",");
    for text in
        ["End of file\n", "***End of Data***\n\n", "\nTest stopped 4/3/2021 10:11:12\nby lab\n"]
    {
        let test = &understood(text, format!("{good}{text}"))[0];
        let said =
            test.repairs.iter().any(|line| line.starts_with("left out: text below the last"));
        assert!(said, "{:?}", test.repairs);
    }
    let (message, _) = Place::new(format!("{good}\nMean,0.0,12.3\nMax,10.0,4050.0\n")).refused();
    assert!(message.contains("a.csv:1203: Time (s): found \"Mean\""), "{message}");
    assert!(message.ends_with("delete it from line 1203 on"), "{message}");
    let german = with_commas("Zeit [s];Weg [mm];Kraft [kN]", ";") + "Mittelwert; 0,0; 0,1\n";
    let (message, _) = Place::new(german).refused();
    assert!(message.contains("found \"Mittelwert\"") && message.ends_with("from line 1202 on"));
    let (message, _) = Place::new(format!("{good}2.0,")).refused();
    assert!(message.contains("a.csv:1202: row: found 2 cells, expected 3 (the file ends within"));
    let paused = good.replacen("1.0000,", "Paused by operator\n1.0000,", 1);
    let (message, _) = Place::new(paused).refused();
    assert!(message.contains("a.csv:1002: row: found 1 cells") && message.contains("cut the file"));
    // More than a few lines are no footer, and a short file of another separator is none.
    let (message, _) = Place::new(good + &"text\n".repeat(6)).refused();
    assert!(message.contains("a.csv:1202: row:"), "{message}");
    let (message, _) = Place::new("Time [s]\tForce [N]\n0.0\t1.0\n0.1\t2.0\n").refused();
    assert!(message.contains("found the columns Time [s]\\tForce [N]"), "{message}");
}

#[test]
fn nul_bytes_are_named_and_never_printed() {
    let good = table(NAMES, ",");
    let little: Vec<u8> = good.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = good.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let half = good.len() / 2;
    let holed = [&good.as_bytes()[..half], &[0; 4096], &good.as_bytes()[half..]].concat();
    let cut = [good.as_bytes(), &[0; 4096]].concat();
    let binary: Vec<u8> = b"record\n".repeat(900).into_iter().chain(0..=255).collect();
    for (bytes, found, way_out) in [
        (little, "UTF-16 text", "iconv -f UTF-16LE -t UTF-8"),
        (big, "UTF-16 text", "iconv -f UTF-16BE -t UTF-8"),
        (holed, "NUL bytes in a text, from line 6", "delete them"),
        (cut, "NUL bytes in a text, from line 1202 on", "cut it there"),
        (binary, "a binary file", "export it as CSV"),
    ] {
        let (message, proposal) = Place::new(bytes).refused();
        assert!(message.contains(found) && message.contains(way_out), "{message}");
        assert!(!message.contains("u{0}") && !proposal.contains("u{0}"), "{message}");
        assert_eq!(message, proposal);
    }
}

#[test]
fn commas_that_are_decimal_marks_and_separators_are_ambiguous() {
    for head in ["Zeit [s],Weg [mm],Kraft [kN]", "time_s,displacement_mm,force_n", ""] {
        let file = with_commas(head, ",");
        let file = file.trim_start().to_owned();
        let line = 1 + usize::from(!head.is_empty());
        let (message, proposal) = Place::new(file).refused();
        let found = format!("a.csv:{line}: row: found \"0,0000,0,00000,4,");
        assert!(message.contains(&found) && message.contains("ambiguous"), "{message}");
        assert!(message.contains("export the file again"), "{message}");
        assert_eq!(message, proposal);
    }
}
