//! A visit to a simulated damper bench: from a specimen and a list of tests to the records that a
//! laboratory would hand over.
//!
//! ```text
//! protocol -> excitation x(t) -> specimen F(t), fine steps -> sensors -> RawRecord -> CSV
//! ```
//!
//! A [`Specimen`] is a damper of the core with any effects ([`Modelled`]), a series damper with an
//! integration of its own and disturbances that no effect describes ([`NullGenerator`]), or the
//! full hydraulic damper. [`record()`] makes one test in memory, without files. Every random number
//! comes from the seed.
//!
//! ```
//! use virtual_bench::bench_visit::{self, protocol, sensors::Sensors};
//! use virtual_bench::series_model::{NullGenerator, SeriesModel};
//! let model = SeriesModel {
//!     ce_n_s_per_m: 1e6, ke_n_per_m: 12.5e6, clearance_2a_m: 1e-3,
//!     f_relief_n: 15e3, c2_n_s_per_m: 60e3,
//! };
//! let damper = NullGenerator { model, outside: Vec::new() };
//! let sensors = Sensors::of_range(50e3, 0.1);
//! let record = bench_visit::record(&damper, &protocol::short()[0], &sensors, 7);
//! let peak_n = record.force_n.iter().fold(0.0f64, |most, force| most.max(force.abs()));
//! assert!((peak_n - 18.45e3).abs() < 0.3e3);
//! ```

pub mod proposals;
pub mod protocol;
mod raw_record;
mod recording;
pub mod scaled;
pub mod sensors;
pub mod test_list;

pub use crate::modelled::Modelled;
pub use crate::series_model::NullGenerator;
pub use crate::specimen::Specimen;
pub use crate::{excitation, specimen};
pub use firmware_core::damper::HeatBalance;
pub use raw_record::RawRecord;
pub use recording::{LABORATORY_DEGC, measurements, record, record_from, visit, visit_until};
