//! Correlation by rank: it knows the order of values and not their size.

/// Ranks less their mean, over their standard deviation.
pub(crate) fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    let count = values.len() as f64;
    let spread = ((count * count - 1.0) / 12.0).sqrt().max(f64::MIN_POSITIVE);
    for (rank, index) in order.into_iter().enumerate() {
        ranks[index] = (rank as f64 - 0.5 * (count - 1.0)) / spread;
    }
    ranks
}

/// Correlation of ranks with others that are shifted in a circle.
pub(crate) fn correlation(a: &[f64], b: &[f64], shift: usize) -> f64 {
    let pairs = a.iter().zip(b.iter().cycle().skip(shift));
    pairs.map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_have_unit_variance_and_correlate_with_themselves() {
        let values = [3.0, -1.0, 10.0, 2.5, 7.0];
        let ranks = ranks(&values);
        assert!((correlation(&ranks, &ranks, 0) - 1.0).abs() < 1e-12);
        assert!(correlation(&ranks, &ranks, 1) < 0.0);
    }
}
