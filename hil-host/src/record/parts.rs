//! The parts of a record: a long run begins new files every hour.
//!
//! `record.npy`, `record.part02.npy`, `record.part03.npy` and so on, and `bus.log`,
//! `bus.part02.log`. A listing shows them in this order in every locale: `n` and `l` come before
//! `p`. Parts begin with a cycle, not with a time: the same run has the same parts at any pace.

use files::{InputError, Limit, input};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// Control cycles in a part: an hour at 1 kHz, a quarter of one at 4 kHz.
pub(crate) const PART_CYCLES: u64 = 3_600_000;

/// The part of a cycle, from one, where a part has so many cycles.
pub(crate) fn part_of(cycle: u64, part_cycles: u64) -> u64 {
    cycle.saturating_sub(1) / part_cycles.max(1) + 1
}

/// Items in runs of one part each, with its number, where a part has so many cycles.
pub(crate) fn by_part<T>(
    items: &[T],
    part_cycles: u64,
    cycle: impl Fn(&T) -> u64 + Copy,
) -> impl Iterator<Item = (u64, &[T])> {
    let part = move |item: &T| part_of(cycle(item), part_cycles);
    let runs = items.chunk_by(move |one, next| part(one) == part(next));
    runs.filter_map(move |run| Some((part(run.first()?), run)))
}

/// The name of a part, from one, of the file `first`.
pub(crate) fn part_name(first: &str, number: u64) -> String {
    match first.rsplit_once('.') {
        _ if number <= 1 => first.to_owned(),
        Some((stem, ending)) => format!("{stem}.part{number:02}.{ending}"),
        None => format!("{first}.part{number:02}"),
    }
}

/// The parts of a record or log that are there, in order; the first in any case.
pub(crate) fn parts(first: &Path) -> Vec<PathBuf> {
    let mut found = vec![first.to_owned()];
    let Some(name) = first.file_name().and_then(|name| name.to_str()) else { return found };
    for number in 2.. {
        let part = first.with_file_name(part_name(name, number));
        if !part.is_file() {
            break;
        }
        found.push(part);
    }
    found
}

/// Opens all parts of a record or log, with their paths. Everything that reads the files of a run
/// begins here.
///
/// # Errors
/// One of them cannot be opened.
pub(crate) fn open_parts(first: &Path) -> Result<Vec<(PathBuf, File)>, InputError> {
    let open = |path: PathBuf| input::open(&path, Limit::Stream).map(|file| (path, file));
    parts(first).into_iter().map(open).collect()
}

/// What writes the part of a record that is written now.
pub(crate) struct InParts<'a, W> {
    writer: W,
    number: u64,
    /// Opens the file of a part and begins it.
    begin: Box<dyn FnMut(u64) -> io::Result<W> + Send + 'a>,
}

impl<'a, W> InParts<'a, W> {
    /// Begins with the first part.
    ///
    /// # Errors
    /// It cannot be begun.
    pub(crate) fn new(mut begin: impl FnMut(u64) -> io::Result<W> + Send + 'a) -> io::Result<Self> {
        Ok(Self { writer: begin(1)?, number: 1, begin: Box::new(begin) })
    }

    /// What writes this part. Parts are in order: an earlier one is not written again.
    ///
    /// # Errors
    /// It cannot be begun; the next call tries again.
    pub(crate) fn part(&mut self, number: u64) -> io::Result<&mut W> {
        debug_assert!(number >= self.number, "part {number} after {}", self.number);
        while self.number < number {
            self.writer = (self.begin)(self.number + 1)?;
            self.number += 1;
        }
        Ok(&mut self.writer)
    }

    /// What writes the last part.
    pub(crate) fn into_last(self) -> W {
        self.writer
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_sort_behind_the_first_and_have_an_hour_of_cycles_each() {
        assert_eq!(part_name("record.npy", 1), "record.npy");
        let names = [1, 2, 3, 10, 25].map(|number| part_name("record.npy", number));
        assert!(names.is_sorted(), "{names:?}");
        assert_eq!(part_name("bus.log", 2), "bus.part02.log");
        assert_eq!([1, 3_600_000, 3_600_001].map(|c| part_of(c, PART_CYCLES)), [1, 1, 2]);
        let runs = by_part(&[9, 10, 11, 25], 10, |cycle| *cycle);
        assert!(runs.eq([(1, &[9, 10][..]), (2, &[11]), (3, &[25])]));
    }

    #[test]
    fn a_part_that_cannot_be_begun_is_tried_again() {
        let mut refused = 0;
        let mut parts = InParts::new(|number| {
            if number == 3 && refused < 2 {
                refused += 1;
                return Err(io::ErrorKind::StorageFull.into());
            }
            Ok(number)
        })
        .unwrap();
        assert_eq!(parts.part(2).copied().unwrap(), 2);
        assert!(parts.part(3).is_err() && parts.part(3).is_err());
        assert_eq!(parts.part(4).copied().unwrap(), 4);
        assert_eq!(parts.into_last(), 4);
    }
}
