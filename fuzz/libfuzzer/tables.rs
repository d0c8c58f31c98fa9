//! Fuzzes the target `tables`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| assert!(fuzz::run("tables", bytes)));
