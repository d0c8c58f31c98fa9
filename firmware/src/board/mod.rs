//! What touches hardware: time, memory, the console of an emulated board.

pub mod console;
pub mod stack;
pub mod stopwatch;
pub mod timer;
pub mod uart;
