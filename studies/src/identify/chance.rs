//! How likely chance alone does as much.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability that scores of independent blocks, each with mean zero, add up to as much:
///
/// ```text
/// t = sum s_b / sqrt(sum s_b^2), Student with one degree of freedom less than blocks
/// ```
///
/// Nothing is said of the scores' size or of what is within a block.
///
/// ```
/// use studies::identify::chance::one_sided;
/// // Sixteen blocks that all agree: t = 4.
/// assert!((one_sided(&[1.0; 16]) - 0.000_58).abs() < 1e-5);
/// assert!((one_sided(&[1.0, -1.0]) - 0.5).abs() < 1e-12);
/// ```
pub fn one_sided(scores: &[f64]) -> f64 {
    let scatter = scores.iter().map(|score| score * score).sum::<f64>().sqrt();
    if scatter <= 0.0 || scores.len() < 2 {
        return 1.0;
    }
    let t = scores.iter().sum::<f64>() / scatter;
    StudentsT::new(0.0, 1.0, (scores.len() - 1) as f64).map_or(1.0, |student| student.sf(t))
}
