//! The proof of `identify`: blinded records from known dampers, and how often it is right.
//!
//! ```text
//! (seed, index) -> case -> specimen, sensors, records -> identify -> one line -> merged table
//! ```
//!
//! | file | what |
//! | --- | --- |
//! | `plan` | which kinds of cases there are and in which order they come |
//! | `case` | a case: damper, sensors and truth, drawn from seed and index |
//! | `strength` | one number for each effect, from vanishing to strong |
//! | `size` | the strength at which an effect has the wanted size |
//! | `specimen` | what is mounted in the bench |
//! | `score` | one case run and scored: one line |
//! | `shard` | many cases, in shards that can be stopped |
//! | `table`, `page` | the merged table, as numbers and as text |
//! | `wilson` | intervals of rates |
//!
//! Who knows what: `identify` gets records, and in some cases a datasheet that is wrong; nothing
//! else.
//!
//! **The weak spot.** Effects of the catalogue come from the damper of the core, at steps of 100 µs
//! instead of 1 ms, and the same core fits them: what its laws share with nature is not tested by
//! that. Cases in which nothing is missing and those outside the catalogue come from an integration
//! of its own ([`virtual_bench::series_model`]), and the full hydraulic damper
//! ([`virtual_bench::hydraulic`]) has effects that are not written into the model. Rates for
//! effects of the catalogue are thus upper bounds of what real records will give.

mod case;
mod page;
mod plan;
mod score;
mod shard;
mod size;
mod specimen;
mod strength;
mod table;
mod wilson;

pub use page::text;
pub use score::{CaseErrors, CaseResult, Interval, Named};
pub use shard::Campaign;
pub use table::{Aim, Medians, Row, Table, is_right};
pub use wilson::Rate;
