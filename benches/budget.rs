//! Where the time of a cycle goes at 1, 2 and 4 kHz, one cycle behind the other: the table of
//! `yawbench rtcheck --stages` without the clock, from the same measurement.

use hil_host::BenchError;
use hil_host::bus::BusChoice;
use hil_host::realtime::RealtimeOptions;
use hil_host::rtcheck::{BudgetOptions, budget};
use scenario::run::{Overrides, Rate, Run};
use std::path::Path;

fn main() -> Result<(), BenchError> {
    let load = |rate: Rate, seconds: f64| {
        let (duration_s, rate) = (Some(seconds), Some(rate));
        let overrides = Overrides { duration_s, rate, ..Overrides::default() };
        Ok::<_, BenchError>(Run::load(Path::new("scenarios/ss9-160kmh.toml"), overrides)?)
    };
    let options = BudgetOptions {
        seconds: 0.0,
        hot_cycles: 40_000,
        realtime: RealtimeOptions::NONE,
        bus: BusChoice::Memory,
    };
    println!("{}", budget(load, &options)?.lines().join("\n"));
    Ok(())
}
