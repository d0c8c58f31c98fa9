//! The last values of something, in the order in which they came.

/// The last `N` values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ring<T, const N: usize> {
    kept: [T; N],
    newest: usize,
}

impl<T: Copy + Default, const N: usize> Default for Ring<T, N> {
    fn default() -> Self {
        Self::filled(T::default())
    }
}

impl<T: Copy, const N: usize> Ring<T, N> {
    /// A ring in which one value has always been kept.
    pub(crate) const fn filled(value: T) -> Self {
        const { assert!(N > 0, "a ring of nothing") };
        Self { kept: [value; N], newest: 0 }
    }

    /// Keeps a value, and forgets the oldest.
    pub(crate) fn keep(&mut self, value: T) {
        self.newest = (self.newest + 1) % N;
        self.correct(value);
    }

    /// Replaces the newest value.
    pub(crate) fn correct(&mut self, value: T) {
        if let Some(newest) = self.kept.get_mut(self.newest) {
            *newest = value;
        }
    }

    /// The value that was kept so many values ago, 0 being the newest; none beyond the oldest.
    pub(crate) fn ago(&self, count: usize) -> Option<T> {
        if count >= N {
            return None;
        }
        self.kept.get((self.newest + N - count) % N).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_values_come_back_by_their_age() {
        let mut ring = Ring::<i32, 4>::filled(-1);
        for value in 0..6 {
            ring.keep(value);
            for age in 0..4 {
                let expected = (value - age).max(-1);
                assert_eq!(ring.ago(age as usize), Some(expected), "{value}, {age}");
            }
            assert_eq!(ring.ago(4), None);
        }
        ring.correct(50);
        assert_eq!([0, 1].map(|age| ring.ago(age)), [Some(50), Some(4)]);
    }
}
