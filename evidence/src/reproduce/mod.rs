//! The study of 2014 on the yaw dampers of an SS9, figure by figure: its statements compared
//! with our results.
//!
//! "A locomotive's dynamic response to in-service parameter variations of its hydraulic yaw
//! damper", Nonlinear Dynamics (2014). Its appendix with the parameters is not public: the vehicle
//! here is an analogue, and three numbers of it that are public nowhere are calibrated, each on one
//! critical speed ([`calibrate`]). [`Role`] says which number has which role.
//!
//! | module | of the study |
//! | --- | --- |
//! | `running` | figures 4 and 8: accelerations, damper forces |
//! | `comfort` | figures 5 and 12 to 17: spectra and ride indices |
//! | `working_point` | what was tried where figures 8 and 13 are not met |
//! | `oil` | figure 6 and conclusion (4): oil temperature and air |
//! | `limit_cycle` | figures 9 and 11: the motion of a wheelset after the rough track |
//! | `critical_speeds` | figures 10a and 10b: over stiffness and clearance |
//! | `curving` | figures 18 and 19: the curve of 400 m |
//! | `spread` | the effect on critical speeds of inputs that are neither known nor fitted |

mod basis;
mod calibration;
mod comfort;
mod critical_speeds;
mod curving;
mod limit_cycle;
mod locomotive;
mod null_models;
mod oil;
mod page;
mod row;
mod running;
mod spread;
mod working_point;

use crate::error::EvidenceError;
pub use basis::Basis;
pub use calibration::{Calibrated, UNKNOWNS, Unknown, calibrate};
pub use locomotive::Locomotive;
pub use page::{page, text};
pub use row::{Figure, Role, Row};

/// A figure that can be made.
#[derive(Debug, Clone, Copy)]
pub struct Recipe {
    /// Its number in the study.
    pub number: &'static str,
    /// What it shows.
    pub title: &'static str,
    make: fn(&Basis<'_>) -> Result<Figure, EvidenceError>,
}

impl Recipe {
    /// Makes it.
    ///
    /// # Errors
    /// The vehicle does not run steadily, or cannot be changed so; the files of the scenario have
    /// changed since the basis was read; the work is stopped ([`EvidenceError::Stopped`]).
    pub fn make(&self, basis: &Basis<'_>) -> Result<Figure, EvidenceError> {
        let figure = (self.make)(basis).map_err(|why| why.in_figure(self.number))?;
        basis.refuse_changed()?;
        Ok(figure)
    }
}

/// All figures, in the order of the study.
pub const FIGURES: [Recipe; 14] = [
    Recipe { number: "4", title: "lateral accelerations", make: running::accelerations },
    Recipe { number: "5", title: "ride over speed", make: comfort::over_speed },
    Recipe { number: "6", title: "oil temperature and air", make: oil::temperature_and_air },
    Recipe { number: "8", title: "damper forces", make: running::damper_forces },
    Recipe {
        number: "8 and 13",
        title: "what was tried on the working point",
        make: working_point::tried,
    },
    Recipe { number: "9", title: "wheelset 4 over speed", make: limit_cycle::with_speed },
    Recipe {
        number: "10a",
        title: "critical speed over stiffness",
        make: critical_speeds::over_stiffness,
    },
    Recipe {
        number: "10b",
        title: "critical speed over clearance",
        make: critical_speeds::over_clearance,
    },
    Recipe { number: "10", title: "spread of critical speeds", make: spread::of_inputs },
    Recipe {
        number: "11",
        title: "wheelset 4 with worn-out dampers",
        make: limit_cycle::suspended,
    },
    Recipe { number: "12-14", title: "bogie, ride over stiffness", make: comfort::over_stiffness },
    Recipe { number: "15-17", title: "carbody over clearance", make: comfort::over_clearance },
    Recipe { number: "18", title: "curve over stiffness", make: curving::over_stiffness },
    Recipe { number: "19", title: "curve over clearance", make: curving::over_clearance },
];

/// The figures that a number means: `10` is `10a` and `10b` too, `13` is in `12-14`.
///
/// ```
/// use evidence::reproduce::named;
/// let numbers = |number| named(number).iter().map(|r| r.number).collect::<Vec<_>>();
/// assert_eq!(numbers("10a"), ["10a"]);
/// assert_eq!(numbers("10"), ["10a", "10b", "10"]);
/// assert_eq!(numbers("11"), ["11"]);
/// assert_eq!(numbers("13"), ["8 and 13", "12-14"]);
/// assert!(named("7").is_empty());
/// ```
pub fn named(number: &str) -> Vec<Recipe> {
    let asked = number.parse::<u32>().ok();
    let plain =
        |text: &str| text.trim_end_matches(|c: char| c.is_ascii_alphabetic()).parse::<u32>().ok();
    let within = |part: &str| match (asked, part.split_once('-')) {
        (Some(asked), Some((from, to))) => {
            plain(from).zip(plain(to)).is_some_and(|(from, to)| (from..=to).contains(&asked))
        }
        (Some(asked), None) => plain(part) == Some(asked),
        (None, _) => false,
    };
    let means = |r: &Recipe| r.number == number || r.number.split(" and ").any(within);
    FIGURES.into_iter().filter(means).collect()
}
