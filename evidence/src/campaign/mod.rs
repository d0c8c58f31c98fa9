//! The proof of `identify`: blinded records from known dampers, and how often it is right.
//!
//! ```text
//! (seed, index) -> case -> specimen, sensors, records -> identify -> one line -> merged table
//! ```
//!
//! | file | what |
//! | --- | --- |
//! | `design` | which motion meets which truth and which noise, how often and in which order |
//! | `motion`, `noise` | the three sets of tests of a case; its sensors |
//! | `case` | a case: damper, tests, sensors and truth, drawn from seed and index |
//! | `strength` | one number for each effect, from vanishing to strong |
//! | `size` | the strength at which an effect has the wanted size |
//! | `specimen` | what is mounted in the bench |
//! | `line` | the result of a case: one line |
//! | `score`, `next_test` | one case run and scored; rivals and one more test |
//! | `shard` | many cases, in shards that can be stopped |
//! | `verdict`, `aims`, `table`, `page` | what is right; the targets; the merged table, and its text |
//! | `wilson` | bounds of rates |
//!
//! Who knows what: `identify` gets the training tests and the hold-out, and in some cases a
//! datasheet that is wrong; nothing else. Errors count on a third set of tests.
//!
//! **The weak spot.** Effects of the catalogue come from the damper of the core, at steps of 100 µs
//! instead of 1 ms, and the same core fits them: what its laws share with nature is not tested by
//! that. Cases in which nothing is missing, neighbours, hidden inputs and disturbances outside the
//! catalogue come from integrations of their own ([`virtual_bench::series_model`]), and the full
//! hydraulic damper ([`virtual_bench::hydraulic`]) has effects that are not written into the model.
//! Rates for effects of the catalogue are thus upper bounds of what real records will give.

mod aims;
mod case;
mod design;
mod line;
mod motion;
mod next_test;
mod noise;
mod page;
mod score;
mod shard;
mod size;
mod specimen;
mod strength;
mod table;
mod verdict;
mod wilson;

pub use aims::Aim;
pub use line::{CaseErrors, CaseResult, Interval, Named, NextTestResult};
pub use page::{text, times};
pub use shard::Campaign;
pub use table::{Grid, Medians, Row, Table};
pub use verdict::is_right;
pub use wilson::Rate;
