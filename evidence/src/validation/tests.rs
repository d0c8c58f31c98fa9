//! Every reference is met; one test each.

use super::*;

/// A flag that is not set.
static GO: AtomicBool = AtomicBool::new(false);

/// Prints what is tightest, and fails naming what misses.
fn assert_met(compute: Compute) -> Reference {
    let reference = compute(&GO).unwrap();
    for (check, count) in reference.tightest() {
        println!(
            "{} x{count}: {} expected {:.6e} ours {:.6e}, {:.0} % of the tolerance",
            check.quantity,
            check.at,
            check.expected,
            check.ours,
            100.0 * check.used()
        );
    }
    for limit in &reference.limits {
        println!("limit: {limit}");
    }
    let misses: Vec<&Check> = reference.misses().collect();
    assert!(reference.passes(), "{}: {misses:#?}", reference.name);
    reference
}

#[test]
fn equivalent_conicity_lies_within_the_bounds_of_uic_519() {
    let reference = assert_met(conicity::reference);
    let rows = |case: &str| {
        let quantity = format!("equivalent conicity, case {case}");
        reference.checks.iter().filter(|check| check.quantity == quantity).count()
    };
    // All 66 rows but those whose amplitudes lie beyond the tables.
    assert_eq!(["E1", "E2", "E3", "E4", "E5", "E6", "E7"].map(rows), [59, 59, 59, 62, 45, 47, 42]);
}

#[test]
fn kalkers_table_and_asymptotes_are_met_exactly() {
    assert_met(kalker::reference);
}

#[test]
fn fastsim_matches_its_closed_form_and_that_of_contact() {
    assert_met(fastsim::reference);
}

#[test]
fn the_manchester_contact_benchmark_is_met() {
    assert_met(manchester_contact::reference);
}

#[test]
fn cooperriders_bogie_meets_its_numbers() {
    assert_met(cooperrider::reference);
}

#[test]
fn generated_track_has_the_spectra_of_the_study() {
    assert_met(irregularity::reference);
}

#[test]
fn the_coach_matches_equilibrium_and_frequencies_by_hand() {
    assert_met(coach::reference);
}

#[test]
fn energy_is_conserved_or_dissipated_by_dampers() {
    assert_met(energy::reference);
}

#[test]
fn a_mirrored_run_is_the_mirror_image() {
    assert_met(symmetry::reference);
}

#[test]
fn a_miss_is_named_in_table_and_page() {
    let mut reference = symmetry::reference(&GO).unwrap();
    reference.checks.push(Check::near("length", "in the middle", [2.0, 2.5], 0.1).unit("m"));
    let references = [reference];
    let printed = text::text(&references);
    let miss = "MISS mirror: length, in the middle: 2.50000 m, known 2.00000, allowed ±0.10";
    assert!(printed.contains(miss) && !printed.contains("all "), "{printed}");
    let page = page::page(&references).to_html().unwrap();
    assert!(page.contains("Misses: length, in the middle"));
}

#[test]
fn sperlings_index_and_the_weightings_are_the_published_ones() {
    assert_met(ride::reference);
}

#[test]
fn a_reference_ends_when_the_flag_is_set_and_those_that_are_done_stay() {
    let set = AtomicBool::new(true);
    for compute in [cooperrider::reference, energy::reference, symmetry::reference] {
        let ended = compute(&set);
        assert!(matches!(ended, Err(EvidenceError::Stopped)), "{ended:?}");
    }
    assert!(matches!(irregularity::reference(&set), Err(EvidenceError::Stopped)));
    // The flag is set by the first reference that is done.
    let stop = AtomicBool::new(false);
    let done = all(&stop, &|_, _, _| stop.store(true, Ordering::Relaxed)).unwrap();
    assert!((1..REFERENCES.len()).contains(&done.len()), "{}", done.len());
}
