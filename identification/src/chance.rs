//! The probability that chance alone explains a set of scores.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Probability that scores of independent blocks, each with mean zero, have a mean as large as
/// observed: Student's test of one sample,
///
/// ```text
/// t = mean / (s / sqrt(n)), with n - 1 degrees of freedom
/// ```
///
/// The test assumes nothing about the size of the scores or about the inside of a block; where a
/// few blocks are much larger than the rest, it errs on the side of chance.
pub(crate) fn one_sided(scores: &[f64]) -> f64 {
    let count = scores.len() as f64;
    if scores.len() < 2 {
        return 1.0;
    }
    let mean = scores.iter().sum::<f64>() / count;
    let squares: f64 = scores.iter().map(|score| (score - mean) * (score - mean)).sum();
    if squares <= 0.0 {
        return if mean > 0.0 { 0.0 } else { 1.0 };
    }
    let t = mean / (squares / (count - 1.0) / count).sqrt();
    beyond(t, count - 1.0)
}

/// Probability that Student's t exceeds a value; 1 without a degree of freedom.
pub(crate) fn beyond(t: f64, freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom).map_or(1.0, |student| student.sf(t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_by_hand() {
        // Mean 2, s = 1 of four: t = 4, three degrees of freedom.
        let half = 0.75_f64.sqrt();
        let p = one_sided(&[2.0 - half, 2.0 + half, 2.0 - half, 2.0 + half]);
        assert!((p - 0.014).abs() < 1e-3);
        assert!((one_sided(&[1.0, -1.0]) - 0.5).abs() < 1e-12);
    }
}
