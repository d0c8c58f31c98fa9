//! The `yawbench` command.
fn main() {}
