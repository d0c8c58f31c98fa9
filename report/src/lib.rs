//! Reports that open anywhere: one HTML file with text, key numbers, tables and interactive plots,
//! and nothing outside it.
//!
//! The crate knows no physics. It takes words, numbers with units and series of samples, and writes
//! a page that works from a memory stick: no network, no fonts, no time stamps, the same bytes for
//! the same input. Text and tables read without a script; plots zoom, show values under the pointer
//! and switch lines off by their legend, drawn by the plotly.js that is embedded in the file. The
//! page's own security policy forbids every request, so that offline is a property and no habit.
//!
//! ```
//! use report::{Plot, Report, Section, Table, Tile};
//!
//! let time_s: Vec<f64> = (0..2000).map(|k| f64::from(k) * 1e-3).collect();
//! let force_kn: Vec<f64> = time_s.iter().map(|t| 18.0 * (t * 9.0).cos()).collect();
//!
//! let report = Report::new("Damper on the bench")
//!     .subtitle("2 s at 160 km/h")
//!     .fact("scenario", "ss9-160kmh.toml")
//!     .section(
//!         Section::new("Forces")
//!             .text("The front left damper is the one on the rig.")
//!             .tiles([
//!                 Tile::number("largest force", 18.0, "kN"),
//!                 Tile::text("state", "ok").good(),
//!             ])
//!             .plot(
//!                 Plot::new("Yaw damper force")
//!                     .x("time", "s")
//!                     .y("force", "kN")
//!                     .line("front left", &time_s, &force_kn)
//!                     .limit("relief", 18.0)
//!                     .zoom("one reversal", 0.3..=0.5),
//!             )
//!             .table(
//!                 Table::new("Dampers")
//!                     .text("damper")
//!                     .number("force, rms", "kN")
//!                     .row(["front left".into(), 12.73.into()]),
//!             ),
//!     );
//!
//! let html = report.to_html()?;
//! assert!(html.contains("<td class=\"n\">12.73</td>"));
//! # Ok::<(), report::Error>(())
//! ```
//!
//! Limits: a trace of more than [`MAX_DRAWN`] points is thinned before it is written (its peaks are
//! kept, and the page says so), and values are rounded to six digits of what is drawn. A report is
//! for eyes; the numbers themselves belong in a file of their own.

mod axis;
#[cfg(feature = "browser-test")]
pub mod browser;
mod document;
mod error;
mod figure;
mod html;
mod marks;
mod number;
mod page;
mod plot;
mod series;
mod simplify;
mod small_print;
mod style;
mod table;
mod thin;
mod tile;

pub use document::{Report, Section};
pub use error::Error;
pub use number::significant;
pub use plot::Plot;
pub use series::{Samples, equal_bins, logarithmic_bins, logarithmic_bins_of_counts};
pub use style::PALETTE;
pub use table::{Cell, Table};
pub use thin::MAX_DRAWN;
pub use tile::Tile;
