//! A study whose files change has no answer.

use crate::support::{GO, bogie, linear};
use vehicle_studies::StudyError;

#[test]
fn a_file_that_changes_while_the_study_runs_is_an_error_and_no_answer() {
    let place = bogie("changed");
    let study = linear(&place);
    let identity = study.identity().unwrap();
    assert!(study.point(&identity, 0, &GO).unwrap().unwrap().failure.is_none());
    let vehicle = std::fs::read_to_string(place.join("vehicle.toml")).unwrap();
    std::fs::write(place.join("vehicle.toml"), format!("{vehicle}\n# edited\n")).unwrap();
    let why = study.point(&identity, 0, &GO).unwrap_err();
    assert!(matches!(why, StudyError::Changed(..)) && !why.is_bad_input(), "{why}");
    let said = why.to_string();
    assert!(said.contains("bogie.toml: changed while the study ran (vehicle)"), "{said}");
    // A file that became unreadable is no answer either.
    std::fs::write(place.join("vehicle.toml"), "name = 1\n").unwrap();
    assert!(study.point(&identity, 0, &GO).is_err());
    std::fs::remove_dir_all(&place).unwrap();
}

#[test]
fn a_moved_scenario_has_the_same_identity() {
    let (first, moved) = (bogie("here"), bogie("there"));
    let identities = [&first, &moved].map(|place| linear(place).identity().unwrap());
    assert_eq!(identities[0], identities[1]);
    assert_eq!(identities[0].inputs.keys().collect::<Vec<_>>(), ["scenario", "vehicle"]);
    for place in [first, moved] {
        std::fs::remove_dir_all(place).unwrap();
    }
}
