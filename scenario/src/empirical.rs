//! An empirical map in the file of a damper: what `identify --empirical` has added to its
//! physics.
//!
//! ```toml
//! [damper.empirical]
//! coordinate = "displacement"        # or dashpot_velocity, force, time_since_reversal
//! at = [-3e-3, 0.0, 3e-3]            # rising, in the SI unit of the coordinate
//! upper_n = [40.0, -15.0, 0.0]       # added while the eyes move apart
//! lower_n = [0.0, 15.0, -40.0]       # added while they move together
//! reversal_m_per_s = 1e-3            # slower motion the other way is no reversal
//! ```
//!
//! Straight between the places and constant beyond the first and the last.

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use firmware_core::damper::{EmpiricalMap, MAP_KNOTS, MapCoordinate, MapKnot};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// A map as it stands in a file.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct EmpiricalFile {
    /// What it is drawn over.
    pub coordinate: Over,
    /// Places of the knots, rising.
    pub at: Vec<Quantity>,
    /// Force at each while the eyes move apart.
    pub upper_n: Vec<Quantity>,
    /// Force at each while they move together.
    pub lower_n: Vec<Quantity>,
    /// Speed the other way at which the motion has turned.
    pub reversal_m_per_s: Quantity,
}

/// The name of a coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Over {
    /// Displacement between the eyes, m.
    Displacement,
    /// Velocity of the piston, m/s.
    DashpotVelocity,
    /// Force in the chain, N.
    Force,
    /// Time since the motion last turned, s.
    TimeSinceReversal,
}

impl Over {
    const fn coordinate(self) -> MapCoordinate {
        match self {
            Self::Displacement => MapCoordinate::Displacement,
            Self::DashpotVelocity => MapCoordinate::DashpotVelocity,
            Self::Force => MapCoordinate::Force,
            Self::TimeSinceReversal => MapCoordinate::TimeSinceReversal,
        }
    }

    const fn of(coordinate: MapCoordinate) -> Self {
        match coordinate {
            MapCoordinate::Displacement => Self::Displacement,
            MapCoordinate::DashpotVelocity => Self::DashpotVelocity,
            MapCoordinate::Force => Self::Force,
            MapCoordinate::TimeSinceReversal => Self::TimeSinceReversal,
        }
    }
}

impl EmpiricalFile {
    /// The values of a map.
    pub fn from_map(map: &EmpiricalMap) -> Self {
        let all = |of: fn(&MapKnot) -> f64| -> Vec<Quantity> {
            map.knots().iter().map(|knot| Quantity::plain(of(knot))).collect()
        };
        Self {
            coordinate: Over::of(map.coordinate()),
            at: all(|knot| knot.at),
            upper_n: all(|knot| knot.upper_n),
            lower_n: all(|knot| knot.lower_n),
            reversal_m_per_s: Quantity::plain(map.reversal_m_per_s()),
        }
    }

    /// Writes the table as [`Self::build`] reads it back, to the same bits.
    pub(crate) fn write(&self, text: &mut String) {
        let name = self.coordinate.coordinate().name();
        text.push_str(
            "\n# No physics: valid only where it was fitted, constant beyond its ends.\n",
        );
        let _ = writeln!(text, "[damper.empirical]\ncoordinate = \"{name}\"");
        for (key, numbers) in self.lists() {
            let values: Vec<f64> = numbers.iter().map(|number| number.value).collect();
            let _ = writeln!(text, "{key} = {values:?}");
        }
        let _ = writeln!(text, "reversal_m_per_s = {:?}", self.reversal_m_per_s.value);
    }

    /// Builds the map.
    ///
    /// # Errors
    /// Lists of different lengths, too few or too many knots, places that do not rise, a number
    /// that is not finite, with file and line.
    pub fn build(&self, source: &Source) -> Result<EmpiricalMap, ScenarioError> {
        let count = self.at.len();
        for (key, numbers) in self.lists() {
            let found = numbers.len();
            let (fits, expected) = if key == "at" {
                ((2..=MAP_KNOTS).contains(&found), format!("2 to {MAP_KNOTS}"))
            } else {
                (found == count, format!("{count} as in at"))
            };
            if !fits {
                let message = format!("empirical: numbers in {key}: {found}, expected {expected}");
                let place = numbers.first().unwrap_or(&self.reversal_m_per_s);
                return Err(place.error(source, message));
            }
        }
        for (before, after) in self.at.iter().zip(self.at.iter().skip(1)) {
            let (at, last) = (after.finite(source, "at")?, before.finite(source, "at")?);
            if at <= last {
                let message = format!("empirical: at = {at} after {last}, expected rising places");
                return Err(after.error(source, message));
            }
        }
        let mut knots = Vec::with_capacity(count);
        for ((at, upper_n), lower_n) in self.at.iter().zip(&self.upper_n).zip(&self.lower_n) {
            knots.push(MapKnot {
                at: at.value,
                upper_n: upper_n.finite(source, "upper_n")?,
                lower_n: lower_n.finite(source, "lower_n")?,
            });
        }
        let reversal_m_per_s = self.reversal_m_per_s.not_negative(source, "reversal_m_per_s")?;
        EmpiricalMap::new(self.coordinate.coordinate(), &knots, reversal_m_per_s)
            .map_err(|error| self.reversal_m_per_s.error(source, error.to_string()))
    }

    fn lists(&self) -> [(&'static str, &[Quantity]); 3] {
        [("at", &self.at), ("upper_n", &self.upper_n), ("lower_n", &self.lower_n)]
    }
}

#[cfg(test)]
mod tests {
    use crate::damper::DamperFile;
    use crate::error::ScenarioError;
    use crate::quantity::Provenance;
    use crate::source::Source;
    use firmware_core::damper::{Damper, EmpiricalMap, MapCoordinate, MapKnot, Nominal};
    use std::collections::BTreeMap;
    use std::path::Path;

    const MODEL: &str = "[damper]\nke_n_per_m = 9.87e6\n\n[damper.empirical]\n\
        coordinate = \"displacement\"\nat = [-3e-3, 0, 3e-3]\nupper_n = [40.0, -15.0, 0.0]\n\
        lower_n = [0.0, 15.0, -40.0]\nreversal_m_per_s = 1e-3\n";

    fn read(name: &str, text: &str) -> Result<Damper, ScenarioError> {
        let folder = std::env::temp_dir().join(format!("yawbench-map-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        std::fs::write(&path, text).unwrap();
        let built = DamperFile::load_model(&path)?.build(&Source::read(&path).unwrap());
        std::fs::remove_file(&path).unwrap();
        built
    }

    #[test]
    fn a_map_is_read_as_it_stands() {
        let damper = read("good.toml", MODEL).unwrap();
        let map = damper.empirical().unwrap();
        assert_eq!((map.coordinate(), map.knots().len()), (MapCoordinate::Displacement, 3));
        assert_eq!(map.knots()[2], MapKnot { at: 3e-3, upper_n: 0.0, lower_n: -40.0 });
        assert_eq!((map.reversal_m_per_s(), damper.nominal().ke_n_per_m), (1e-3, 9.87e6));
    }

    #[test]
    fn every_coordinate_is_written_and_read_back_to_the_same_bits() {
        for (index, coordinate) in [
            MapCoordinate::Displacement,
            MapCoordinate::DashpotVelocity,
            MapCoordinate::Force,
            MapCoordinate::TimeSinceReversal,
        ]
        .into_iter()
        .enumerate()
        {
            let third = |k: f64| (k - 7.3 + index as f64) / 3.0;
            let knots: Vec<MapKnot> = (0..16)
                .map(|k| third(f64::from(k)))
                .map(|at| MapKnot { at: 1e-7 * at, upper_n: 1e9 / at, lower_n: -at * at * 0.1 })
                .collect();
            let map = EmpiricalMap::new(coordinate, &knots, 0.1 / 3.0).unwrap();
            let damper = Damper::new(Nominal::NEW, &[]).unwrap().with_empirical(map);
            let file = DamperFile::from_damper(&damper, Provenance::Identified, &BTreeMap::new());
            assert_eq!(read("again.toml", &file.to_model("a map")).unwrap(), damper);
            // The effective scenario of a run goes through serde.
            let whole = toml::to_string(&BTreeMap::from([("damper", &file)])).unwrap();
            assert_eq!(read("serde.toml", &whole).unwrap(), damper, "{whole}");
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (from, to, line, parts) in [
            ("displacement", "speed", 5, &["speed", "dashpot_velocity"][..]),
            ("[-3e-3, 0, 3e-3]", "[1e-3]", 6, &["numbers in at: 1", "2 to 16"]),
            ("[-3e-3, 0, 3e-3]", "[-3e-3, 1e-3, 1e-3]", 6, &["at = 0.001 after 0.001", "rising"]),
            ("[-3e-3, 0, 3e-3]", "[-3e-3, nan, 3e-3]", 6, &["at = NaN", "a finite number"]),
            ("[40.0, -15.0, 0.0]", "[40.0, -15.0]", 7, &["numbers in upper_n: 2", "3 as in at"]),
            ("-40.0]", "\ninf]", 9, &["lower_n = inf", "a finite number"]),
            ("= 1e-3", "= -1e-3", 9, &["reversal_m_per_s = -0.001", "zero or more"]),
            ("upper_n", "top_n", 7, &["top_n", "upper_n"]),
        ] {
            assert!(MODEL.contains(from));
            let error = read("bad.toml", &MODEL.replace(from, to)).unwrap_err();
            assert_eq!(error.place().unwrap().line, Some(line), "{error}");
            for part in parts {
                assert!(error.to_string().contains(part), "no {part} in {error}");
            }
        }
    }

    #[test]
    fn a_map_given_over_a_model_takes_the_place_of_its_own() {
        #[derive(serde::Deserialize)]
        struct Whole {
            damper: DamperFile,
        }
        let source = Source::from_text(Path::new("a.toml"), MODEL.split_once("\n\n").unwrap().1);
        let Whole { damper: over } = source.parse().unwrap();
        let both = over.over(&DamperFile::new_damper());
        assert!(both.empirical.is_some() && both.ke_n_per_m.is_some());
        assert_eq!(DamperFile::new_damper().over(&over).empirical, over.empirical);
    }
}
