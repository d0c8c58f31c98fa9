//! Prints the diagram of `docs/bench-states.md`: `cargo run -p firmware-core --example states`.
fn main() -> std::fmt::Result {
    let mut diagram = String::new();
    firmware_core::supervision::write_diagram(&mut diagram)?;
    print!("{diagram}");
    Ok(())
}
