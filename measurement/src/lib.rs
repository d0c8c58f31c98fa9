//! Measured records of a damper on a bench, prepared for a model: one uniform clock, velocity and
//! acceleration in addition to the displacement, cycles marked.
//!
//! The walk of a record, in the order in which to read the files:
//!
//! ```text
//! read            files to tests, one line per step; the mapping next to a file (companion)
//!   text          bytes to text, whatever the encoding
//!   commas        commas that are decimal marks and separators at once
//!   question      the layout of a file without a mapping, or what the file leaves open
//!     recognition     what a text shows about its layout (heading, header, labview)
//!     proposal        the same as a mapping
//!   table         text to rows of cells that know their lines (lines, fault)
//!   columns       cells to SI values: a Series per test (mapping, layout, unit, number, stamp)
//!     suspicion       units that the sizes speak against
//!   prepare       a Series to a Measurement, one line per step
//!     plausibility    size, motion, length
//!     force_faults    clipped, frozen, spikes
//!     clock           time stamps to a uniform clock
//!     integral        the displacement where only the velocity was recorded
//!     cycles          whole cycles and the run-in
//!     sign            whether displacement and force agree
//!     smoothing       the displacement without its noise
//!     interpolant     velocity and acceleration
//! body_record     force in, motion out: a body on a damper (drive)
//! noise           what no model can explain
//! ```
//!
//! What is wrong is one line with file, row, column, found and expected ([`MeasurementError`]);
//! what was repaired is a line in [`Measurement::repairs`]. Nothing is silently dropped.
//!
//! Layers: above `files`, `scenario` and `signal`; below the virtual bench, the identification and
//! the hardware bench, which all produce or use a [`Series`] or a [`Measurement`].

pub mod body_record;
mod clock;
mod columns;
mod commas;
mod companion;
mod cycles;
mod drive;
mod error;
mod fault;
mod force_faults;
mod header;
mod heading;
mod integral;
pub mod interpolant;
mod labview;
mod layout;
mod lines;
pub mod mapping;
mod measurement;
pub mod noise;
mod number;
mod plausibility;
mod prepare;
mod proposal;
mod question;
mod read;
mod reader;
mod recognition;
mod series;
mod sign;
pub mod smoothing;
mod stamp;
mod suspicion;
mod table;
#[cfg(test)]
mod tests;
mod text;
mod unit;

pub use error::MeasurementError;
pub use force_faults::is_flat_but_for_rounding;
pub use measurement::Measurement;
pub use plausibility::SAMPLES_LEAST;
pub use proposal::propose_mapping;
pub use read::{read_motions, read_tests, read_tests_with};
pub use reader::RecordReader;
pub use series::Series;
