//! Hashes the sources of the crates that compute the cases of the campaign, the references and the
//! figures of the study.

include!("../files/build/sources.rs");

fn main() {
    println!("cargo:rerun-if-changed=../files/build");
    let identify = [
        "../identification/src",
        "../measurement/src",
        "../virtual-bench/src",
        "../signal/src",
        "../scenario/src",
        "../firmware-core/src",
        "../scenarios/dampers",
    ];
    export_hash("CAMPAIGN_SOURCES", &[&["src/campaign"][..], &identify].concat());
    let validation = ["src/validation", "../vehicle-studies/src", "../scenarios/vehicles"];
    export_hash("VALIDATION_SOURCES", &[&validation[..], &identify].concat());
    let figures = ["src/reproduce", "../vehicle-studies/src"];
    export_hash("REPRODUCE_SOURCES", &[&figures[..], &identify].concat());
}
