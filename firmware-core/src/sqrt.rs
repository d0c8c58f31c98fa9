//! The square root, from whatever has it in hardware.
//!
//! IEEE 754 rounds a square root correctly, so every way gives the same bits: the standard library
//! (feature `std`, every host build) compiles to one instruction that vectorises, feature
//! `cortex-m7` to `vsqrt.f64`, and `libm` does without both. The other functions stay `libm`'s,
//! which rounds them alike everywhere.

#[cfg(any(test, feature = "std"))]
extern crate std;

/// The square root; not a number below zero.
///
/// ```
/// use firmware_core::sqrt::sqrt;
/// assert_eq!(sqrt(2.0).to_bits(), 0x3ff6_a09e_667f_3bcd);
/// assert!(sqrt(-1.0).is_nan());
/// ```
#[inline(always)]
pub fn sqrt(value: f64) -> f64 {
    #[cfg(all(feature = "cortex-m7", target_arch = "arm"))]
    return vsqrt::sqrt(value);
    #[cfg(all(feature = "std", not(all(feature = "cortex-m7", target_arch = "arm"))))]
    return value.sqrt();
    #[cfg(not(any(feature = "std", all(feature = "cortex-m7", target_arch = "arm"))))]
    return libm::sqrt(value);
}

#[cfg(test)]
mod tests {
    use crate::fnv;

    /// Both compiled whichever features are on: `f64::sqrt` is the standard library's.
    #[test]
    fn the_standard_library_and_libm_give_the_same_bits() {
        let special = [0.0, -0.0, f64::MIN_POSITIVE, 5e-324, f64::MAX, f64::INFINITY, 1.0, 4.0];
        let mut bits = fnv::START;
        let random = core::iter::repeat_with(|| {
            bits = fnv::add(bits, 1);
            // A positive number of any size, subnormal ones and infinity among them.
            f64::from_bits((bits ^ (bits >> 29)) & 0x7fff_ffff_ffff_ffff)
        });
        let numbers = random.take(1_000_000).filter(|value| !value.is_nan());
        for value in special.into_iter().chain(numbers) {
            let (ours, theirs) = (libm::sqrt(value), value.sqrt());
            assert_eq!(ours.to_bits(), theirs.to_bits(), "{value:e}");
            assert_eq!(super::sqrt(value).to_bits(), theirs.to_bits(), "{value:e}");
        }
        assert!(super::sqrt(-1.0).is_nan() && super::sqrt(f64::NAN).is_nan());
    }
}
