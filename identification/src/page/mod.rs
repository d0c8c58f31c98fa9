//! `report.html`: an identification as an engineer reports it to another one.
//!
//! The verdict comes first. Then follow the record with the maker's model over it, the refitted
//! model, the residual over every coordinate, the candidates, each effect that was added, loops
//! before and after, errors test by test, what these records cannot show, and the remaining
//! residual, with an empirical map of it where one was asked for. A chapter is short where it has
//! no content: no datasheet, no tests held out, no effect found.
//!
//! Tables are in SI units, to be copied; axes have the prefix that reads best. All curves are
//! free-run simulation from the measured displacement; the residual is the measured less the
//! simulated force.

mod candidates;
mod coordinates;
mod curves;
mod effects;
mod empirical;
mod errors;
mod headline;
mod limits;
mod loops;
mod models;
mod prefix;
mod residual;
mod shown;
mod words;

use super::identify::Identification;
use report::Report;

/// The report of an identification.
pub fn page(identification: &Identification) -> Report {
    let tests = shown::all(identification);
    let worst = shown::worst(&tests);
    let mut report = Report::new(&words::title(&identification.result))
        .subtitle(&words::sentence(identification));
    for (name, value) in headline::facts(identification) {
        report = report.fact(name, &value);
    }
    report = report
        .section(headline::section(identification))
        .section(models::datasheet(identification, worst))
        .section(models::refitted(identification, worst))
        .section(coordinates::section(identification))
        .section(candidates::section(identification))
        .section(effects::section(identification, worst))
        .section(loops::section(identification, &tests))
        .section(errors::section(identification))
        .section(limits::section(identification))
        .section(residual::section(identification));
    if let Some(section) = empirical::section(identification) {
        report = report.section(section);
    }
    report.section(headline::about(identification))
}
