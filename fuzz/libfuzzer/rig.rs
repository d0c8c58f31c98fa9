//! Fuzzes the target `rig`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| assert!(fuzz::run("rig", bytes)));
