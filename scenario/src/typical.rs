//! What a yaw damper usually has: a number far off is run all the same, with a warning.
//!
//! A clearance of 4 m is possible, and takes the damper off; more often it was meant in
//! millimetres.

use firmware_core::damper::{Damper, Nominal};

/// The key of a number, how to read it, its usual range.
type Range = (&'static str, fn(&Nominal) -> f64, f64, f64);

/// Around the dampers of locomotives and coaches, with room for worn and for very soft ones.
const RANGES: [Range; 5] = [
    ("ce_n_s_per_m", |nominal| nominal.ce_n_s_per_m, 1e4, 1e7),
    ("ke_n_per_m", |nominal| nominal.ke_n_per_m, 5e5, 1e8),
    ("clearance_2a_m", |nominal| nominal.clearance_2a_m, 0.0, CLEARANCE_MAX_M),
    ("f_relief_n", |nominal| nominal.f_relief_n, 1e3, 1e5),
    ("c2_n_s_per_m", |nominal| nominal.c2_n_s_per_m, 0.0, 1e6),
];

/// Largest usual total clearance (m); the study of worn dampers goes to 8 mm.
const CLEARANCE_MAX_M: f64 = 0.02;

/// What is unusual about a damper, one line each without the place:
/// `clearance_2a_m = 4, usual are 0 to 0.02: is the unit right?`
///
/// ```
/// use firmware_core::damper::{Damper, Nominal};
/// let worn = Nominal { clearance_2a_m: 4.0, ..Nominal::NEW };
/// let damper = Damper::new(worn, &[])?;
/// assert_eq!(
///     scenario::typical::warnings(&damper),
///     ["clearance_2a_m = 4, usual are 0 to 0.02: is the unit right?"]
/// );
/// assert!(scenario::typical::warnings(&Damper::new(Nominal::NEW, &[])?).is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn warnings(damper: &Damper) -> Vec<String> {
    let nominal = damper.nominal();
    let unusual = |(key, read, lowest, highest): &Range| {
        let value = read(nominal);
        // A damper without relief says so on purpose.
        let usual = (*lowest..=*highest).contains(&value) || value.is_infinite();
        (!usual).then(|| line(key, value, *lowest, *highest))
    };
    RANGES.iter().filter_map(unusual).collect()
}

/// What is unusual about wear in software.
pub(crate) fn wear_warning(clearance_2a_m: f64) -> Option<String> {
    let key = "virtual_wear.clearance_2a_m";
    (clearance_2a_m > CLEARANCE_MAX_M).then(|| line(key, clearance_2a_m, 0.0, CLEARANCE_MAX_M))
}

fn line(key: &str, value: f64, lowest: f64, highest: f64) -> String {
    format!("{key} = {value}, usual are {lowest} to {highest}: is the unit right?")
}
