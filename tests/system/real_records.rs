//! Records of other laboratories: magnetorheological dampers, 100 to 250 samples per second, raw or
//! smoothed. They show that the import and the method are not made for the project's own records
//! only.
//!
//! `YAWBENCH_RECORDS` names the folder with `utfsm_mr_damper_sine.csv`,
//! `utfsm_mr_damper_earthquake.csv` and `labcontrol_mr_damper.csv`; without it these tests say what
//! they skip. The table of `docs/identified-records.md` comes from
//!
//! ```text
//! YAWBENCH_RECORDS=DIR cargo test --release --test system real_records -- \
//!   --ignored --nocapture --test-threads 1
//! ```

use crate::support::command::{folder, output, repository, yawbench};
use measurement::read_tests;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const SINE: &str = "utfsm_mr_damper_sine.csv";
const EARTHQUAKE: &str = "utfsm_mr_damper_earthquake.csv";
const LABCONTROL: &str = "labcontrol_mr_damper.csv";

/// One identification.
struct Visit {
    name: String,
    mapping: String,
    train: &'static str,
    holdout: Option<&'static str>,
}

impl Visit {
    /// The sine tests of one current, and the earthquake at one.
    fn utfsm(current: &str, earthquake: &str) -> Self {
        let mapping = mapping("utfsm-1.0A.toml");
        Self {
            name: format!("utfsm {current} A, earthquake {earthquake} A"),
            mapping: mapping
                .replace("current_A = 1.0", &format!("current_A = {current}"))
                .replace("force_N_1.0A", &format!("force_N_{earthquake}A")),
            train: SINE,
            holdout: Some(EARTHQUAKE),
        }
    }

    /// The sine tests of one current, some of them held out.
    fn utfsm_sine(current: &str) -> Self {
        Self {
            name: format!("utfsm {current} A, sines"),
            mapping: chosen("utfsm-sine.toml", &format!("current_A = {current}")),
            train: SINE,
            holdout: None,
        }
    }

    /// All tests of one voltage, some of them held out.
    fn labcontrol(voltage: &str) -> Self {
        Self {
            name: format!("labcontrol {voltage} V"),
            mapping: chosen("labcontrol.toml", &format!("voltage_V = {voltage}")),
            train: LABCONTROL,
            holdout: None,
        }
    }

    /// Only these tests of the training file.
    fn only(mut self, tests: &str) -> Self {
        self.name = format!("{}, tests {tests}", self.name);
        self.mapping =
            self.mapping.replacen("where = {", &format!("where = {{ test = {tests},"), 1);
        self
    }

    /// What `yawbench identify` makes of it.
    fn identified(&self, records: &Path) -> Identified {
        let scratch =
            folder(&self.name.replace(|c: char| !c.is_ascii_alphanumeric() && c != '.', "-"));
        let mapping = scratch.join("mapping.toml");
        std::fs::write(&mapping, &self.mapping).unwrap();
        let out = scratch.join("out");
        let mut command = yawbench();
        command.arg("identify").arg("--json").arg("--train").arg(records.join(self.train));
        if let Some(holdout) = self.holdout {
            command.arg("--holdout").arg(records.join(holdout));
        }
        command.arg("--mapping").arg(&mapping).arg("--out").arg(&out);
        let begin = std::time::Instant::now();
        let run = output(&mut command);
        assert!(run.status.success(), "{}: {}", self.name, String::from_utf8_lossy(&run.stderr));
        let result = serde_json::from_slice(&run.stdout).unwrap();
        let deviation_n = deviations(&result, &out.join("predictions"));
        std::fs::remove_dir_all(scratch).unwrap();
        let took_s = begin.elapsed().as_secs_f64();
        Identified { name: self.name.clone(), result, deviation_n, took_s }
    }
}

/// A mapping that ships, as it is.
fn mapping(file: &str) -> String {
    std::fs::read_to_string(repository().join("scenarios/mappings").join(file)).unwrap()
}

/// A mapping that ships, for some of the rows.
fn chosen(file: &str, rows: &str) -> String {
    format!("where = {{ {rows} }}\n{}", mapping(file))
}

/// Result of an identification, with what a fit in per cent needs.
struct Identified {
    name: String,
    result: Value,
    /// rms of force less its mean over all counted samples, of the training tests and those held
    /// out.
    deviation_n: [f64; 2],
    took_s: f64,
}

const ROLES: [&str; 2] = ["train", "holdout"];

impl Identified {
    /// rms error over rms force, of the training tests or those held out.
    fn nrmse(&self, model: &str, role: usize) -> f64 {
        self.result["errors"][model][format!("{}_nrmse", ROLES[role])].as_f64().unwrap()
    }

    /// `1 - rms(error) / rms(force - mean)`: 1 for a perfect model, 0 for the mean.
    fn fit(&self, model: &str, role: usize) -> f64 {
        let rmse = self.result["errors"][model][format!("{}_rmse_n", ROLES[role])].as_f64();
        1.0 - rmse.unwrap() / self.deviation_n[role]
    }

    fn names(&self, what: &str) -> Vec<&str> {
        let rows = self.result[what].as_array().unwrap();
        rows.iter().map(|row| row["name"].as_str().unwrap()).collect()
    }

    fn tests(&self, role: usize) -> usize {
        let rows = self.result["per_test"].as_array().unwrap();
        rows.iter().filter(|row| row["role"] == ROLES[role]).count()
    }

    fn row(&self) -> String {
        let pair = |model: &str, role: usize| {
            format!("{:.3} ({:.1} %)", self.nrmse(model, role), 100.0 * self.fit(model, role))
        };
        let effects: Vec<String> =
            self.result["effects"].as_array().unwrap().iter().map(named).collect();
        let effects = if effects.is_empty() { "none".to_owned() } else { effects.join("; ") };
        let left = match self.result["unexplained"]["rms_n"].as_f64() {
            Some(rms_n) => {
                let over = self.result["unexplained"]["coordinate"].as_str().unwrap();
                format!("{rms_n:.1} N over {over}")
            }
            None => "nothing".to_owned(),
        };
        format!(
            "| {} | {} + {} | {} | {} | {} | {} | {} | {} | {:.0} s |",
            self.name,
            self.tests(0),
            self.tests(1),
            pair("refitted", 0),
            pair("with_effects", 0),
            pair("refitted", 1),
            pair("with_effects", 1),
            effects,
            left,
            self.took_s,
        )
    }
}

/// An effect with its parameters, as a cell of the table.
fn named(effect: &Value) -> String {
    let parameters = effect["parameters"].as_object().unwrap().iter().map(|(name, value)| {
        let number = value["value"].as_f64().unwrap();
        let spread =
            value["std"].as_f64().map_or("not fixed".to_owned(), |std| format!("{std:.1e}"));
        format!("{name} {number:.3e} +- {spread}")
    });
    let parameters = parameters.collect::<Vec<_>>().join(", ");
    let others: Vec<&str> = effect["alternatives"]
        .as_array()
        .unwrap()
        .iter()
        .map(|name| name.as_str().unwrap())
        .collect();
    let or = if others.is_empty() { String::new() } else { format!(" or {}", others.join(", ")) };
    format!("{}{or} ({parameters})", effect["name"].as_str().unwrap())
}

/// rms of force less its mean over the counted samples, for training tests and for those held out.
fn deviations(result: &Value, predictions: &Path) -> [f64; 2] {
    ROLES.map(|role| {
        let mut all: Vec<f64> = Vec::new();
        for test in
            result["per_test"].as_array().unwrap().iter().filter(|test| test["role"] == role)
        {
            let file = predictions.join(format!("{}.csv", test["file"].as_str().unwrap()));
            let text = std::fs::read_to_string(file).unwrap();
            let rows = text.lines().skip(2 + test["run_in_samples"].as_u64().unwrap() as usize);
            all.extend(rows.map(|row| row.split(',').nth(2).unwrap().parse::<f64>().unwrap()));
        }
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let squares: f64 = all.iter().map(|force| (force - mean) * (force - mean)).sum();
        libm::sqrt(squares / all.len() as f64)
    })
}

/// The folder of the records, or a message on what is skipped.
fn records(skipped: &str) -> Option<PathBuf> {
    let named = std::env::var_os("YAWBENCH_RECORDS").map(PathBuf::from);
    let there =
        named.filter(|path| [SINE, EARTHQUAKE, LABCONTROL].iter().all(|f| path.join(f).is_file()));
    if there.is_none() {
        println!(
            "skipped: {skipped}: YAWBENCH_RECORDS names no folder with {SINE}, {EARTHQUAKE}, {LABCONTROL}"
        );
    }
    there
}

/// Effects that the mapping says are destroyed.
fn destroyed(visit: &Visit, records: &Path) -> BTreeSet<&'static str> {
    let scratch = folder("destroyed");
    let mapping = scratch.join("mapping.toml");
    std::fs::write(&mapping, &visit.mapping).unwrap();
    let tests = read_tests(&[records.join(visit.train)], Some(&mapping)).unwrap();
    std::fs::remove_dir_all(scratch).unwrap();
    tests.iter().flat_map(|test| test.destroyed.keys().copied()).collect()
}

/// The sine tests of a current that are over in a few seconds.
fn short_sines(current: usize, earthquake: &str) -> Visit {
    let tests = format!("[{current}, {}, {}]", 20 + current, 25 + current);
    Visit::utfsm(["0", "0.25", "0.5", "0.75", "1.0"][current], earthquake).only(&tests)
}

#[test]
fn a_few_tests_of_other_laboratories_come_out_as_before() {
    let Some(records) = records("identification of other laboratories' records") else { return };
    // Errors as they were when this was written, and a tenth.
    let visits = [
        (short_sines(4, "1.0"), [0.073, 0.285]),
        (Visit::labcontrol("3.212").only("[30, 34]"), [0.185, 0.216]),
    ];
    for (visit, before) in visits {
        let forbidden = destroyed(&visit, &records);
        assert!(!forbidden.is_empty());
        let found = visit.identified(&records);
        println!("{}", found.row());
        for (role, before) in before.into_iter().enumerate() {
            for model in ["refitted", "with_effects"] {
                let nrmse = found.nrmse(model, role);
                assert!(nrmse < 1.1 * before, "{} {model} {}: {nrmse}", found.name, ROLES[role]);
            }
        }
        let named: Vec<&str> =
            found.names("effects").into_iter().filter(|name| forbidden.contains(name)).collect();
        assert!(named.is_empty(), "{}: {named:?} cannot show in these records", found.name);
    }
}

#[test]
#[ignore = "a table of docs/identified-records.md; five minutes"]
fn table_1_of_short_tests() {
    print_table([
        short_sines(4, "1.0"),
        short_sines(3, "0.8"),
        short_sines(2, "0.4"),
        short_sines(1, "0.2"),
        Visit::labcontrol("0").only("[0, 3, 6, 9]"),
        Visit::labcontrol("0.871").only("[10, 13, 15, 18]"),
        Visit::labcontrol("1.98").only("[20, 22, 24, 26]"),
        Visit::labcontrol("3.212").only("[28, 30, 32, 34, 36]"),
    ]);
}

#[test]
#[ignore = "a table of docs/identified-records.md; twenty minutes"]
fn table_2_of_all_tests_of_utfsm() {
    let mut visits = vec![
        Visit::utfsm("1.0", "1.0"),
        Visit::utfsm("0.75", "0.8"),
        Visit::utfsm("0.5", "0.4"),
        Visit::utfsm("0.25", "0.2"),
    ];
    visits.extend(["0", "0.25", "0.5", "0.75", "1.0"].map(Visit::utfsm_sine));
    print_table(visits);
}

#[test]
#[ignore = "a table of docs/identified-records.md; a quarter of an hour"]
fn table_3_of_all_tests_of_labcontrol() {
    print_table(["0", "0.871", "1.98", "3.212"].map(Visit::labcontrol));
}

/// One row each, as it is ready.
fn print_table(visits: impl IntoIterator<Item = Visit>) {
    let Some(records) = records("the table") else { return };
    println!(
        "| record | tests, train + held out | train refitted | train with effects | held out refitted \
         | held out with effects | effects | left | time |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for visit in visits {
        println!("{}", visit.identified(&records).row());
    }
}
