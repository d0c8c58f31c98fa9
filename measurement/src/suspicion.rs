//! Units that nobody stated and that the sizes speak against: said aloud, never changed.

use crate::layout::Reading;
use crate::series::Series;
use signal::statistics::min_max;

/// A force of a damper test that never leaves this is more likely in kilonewtons, N.
const FORCE_LEAST_N: f64 = 100.0;
/// A travel above this is more likely in millimetres or inches, m.
const TRAVEL_MUCH_M: f64 = 0.5;
/// A stamp every so many seconds, or seldom, is more likely in milliseconds.
const RATE_LEAST_HZ: f64 = 20.0;
/// More samples a second than these are no converter's.
pub(crate) const RATE_MOST_HZ: f64 = 1e6;
/// Temperatures of a damper: from the coldest climate to oil on fire, degrees Celsius.
const TEMPERATURES_DEGC: std::ops::RangeInclusive<f64> = -60.0..=300.0;

/// Reports what looks like another unit, where neither the mapping nor the file states one.
pub(crate) fn report(
    series: &mut Series,
    is_stated: impl Fn(&Reading) -> bool,
    displacement: &Reading,
    force: &Reading,
) {
    let [_, displacement_name, force_name] = &series.columns;
    let mut said = Vec::new();
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let force_n = most(&series.force_n);
    if !is_stated(force) && force.column != displacement.column && force_n < FORCE_LEAST_N {
        said.push(format!(
            "{force_name}: at most {force_n:.4} N, taken as newtons: is it in kN? [force] unit = \
             \"kN\" in a mapping says so"
        ));
    }
    let travel_m = min_max(&series.displacement_m).map_or(0.0, |(low, high)| high - low);
    if !is_stated(displacement) && travel_m > TRAVEL_MUCH_M {
        said.push(format!(
            "{displacement_name}: a travel of {travel_m:.4} m: is it in mm? [displacement] unit = \
             \"mm\" in a mapping says so"
        ));
    }
    for (reading, values, name) in [
        (displacement, &series.displacement_m, displacement_name),
        (force, &series.force_n, force_name),
    ] {
        // Counts of a converter mostly have their zero in the middle of their range.
        let Some((low, high)) = min_max(values).filter(|_| reading.scale.is_some()) else {
            continue;
        };
        let middle = 0.5 * (low + high);
        if reading.offset == 0.0 && middle.abs() > 0.5 * (high - low) {
            said.push(format!(
                "{name}: a scale without an offset, and values about {middle:.4} and not about 0: \
                 offset is the reading that means zero"
            ));
        }
    }
    series.repairs.extend(said);
}

/// Reports temperatures that no damper has.
pub(crate) fn report_temperature(series: &mut Series, name: &str) {
    let Some((low, high)) = series.temperature_degc.as_deref().and_then(min_max) else { return };
    if !(TEMPERATURES_DEGC.contains(&low) && TEMPERATURES_DEGC.contains(&high)) {
        let (low, high) = (files::number(low), files::number(high));
        series.repairs.push(format!("{name}: {low} to {high} degC: another unit?"));
    }
}

/// What a clock of this rate may be in truth; empty where it can be what it says.
pub(crate) fn of_rate(rate_hz: f64) -> &'static str {
    match rate_hz {
        rate if rate >= RATE_MOST_HZ => ": is the time in days, hours or minutes?",
        rate if rate >= RATE_LEAST_HZ => "",
        rate if (RATE_LEAST_HZ..=RATE_MOST_HZ).contains(&(1e3 * rate)) => {
            ": is the time in milliseconds? [time] unit = \"ms\" in a mapping says so"
        }
        rate if (RATE_LEAST_HZ..=RATE_MOST_HZ).contains(&(1e6 * rate)) => {
            ": is the time in microseconds? [time] unit = \"us\" in a mapping says so"
        }
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_in_milliseconds_is_suspected() {
        assert!(of_rate(1.0).contains("\"ms\"") && of_rate(0.5).contains("\"ms\""));
        assert!(of_rate(1e-3).contains("\"us\"") && of_rate(86.4e6).contains("days"));
        assert_eq!(of_rate(500.0), "");
    }
}
