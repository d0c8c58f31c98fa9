//! The `yawbench` command.

fn main() -> std::process::ExitCode {
    hil_host::cli::main()
}
