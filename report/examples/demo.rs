//! Writes a report with every element in it, from made-up data that look like a damper's.
//!
//! `cargo run -p report --example demo [FILE.html]`

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "demo-report.html".to_owned());
    demo_report::demo().write_to(&path)?;
    println!("{path}");
    Ok(())
}

#[path = "../tests/report/demo_report.rs"]
mod demo_report;
