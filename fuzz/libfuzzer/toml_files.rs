//! Fuzzes the target `toml_files`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| assert!(fuzz::run("toml_files", bytes)));
