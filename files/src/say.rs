//! Words on standard error.

/// Prints a line on standard error.
///
/// Where nobody takes it, a closed pipe or a full disk, nothing else is lost: `eprintln!` would end
/// the program there, and a bench with it.
#[macro_export]
macro_rules! say {
    ($($words:tt)*) => {{
        use std::io::Write as _;
        let _ = writeln!(std::io::stderr(), $($words)*);
    }};
}
