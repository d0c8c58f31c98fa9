//! Which results are right, and which cases count.
//!
//! A name is right if it is the truth or has it among the alternatives that `identify` computed
//! from the records. Effects whose size could not be reached are counted apart; disturbances
//! outside the catalogue and hidden inputs count wherever they are three times the noise, within
//! the tolerance of the search for their size.

use super::design::AS_LOWER_KE;
use super::line::CaseResult;
use firmware_core::damper::effects::CATALOGUE;

/// Least size from which a disturbance counts, in multiples of the noise.
const LEAST_UNKNOWN: f64 = 2.75;

/// The case is as it should be, as far as names go.
pub fn is_right(line: &CaseResult) -> bool {
    if line.failure.is_some() {
        return false;
    }
    match line.kind.as_str() {
        "nothing" => line.named.is_empty(),
        "outside" | "hidden" => !line.is_clean() && !line.is_confident(),
        "neighbour" => line.first_is_right() || line.is_honest(),
        "hydraulic" => !line.named.iter().any(|name| is_foreign(&name.name)),
        "wrong_datasheet" => line.datasheet_moved == Some(false),
        "pair" => line.truth.iter().all(|truth| line.named.iter().any(|name| name.may_be(truth))),
        _ if is_as_lower_ke(line) => line.named.is_empty(),
        _ => line.first_is_right(),
    }
}

/// The case counts: what is missing has the size that it should have.
pub(super) fn counts(line: &CaseResult) -> bool {
    if line.failure.is_some() {
        return true;
    }
    match line.kind.as_str() {
        "outside" | "hidden" => line.sizes.iter().all(|size| *size >= LEAST_UNKNOWN),
        // Whatever is missing, a datasheet changes nothing.
        "wrong_datasheet" => true,
        _ => line.reached || is_as_lower_ke(line),
    }
}

/// What is missing is exactly a lower Ke.
pub(super) fn is_as_lower_ke(line: &CaseResult) -> bool {
    line.truth.iter().any(|truth| truth == AS_LOWER_KE)
}

/// What is missing is smaller than what has to be found.
pub(super) fn is_small(line: &CaseResult) -> bool {
    (0.1..3.0).contains(&line.size)
}

/// The hydraulic dampers do not have this effect.
fn is_foreign(effect: &str) -> bool {
    CATALOGUE.iter().any(|info| info.name == effect && !info.in_hydraulic_model)
}
