//! What was computed last, for whoever asks for the same.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

/// Answers that are kept, the newest first.
const KEPT: usize = 8;

/// Answers by what they were computed from.
pub(crate) struct Known<K, V>(Mutex<VecDeque<(K, V)>>);

impl<K: PartialEq, V: Clone> Known<K, V> {
    /// Nothing yet.
    pub(crate) const fn nothing() -> Self {
        Self(Mutex::new(VecDeque::new()))
    }

    /// The answer for a key, computed where it is not known.
    ///
    /// # Errors
    /// Those of `compute`; they are not kept.
    pub(crate) fn answer<E>(
        &self,
        key: K,
        compute: impl FnOnce(&K) -> Result<V, E>,
    ) -> Result<V, E> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known =
            kept().iter().find(|(known, _)| *known == key).map(|(_, answer)| answer.clone());
        if let Some(answer) = known {
            return Ok(answer);
        }
        // Another thread may compute the same meanwhile; neither waits for the other.
        let answer = compute(&key)?;
        let mut kept = kept();
        kept.truncate(KEPT - 1);
        kept.push_front((key, answer.clone()));
        Ok(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_computed_once_and_an_error_again() {
        let known: Known<u32, u32> = Known::nothing();
        let mut computed = 0;
        let mut ask = |key: u32| {
            known.answer(key, |key| {
                computed += 1;
                if *key == 0 { Err("none") } else { Ok(10 * key) }
            })
        };
        assert_eq!([ask(3), ask(3), ask(0), ask(0)], [Ok(30), Ok(30), Err("none"), Err("none")]);
        assert_eq!(computed, 3);
    }
}
