//! A list of tests from a TOML file, and the sensors that record them.
//!
//! ```toml
//! protocol = "short"                 # optional: begin with the built-in "short" or "full" list
//!
//! [sensors]                          # optional, each key too
//! rate_hz = 1000.0
//! force_range_n = 50e3               # default: the next range above the force of the damper
//! force_noise_n = 50.0               # default 0.1 % of the range
//! coloured_noise_n = 80.0
//! coloured_rho_per_ms = 0.9
//!
//! [[test]]
//! name = "sine-2hz-5mm"
//! sine = { amplitude_m = 5e-3, frequency_hz = 2.0 }
//! mean_m = 0.02                      # optional
//! duration_s = 6.0                   # optional for paths
//! test_only = false                  # optional
//! ```
//!
//! A test has one of `sine`, `triangle { stroke_m, speed_m_per_s, cycles }`,
//! `holds { positions_m, speed_m_per_s, approach_m, hold_s }`,
//! `path { legs = [{ to_m, speed_m_per_s, hold_s }] }`,
//! `service { rms_m, lowest_hz, highest_hz, tones, seed }`.

use super::protocol::{self, ROUNDING_S, Test};
use super::sensors::{Coloured, Sensors};
use crate::excitation::{Excitation, Leg};
use files::quoted;
use scenario::quantity::Quantity;
use scenario::source::{ScenarioError, Source};
use serde::Deserialize;
use std::path::Path;

/// Longest test, s.
const LONGEST_S: f64 = 3600.0;
/// Longest name of a test, bytes.
const NAME_LONGEST: usize = 100;
/// Most samples of a test.
const SAMPLES_MAX: f64 = 5e6;
/// Noise of a usual thermometer, K.
const TEMPERATURE_NOISE_K: f64 = 0.1;

/// Tests, and what is stated about sensors.
#[derive(Debug, Clone, PartialEq)]
pub struct TestList {
    /// The tests.
    pub tests: Vec<Test>,
    /// What is stated about sensors.
    pub sensors: SensorChoice,
}

/// What a list states about sensors; the rest follows from the force of the damper.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SensorChoice {
    rate_hz: Option<f64>,
    force_range_n: Option<f64>,
    force_noise_n: Option<f64>,
    force_bits: Option<u32>,
    displacement_range_m: Option<f64>,
    displacement_noise_m: Option<f64>,
    displacement_bits: Option<u32>,
    coloured: Option<Coloured>,
    anti_alias_hz: Option<f64>,
    temperature_noise_k: Option<f64>,
}

impl SensorChoice {
    /// The sensors for these greatest values; the noise of the oil temperature is 0.1 K
    /// unless stated.
    pub fn sensors(&self, peak_force_n: f64, peak_displacement_m: f64) -> Sensors {
        let fitting = Sensors::for_peaks(peak_force_n, peak_displacement_m);
        let force_n = self.force_range_n.unwrap_or(fitting.force.range);
        let displacement_m = self.displacement_range_m.unwrap_or(fitting.displacement.range);
        let mut sensors = Sensors::of_range(force_n, displacement_m);
        sensors.rate_hz = self.rate_hz.unwrap_or(sensors.rate_hz);
        sensors.force.noise = self.force_noise_n.unwrap_or(sensors.force.noise);
        sensors.force.bits = self.force_bits.unwrap_or(sensors.force.bits);
        sensors.displacement.noise =
            self.displacement_noise_m.unwrap_or(sensors.displacement.noise);
        sensors.displacement.bits = self.displacement_bits.unwrap_or(sensors.displacement.bits);
        sensors.coloured = self.coloured;
        sensors.anti_alias_hz = Some(self.anti_alias_hz.unwrap_or(0.4 * sensors.rate_hz));
        sensors.temperature_noise_k = Some(self.temperature_noise_k.unwrap_or(TEMPERATURE_NOISE_K));
        sensors
    }
}

impl TestList {
    /// A built-in list by its name.
    pub fn built_in(name: &str) -> Option<Self> {
        let tests = match name {
            "full" => protocol::full(),
            "short" => protocol::short(),
            _ => return None,
        };
        Some(Self { tests, sensors: SensorChoice::default() })
    }

    /// The built-in list of this name, else that of the file.
    ///
    /// # Errors
    /// What does not fit in the file, with line and key.
    pub fn named(name: &str) -> Result<Self, ScenarioError> {
        match Self::built_in(name) {
            Some(list) => Ok(list),
            None => Self::load(Path::new(name)),
        }
    }

    /// Reads a list.
    ///
    /// # Errors
    /// What does not fit, with file, line and key.
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        Self::from_source(&Source::read(path)?)
    }

    /// Reads a list from text in memory.
    ///
    /// # Errors
    /// What does not fit, with file, line and key.
    pub fn from_source(source: &Source) -> Result<Self, ScenarioError> {
        let table: ListTable = source.parse()?;
        let mut tests = Vec::new();
        if let Some(name) = &table.protocol {
            let Some(list) = Self::built_in(name) else {
                let message =
                    format!("protocol = \"{}\", expected \"full\" or \"short\"", quoted(name));
                return Err(source.whole_error(message));
            };
            tests = list.tests;
        }
        for test in &table.test {
            let built = test.build(source)?;
            if tests.iter().any(|other| other.name == built.name) {
                return Err(
                    source.whole_error(format!("two tests have the name \"{}\"", built.name))
                );
            }
            tests.push(built);
        }
        if tests.is_empty() {
            return Err(source.whole_error("no tests, expected [[test]] tables or a protocol"));
        }
        let sensors = table.sensors.build(source)?;
        let samples = |test: &Test| test.duration_s * sensors.rate_hz.unwrap_or(1000.0);
        if let Some(long) = tests.iter().find(|test| samples(test) > SAMPLES_MAX) {
            let message = format!(
                "test \"{}\" has {:.0} samples, expected at most {SAMPLES_MAX:.0}",
                long.name,
                samples(long)
            );
            return Err(source.whole_error(message));
        }
        Ok(Self { tests, sensors })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ListTable {
    protocol: Option<String>,
    #[serde(default)]
    sensors: SensorTable,
    #[serde(default)]
    test: Vec<TestTable>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct SensorTable {
    rate_hz: Option<Quantity>,
    force_range_n: Option<Quantity>,
    force_noise_n: Option<Quantity>,
    force_bits: Option<u32>,
    displacement_range_m: Option<Quantity>,
    displacement_noise_m: Option<Quantity>,
    displacement_bits: Option<u32>,
    coloured_noise_n: Option<Quantity>,
    coloured_rho_per_ms: Option<Quantity>,
    anti_alias_hz: Option<Quantity>,
    temperature_noise_k: Option<Quantity>,
}

impl SensorTable {
    fn build(&self, source: &Source) -> Result<SensorChoice, ScenarioError> {
        let positive = |value: &Option<Quantity>, key: &str| {
            value.as_ref().map(|value| value.positive(source, key)).transpose()
        };
        let not_negative = |value: &Option<Quantity>, key: &str| {
            value.as_ref().map(|value| value.not_negative(source, key)).transpose()
        };
        let rate_hz = self
            .rate_hz
            .as_ref()
            .map(|rate| rate.within(source, "rate_hz", 100.0, 50e3, "100 to 50000 Hz"))
            .transpose()?;
        let half_rate = 0.5 * rate_hz.unwrap_or(1000.0);
        let anti_alias_hz = self
            .anti_alias_hz
            .as_ref()
            .map(|corner| {
                let expected = format!("above 0 and up to half the rate, {half_rate} Hz");
                corner.within(source, "anti_alias_hz", f64::MIN_POSITIVE, half_rate, &expected)
            })
            .transpose()?;
        for (bits, key) in
            [(self.force_bits, "force_bits"), (self.displacement_bits, "displacement_bits")]
        {
            if let Some(bits) = bits.filter(|bits| !(8..=32).contains(bits)) {
                return Err(source.whole_error(format!("{key} = {bits}, expected 8 to 32")));
            }
        }
        let rho = match (&self.coloured_noise_n, &self.coloured_rho_per_ms) {
            (None, Some(rho)) => {
                return Err(rho.error(source, "coloured_rho_per_ms without coloured_noise_n"));
            }
            (_, Some(rho)) => {
                rho.within(source, "coloured_rho_per_ms", 0.0, 0.9999, "0 to below 1")?
            }
            (_, None) => 0.9,
        };
        let level_n = not_negative(&self.coloured_noise_n, "coloured_noise_n")?;
        Ok(SensorChoice {
            rate_hz,
            force_range_n: positive(&self.force_range_n, "force_range_n")?,
            force_noise_n: not_negative(&self.force_noise_n, "force_noise_n")?,
            force_bits: self.force_bits,
            displacement_range_m: positive(&self.displacement_range_m, "displacement_range_m")?,
            displacement_noise_m: not_negative(&self.displacement_noise_m, "displacement_noise_m")?,
            displacement_bits: self.displacement_bits,
            coloured: level_n.map(|level_n| Coloured { level_n, rho_per_ms: rho }),
            anti_alias_hz,
            temperature_noise_k: not_negative(&self.temperature_noise_k, "temperature_noise_k")?,
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TestTable {
    name: String,
    mean_m: Option<Quantity>,
    duration_s: Option<Quantity>,
    #[serde(default)]
    test_only: bool,
    sine: Option<SineTable>,
    triangle: Option<TriangleTable>,
    holds: Option<HoldsTable>,
    path: Option<PathTable>,
    service: Option<ServiceTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SineTable {
    amplitude_m: Quantity,
    frequency_hz: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TriangleTable {
    stroke_m: Quantity,
    speed_m_per_s: Quantity,
    cycles: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct HoldsTable {
    positions_m: Vec<Quantity>,
    speed_m_per_s: Quantity,
    approach_m: Quantity,
    hold_s: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PathTable {
    legs: Vec<LegTable>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LegTable {
    to_m: Quantity,
    speed_m_per_s: Quantity,
    hold_s: Quantity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ServiceTable {
    rms_m: Quantity,
    lowest_hz: Quantity,
    highest_hz: Quantity,
    tones: usize,
    seed: u64,
}

impl TestTable {
    fn build(&self, source: &Source) -> Result<Test, ScenarioError> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        let named = (1..=NAME_LONGEST).contains(&self.name.len()) && !self.name.starts_with('.');
        if !named || !self.name.chars().all(plain) {
            let message = format!(
                "name = \"{}\", expected up to {NAME_LONGEST} letters, digits, - _ . that can name a file",
                quoted(&self.name)
            );
            return Err(source.whole_error(message));
        }
        let excitation = self.excitation(source)?;
        let seconds = "above 0 and up to an hour";
        let given = self
            .duration_s
            .as_ref()
            .map(|value| value.within(source, "duration_s", 0.01, LONGEST_S, seconds))
            .transpose()?;
        let Some(duration_s) = given.or(excitation.end_s()) else {
            return Err(source.whole_error(format!("test \"{}\" has no duration_s", self.name)));
        };
        if duration_s > LONGEST_S {
            let message =
                format!("test \"{}\" takes {duration_s:.0} s, expected {seconds}", self.name);
            return Err(source.whole_error(message));
        }
        let mean_m =
            self.mean_m.as_ref().map(|value| value.finite(source, "mean_m")).transpose()?;
        Ok(Test {
            name: self.name.clone(),
            excitation,
            mean_m: mean_m.unwrap_or(0.0),
            duration_s,
            test_only: self.test_only,
        })
    }

    fn excitation(&self, source: &Source) -> Result<Excitation, ScenarioError> {
        let mut found = Vec::new();
        if let Some(sine) = &self.sine {
            let frequency_hz = frequency(&sine.frequency_hz, source, "frequency_hz")?;
            found.push(Excitation::sine(
                sine.amplitude_m.positive(source, "amplitude_m")?,
                frequency_hz,
            ));
        }
        if let Some(triangle) = &self.triangle {
            if !(1..=1000).contains(&triangle.cycles) {
                let message = format!("cycles = {}, expected 1 to 1000", triangle.cycles);
                return Err(triangle.stroke_m.error(source, message));
            }
            let stroke_m = triangle.stroke_m.positive(source, "stroke_m")?;
            let speed = triangle.speed_m_per_s.positive(source, "speed_m_per_s")?;
            found.push(Excitation::triangle(stroke_m, speed, triangle.cycles, ROUNDING_S));
        }
        if let Some(holds) = &self.holds {
            let positions = holds.positions_m.iter().map(|at| at.finite(source, "positions_m"));
            let positions_m = positions.collect::<Result<Vec<_>, _>>()?;
            if positions_m.is_empty() || positions_m.windows(2).any(|pair| pair[0] >= pair[1]) {
                let message = format!("positions_m = {positions_m:?}, expected rising positions");
                return Err(holds.hold_s.error(source, message));
            }
            found.push(protocol::static_holds(
                &positions_m,
                holds.speed_m_per_s.positive(source, "speed_m_per_s")?,
                holds.approach_m.positive(source, "approach_m")?,
                holds.hold_s.positive(source, "hold_s")?,
            ));
        }
        if let Some(path) = &self.path {
            let legs = path.legs.iter().map(|leg| {
                Ok(Leg {
                    to_m: leg.to_m.finite(source, "to_m")?,
                    speed_m_per_s: leg.speed_m_per_s.positive(source, "speed_m_per_s")?,
                    hold_s: leg.hold_s.not_negative(source, "hold_s")?,
                })
            });
            found.push(Excitation::path(
                &legs.collect::<Result<Vec<_>, ScenarioError>>()?,
                ROUNDING_S,
            ));
        }
        if let Some(service) = &self.service {
            let lowest_hz = frequency(&service.lowest_hz, source, "lowest_hz")?;
            let highest_hz = frequency(&service.highest_hz, source, "highest_hz")?;
            if highest_hz <= lowest_hz || !(2..=200).contains(&service.tones) {
                let message = format!(
                    "{} tones from {lowest_hz} to {highest_hz} Hz, expected 2 to 200, rising",
                    service.tones
                );
                return Err(service.lowest_hz.error(source, message));
            }
            let rms_m = service.rms_m.positive(source, "rms_m")?;
            found.push(protocol::service(
                rms_m,
                lowest_hz,
                highest_hz,
                service.tones,
                service.seed,
            ));
        }
        match found.len() {
            1 => Ok(found.remove(0)),
            count => Err(source.whole_error(format!(
                "test \"{}\" has {count} motions, expected one of sine, triangle, holds, path, service",
                self.name
            ))),
        }
    }
}

fn frequency(value: &Quantity, source: &Source, key: &str) -> Result<f64, ScenarioError> {
    value.within(source, key, 1e-3, 200.0, "0.001 to 200 Hz")
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIST: &str = "
[sensors]
rate_hz = 2000.0
coloured_noise_n = 80.0
[[test]]
name = \"sine-2hz\"
sine = { amplitude_m = 5e-3, frequency_hz = 2.0 }
duration_s = 6.0
mean_m = 0.02
[[test]]
name = \"triangle\"
triangle = { stroke_m = 5e-3, speed_m_per_s = 5e-3, cycles = 2 }
[[test]]
name = \"holds\"
holds = { positions_m = [-0.01, 0.0], speed_m_per_s = 0.02, approach_m = 2e-3, hold_s = 1.0 }
[[test]]
name = \"path\"
path = { legs = [{ to_m = 5e-3, speed_m_per_s = 0.02, hold_s = 3.0 }] }
[[test]]
name = \"road\"
service = { rms_m = 2e-3, lowest_hz = 0.5, highest_hz = 12.0, tones = 30, seed = 7 }
duration_s = 20.0
test_only = true
";

    fn read(text: &str) -> Result<TestList, ScenarioError> {
        TestList::from_source(&Source::from_text(Path::new("list.toml"), text))
    }

    #[test]
    fn every_motion_can_be_asked_for() {
        let list = read(LIST).unwrap();
        let names: Vec<&str> = list.tests.iter().map(|test| test.name.as_str()).collect();
        assert_eq!(names, ["sine-2hz", "triangle", "holds", "path", "road"]);
        assert_eq!((list.tests[0].mean_m, list.tests[0].duration_s), (0.02, 6.0));
        assert!(list.tests[4].test_only && !list.tests[0].test_only);
        assert_eq!(list.tests[1].excitation, Excitation::triangle(5e-3, 5e-3, 2, ROUNDING_S));
        let sensors = list.sensors.sensors(18e3, 8e-3);
        assert_eq!(
            (sensors.rate_hz, sensors.force.range, sensors.force.noise),
            (2000.0, 50e3, 50.0)
        );
        assert_eq!(sensors.anti_alias_hz, Some(800.0));
        assert_eq!(sensors.coloured, Some(Coloured { level_n: 80.0, rho_per_ms: 0.9 }));
        let both = read(&format!("protocol = \"short\"\n{LIST}")).unwrap();
        assert_eq!(both.tests.len(), protocol::short().len() + 5);
    }

    #[test]
    fn what_does_not_fit_is_named_with_file_and_line() {
        let cases = [
            ("amplitude_m = 5e-3", "amplitude_m = -5e-3", "list.toml:7: amplitude_m = -0.005"),
            ("frequency_hz = 2.0", "frequency_hz = 2000.0", "list.toml:7: frequency_hz = 2000"),
            ("duration_s = 6.0", "duration_s = 1e9", "list.toml:8: duration_s"),
            ("name = \"path\"", "name = \"../path\"", "\"../path\""),
            ("name = \"path\"", "name = \"holds\"", "two tests have the name \"holds\""),
            ("duration_s = 20.0", "", "test \"road\" has no duration_s"),
            ("cycles = 2", "cycles = 0", "list.toml:12: cycles = 0"),
            ("rate_hz = 2000.0", "rate_hz = 20.0", "list.toml:3: rate_hz = 20"),
            ("mean_m = 0.02", "path = { legs = [] }", "test \"sine-2hz\" has 2 motions"),
            ("[-0.01, 0.0]", "[0.01, 0.0]", "list.toml:15: positions_m = [0.01, 0.0]"),
            ("stroke_m = 5e-3", "stroke_mm = 5.0", "stroke_mm"),
        ];
        for (from, to, expected) in cases {
            assert!(LIST.contains(from), "{from}");
            let text = read(&LIST.replacen(from, to, 1)).unwrap_err().to_string();
            assert!(text.contains(expected), "{from} -> {to}: {text}");
        }
        assert!(read("").unwrap_err().to_string().contains("no tests"));
        assert!(read("protocol = \"long\"").unwrap_err().to_string().contains("\"long\""));
    }
}
