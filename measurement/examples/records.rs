//! Prints what the importer makes of records: `cargo run --example records -- MAPPING FILE...`,
//! with `-` for this project's own columns.

use measurement::{noise, read_tests};

fn main() -> std::process::ExitCode {
    let mut arguments = std::env::args_os().skip(1).map(std::path::PathBuf::from);
    let mapping = arguments.next().filter(|path| path.as_os_str() != "-");
    let files: Vec<_> = arguments.collect();
    match read_tests(&files, mapping.as_deref()) {
        Ok(tests) => {
            for test in &tests {
                let floor = noise::noise(test).map_or("noise unknown".to_owned(), |noise| {
                    format!("noise {:.2} N ({})", noise.rms_n, noise.source.name())
                });
                println!(
                    "{}: {:.1} Hz, {:.2} s, +-{:.3} mm, {} cycles at {:.3} Hz, run-in {:.2} s, {floor}, direction {}",
                    test.name,
                    test.rate_hz(),
                    test.len() as f64 * test.step_s,
                    test.amplitude_m() * 1e3,
                    test.cycles.len().saturating_sub(1),
                    test.frequency_hz().unwrap_or(0.0),
                    test.run_in as f64 * test.step_s,
                    if test.direction_declared { "declared" } else { "not declared" },
                );
                for repair in &test.repairs {
                    println!("    {repair}");
                }
            }
            std::process::ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            std::process::ExitCode::from(2)
        }
    }
}
