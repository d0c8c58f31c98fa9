//! Fuzzes the target `own_messages`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| assert!(fuzz::run("own_messages", bytes)));
