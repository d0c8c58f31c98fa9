//! Measured displacement without its noise: what drives a model.
//!
//! A stiff damper turns a micrometre of sensor noise into tens of newtons, in the model and not in
//! the damper. That is more than an error: an effect that follows the noise (a mass times its
//! acceleration) can cancel some of it and then predicts better than the true model without it.
//!
//! ```text
//! minimise  |x - s|^2 + lambda |third differences of s|^2        (Whittaker 1923)
//! lambda    minimises  r(lambda) / (1 - tr(lambda) / n)^2
//! ```
//!
//! (generalised cross-validation, Craven and Wahba 1979) with r the median over blocks of 64
//! samples of the mean square of x - s, so that a few corners decide nothing. Where x - s is
//! locally larger than noise (the corner of a triangle, an impact) s changes over to x itself:
//! nothing that rises above the noise is smoothed away. The trace is that of the circulant matrix,
//! exact except at the ends.
//!
//! Limits: close to the ends, where the motion has no other side, s mostly is x; motion weaker than
//! the noise in its band is lost with it; noise that was smoothed before, or is slower than the
//! motion, is taken for motion and stays.

/// Strengths tried, from the weakest by factors.
const WEAKEST: f64 = 1e-2;
const FACTOR: f64 = 3.0;
/// Beyond it double precision no longer solves the equations well.
const STRONGEST: f64 = 1e10;
/// Samples of a block.
const BLOCK: usize = 64;
/// Samples to either side that make a local mean square.
const HALF_WINDOW: usize = 12;
/// Local mean square over the median one from which it is no noise, and at which nothing is
/// smoothed.
const NO_NOISE: [f64; 2] = [3.0, 8.0];
/// Shorter records are left as they are.
const FEWEST: usize = 2 * BLOCK;

/// A displacement without its noise, m; as long as the input.
///
/// ```
/// use measurement::smoothing::smoothed;
/// // A slow sine of 3 mm that rattles by 1 um from sample to sample.
/// let sine = |n: usize| 3e-3 * libm::sin(0.02 * n as f64);
/// let rattle = |n: usize| if n % 2 == 0 { 1e-6 } else { -1e-6 };
/// let rattling: Vec<f64> = (0..2000).map(|n| sine(n) + rattle(n)).collect();
/// let smooth = smoothed(&rattling);
/// assert!((500..1500).all(|n| (smooth[n] - sine(n)).abs() < 0.5e-6));
/// ```
pub fn smoothed(displacement_m: &[f64]) -> Vec<f64> {
    let count = displacement_m.len();
    if count < FEWEST {
        return displacement_m.to_vec();
    }
    let powers: Vec<f64> = (0..count)
        .map(|k| {
            let half = 0.5 * std::f64::consts::PI * k as f64 / count as f64;
            libm::pow(2.0 * libm::sin(half), 6.0)
        })
        .collect();
    let mut best: Option<(f64, Vec<f64>)> = None;
    let mut strength = WEAKEST;
    while strength <= STRONGEST {
        let kept = powers.iter().map(|power| 1.0 / (1.0 + strength * power)).sum::<f64>();
        let smooth = penalised(displacement_m, strength);
        let square = typical_square(displacement_m, &smooth);
        let free = 1.0 - kept / count as f64;
        let score = square / (free * free);
        if best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, smooth));
        }
        strength *= FACTOR;
    }
    match best {
        Some((_, smooth)) => with_corners(displacement_m, smooth),
        None => displacement_m.to_vec(),
    }
}

/// Solves (1 + strength D' D) s = x with D the third differences, by factorising a matrix with
/// three diagonals to either side of the main one.
fn penalised(x: &[f64], strength: f64) -> Vec<f64> {
    const D: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
    let count = x.len();
    // Diagonal and the three below it.
    let mut rows = vec![[1.0, 0.0, 0.0, 0.0]; count];
    for first in 0..count - 3 {
        for i in 0..4 {
            for j in 0..=i {
                rows[first + i][i - j] += strength * D[i] * D[j];
            }
        }
    }
    // L diag L', in place: the diagonal, then the entries to the left of it.
    let mut smooth = x.to_vec();
    for i in 0..count {
        let reach = i.min(3);
        for back in (1..=reach).rev() {
            let j = i - back;
            let mut value = rows[i][back];
            for further in back + 1..=reach {
                let k = i - further;
                value -= rows[i][further] * rows[k][0] * rows[j][j - k];
            }
            rows[i][back] = value / rows[j][0];
        }
        for back in 1..=reach {
            let left = rows[i][back];
            rows[i][0] -= left * left * rows[i - back][0];
            smooth[i] -= left * smooth[i - back];
        }
    }
    for i in (0..count).rev() {
        smooth[i] /= rows[i][0];
        for ahead in 1..=(count - 1 - i).min(3) {
            smooth[i] -= rows[i + ahead][ahead] * smooth[i + ahead];
        }
    }
    smooth
}

/// Median over blocks of the mean square that smoothing removes.
fn typical_square(x: &[f64], smooth: &[f64]) -> f64 {
    let blocks = x.chunks_exact(BLOCK).zip(smooth.chunks_exact(BLOCK));
    let squares = blocks
        .map(|(x, s)| x.iter().zip(s).map(|(x, s)| (x - s) * (x - s)).sum::<f64>() / BLOCK as f64);
    median(squares.collect())
}

/// Changes over to the measured displacement where it differs by more than noise.
fn with_corners(x: &[f64], mut smooth: Vec<f64>) -> Vec<f64> {
    let squares: Vec<f64> = x.iter().zip(&smooth).map(|(x, s)| (x - s) * (x - s)).collect();
    let local: Vec<f64> = (0..squares.len())
        .map(|i| {
            let window =
                &squares[i.saturating_sub(HALF_WINDOW)..(i + HALF_WINDOW + 1).min(squares.len())];
            window.iter().sum::<f64>() / window.len() as f64
        })
        .collect();
    let typical = median(local.clone());
    let [noise, none] = NO_NOISE;
    for (i, square) in local.iter().enumerate() {
        let beyond = square - noise * typical;
        if beyond > 0.0 {
            let share = (beyond / ((none - noise) * typical)).min(1.0);
            smooth[i] += share * (x[i] - smooth[i]);
        }
    }
    smooth
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};
    use signal::statistics::rms;
    use std::f64::consts::TAU;

    const RATE_HZ: f64 = 1000.0;
    const SEED: u64 = 1923;

    /// White noise of 1 um.
    fn noise(count: usize) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let mut normal = || {
            let sum: f64 = (0..12).map(|_| f64::from(random.next_u32()) / 4_294_967_296.0).sum();
            1e-6 * (sum - 6.0)
        };
        (0..count).map(|_| normal()).collect()
    }

    /// Noise before and after, um.
    fn left(motion: impl Fn(f64) -> f64) -> Vec<f64> {
        let truth: Vec<f64> = (0..8000).map(|n| motion(f64::from(n) / RATE_HZ)).collect();
        let measured: Vec<f64> = truth.iter().zip(noise(8000)).map(|(x, n)| x + n).collect();
        smoothed(&measured).iter().zip(&truth).map(|(s, x)| 1e6 * (s - x)).collect()
    }

    #[test]
    fn solves_its_equations() {
        let x: Vec<f64> = (0..40).map(|n| libm::sin(f64::from(n * n))).collect();
        let strength = 7.0;
        let s = penalised(&x, strength);
        let third = |n: usize| s[n + 3] - 3.0 * s[n + 2] + 3.0 * s[n + 1] - s[n];
        for n in 0..40 {
            // Row n of D' D s.
            let weights = [(0, -1.0), (1, 3.0), (2, -3.0), (3, 1.0)];
            let curved: f64 = weights
                .iter()
                .filter(|(back, _)| n >= *back && n - back + 3 < 40)
                .map(|(back, weight)| weight * third(n - back))
                .sum();
            assert!((s[n] + strength * curved - x[n]).abs() < 1e-12);
        }
    }

    #[test]
    fn sines_and_random_motion_lose_their_noise() {
        for (amplitude, hz, most_um) in [(3.46e-3, 3.5, 0.3), (1e-3, 12.0, 0.4), (25e-3, 0.1, 0.2)]
        {
            let error = rms(&left(|t| amplitude * libm::sin(TAU * hz * t)));
            println!("{hz} Hz: {error:.3} um remain of 1");
            assert!(error < most_um, "{hz} Hz: {error}");
        }
        let service = |t: f64| {
            let tones = (1..24).map(|k| {
                let k = f64::from(k);
                libm::sin(TAU * 0.5 * k * t + k * k) / k
            });
            1e-3 * tones.sum::<f64>()
        };
        let error = rms(&left(service));
        assert!(error < 0.4, "{error}");
    }

    #[test]
    fn a_corner_stays_a_corner() {
        // A sharp triangle of 20 mm/s, turning at every whole second.
        let triangle = |t: f64| 20e-3 * (1.0 - (t - 2.0 * libm::floor(0.5 * t) - 1.0).abs());
        let error = left(triangle);
        let largest = error.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
        println!("triangle: rms {:.3}, largest {largest:.2} um", rms(&error));
        assert!(rms(&error) < 0.6 && largest < 6.0);
    }

    #[test]
    fn what_has_no_noise_stays_as_it_is() {
        let motion: Vec<f64> = (0..4000).map(|n| 3e-3 * libm::sin(0.02 * f64::from(n))).collect();
        let smooth = smoothed(&motion);
        let moved = motion.iter().zip(&smooth).map(|(x, s)| (x - s).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-8, "{moved}");
        // Nor is a hold with its digits.
        let hold: Vec<f64> =
            (0..4000).map(|n| if n < 500 { 1e-6 * f64::from(n) } else { 5e-4 }).collect();
        let smooth = smoothed(&hold);
        let moved = hold.iter().zip(&smooth).map(|(x, s)| (x - s).abs()).fold(0.0, f64::max);
        assert!(moved < 2e-6, "{moved}");
    }

    #[test]
    fn a_hum_above_the_noise_stays() {
        let error = left(|t| 3e-3 * libm::sin(TAU * 2.0 * t) + 4e-6 * libm::sin(TAU * 100.0 * t));
        assert!(rms(&error) < 0.9, "{}", rms(&error));
    }
}
