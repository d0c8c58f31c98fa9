//! Print `yawbench.dbc`: `cargo run -p can-protocol --example dbc > can-protocol/yawbench.dbc`.
#[path = "../tests/bus/support/dbc_text.rs"]
mod dbc_text;
#[path = "../tests/bus/support/rules.rs"]
mod rules;

fn main() {
    print!("{}", dbc_text::dbc_text());
}
