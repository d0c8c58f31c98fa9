//! Where the linker finds the memory map.

fn main() {
    println!("cargo::rerun-if-changed=memory.x");
    println!("cargo::rustc-link-search={}", env!("CARGO_MANIFEST_DIR"));
    println!("cargo::rustc-link-arg-bins=-Tlink.x");
    // The start is rounded up to pages otherwise, which flash has none of.
    println!("cargo::rustc-link-arg-bins=--nmagic");
}
