//! Where the time of a cycle goes at 1, 2 and 4 kHz: the table of `yawbench rtcheck --stages`, from
//! the same measurement. One cycle behind the other, and with `--seconds N` on the clock too.

use hil_host::BenchError;
use hil_host::bus::BusChoice;
use hil_host::realtime::RealtimeOptions;
use hil_host::rtcheck::{BudgetOptions, budget};
use scenario::run::{Overrides, Rate, Run};
use std::path::Path;

fn main() -> Result<(), BenchError> {
    let words: Vec<String> = std::env::args().collect();
    let seconds = words.iter().skip_while(|word| *word != "--seconds").nth(1);
    let seconds = seconds.and_then(|word| word.parse().ok()).unwrap_or(0.0_f64).max(0.0);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    let load = |rate: Rate, seconds: f64| {
        let (duration_s, rate) = (Some(seconds), Some(rate));
        let overrides = Overrides { duration_s, rate, ..Overrides::default() };
        Ok::<_, BenchError>(Run::load(&path, overrides)?)
    };
    let options = BudgetOptions {
        seconds,
        hot_cycles: 40_000,
        realtime: if seconds > 0.0 { RealtimeOptions::default() } else { RealtimeOptions::NONE },
        bus: BusChoice::Memory,
    };
    println!("{}", budget(load, &options)?.lines().join("\n"));
    Ok(())
}
