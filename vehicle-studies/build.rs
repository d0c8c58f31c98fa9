//! Hashes the sources of the crates that compute the answers of studies.

include!("../files/build/sources.rs");

fn main() {
    println!("cargo:rerun-if-changed=../files/build");
    export_hash(
        "VEHICLE_STUDIES_SOURCES",
        &["src", "../signal/src", "../rig-emulator/src", "../scenario/src", "../firmware-core/src"],
    );
}
