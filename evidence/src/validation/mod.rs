//! Our results compared with known numbers: published numbers, closed forms, and numbers computed
//! independently.
//!
//! One file per reference. Each computes its numbers when it is asked, compares them with the known
//! ones as [`Check`]s with tolerances that its [`Reference`] derives, and says what is left out.
//! Nothing here is tuned to pass; the same functions are the tests (`tests/validation.rs`) and the
//! page of `yawbench reproduce --validation` ([`page()`]).
//!
//! | file | known from |
//! | --- | --- |
//! | `conicity`, `kalker`, `fastsim`, `manchester_contact` | benchmarks and tables of the field |
//! | `cooperrider` | a published stability limit, and equations written out apart from the vehicle code |
//! | `irregularity` | the spectra of the SS9 study |
//! | `ride` | the formula of the index, published weighting factors |
//! | `coach` | springs and masses by hand |
//! | `energy`, `symmetry` | laws that every model must obey |

mod check;
mod coach;
mod conicity;
mod cooperrider;
mod energy;
mod fastsim;
mod irregularity;
mod kaas_petersen;
mod kalker;
mod locomotive;
mod manchester_contact;
mod page;
mod ride;
mod steps;
mod symmetry;
mod text;
mod vehicles;

pub use check::{Check, Reference};
pub use page::page;
pub use text::{misses, text};

use crate::error::EvidenceError;
use files::Identity;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Hash over the sources of the crates that compute the references, made by the build script.
const PROGRAM: &str = env!("VALIDATION_SOURCES");

/// Computes one reference, or fails with [`EvidenceError::Stopped`] once the flag is set.
pub type Compute = fn(&AtomicBool) -> Result<Reference, EvidenceError>;

/// Every reference, in the order of the page.
pub const REFERENCES: [Compute; 10] = [
    conicity::reference,
    kalker::reference,
    fastsim::reference,
    manchester_contact::reference,
    cooperrider::reference,
    irregularity::reference,
    ride::reference,
    coach::reference,
    energy::reference,
    symmetry::reference,
];

/// Computes all of them in parallel. `progress` gets the title of each when it is done, the number
/// done and the number of all. Once `stop` is set, those that are done are all.
///
/// # Errors
/// A reference that cannot be computed.
pub fn all(
    stop: &AtomicBool,
    progress: &(dyn Fn(&str, usize, usize) + Sync),
) -> Result<Vec<Reference>, EvidenceError> {
    let done = AtomicUsize::new(0);
    let one = |compute: &Compute| -> Option<Result<Reference, EvidenceError>> {
        let computed = EvidenceError::check(stop).and_then(|()| compute(stop));
        match &computed {
            Err(EvidenceError::Stopped) => return None,
            Err(_) => {}
            Ok(reference) => {
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress(reference.title, done, REFERENCES.len());
            }
        }
        Some(computed)
    };
    REFERENCES.par_iter().filter_map(one).collect()
}

/// The identity of all of them: they depend on the program alone.
///
/// # Errors
/// None: the question always serialises.
pub fn identity() -> Result<Identity, EvidenceError> {
    Identity::new(&"validation", BTreeMap::new(), PROGRAM)
        .map_err(|why| EvidenceError::NotSerialised(why.to_string()))
}

/// The columns of a table in CSV, by the words of its head.
fn columns<const N: usize>(
    text: &str,
    heads: [&'static str; N],
) -> Result<[Vec<f64>; N], EvidenceError> {
    let unreadable = |why: csv::Error| EvidenceError::Table(why.to_string());
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let found = reader.headers().map_err(unreadable)?.clone();
    let mut places = [0; N];
    for (place, head) in places.iter_mut().zip(heads) {
        let at = found.iter().position(|name| name == head);
        *place = at.ok_or(EvidenceError::NoColumn(head))?;
    }
    let mut columns = [const { Vec::new() }; N];
    for record in reader.records() {
        let record = record.map_err(unreadable)?;
        for (column, place) in columns.iter_mut().zip(places) {
            column.push(record.get(place).unwrap_or_default().parse::<f64>()?);
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests;
