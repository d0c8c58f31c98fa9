//! `yawbench reproduce --validation`: every reference is met, in the table, the file and the page; and what
//! is not there yet is refused.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

#[path = "support/command.rs"]
mod command;
#[path = "support/schema.rs"]
mod schema;

use command::{folder, output, read, repository, yawbench};
use serde_json::Value;

#[test]
fn every_reference_is_met_and_written_down() {
    let place = folder("reproduce-validation");
    let result =
        output(yawbench().args(["reproduce", "--validation", "--out=found"]).current_dir(&place));
    let (told, errors) =
        (String::from_utf8_lossy(&result.stdout), String::from_utf8_lossy(&result.stderr));
    println!("{told}");
    assert_eq!(result.status.code(), Some(0), "{told}{errors}");
    let found: Value = serde_json::from_str(&read(&place.join("found/validation.json"))).unwrap();
    let schema = read(&repository().join("docs/schema/validation.schema.json"));
    let schema: Value = serde_json::from_str(&schema).unwrap();
    assert_eq!(schema::misfits(&schema, &found), Vec::<String>::new());
    assert_eq!(found["passes"], true);
    let page = read(&place.join("found/validation.html"));
    for reference in found["references"].as_array().unwrap() {
        let title = reference["title"].as_str().unwrap();
        assert!(page.contains(&title.replace('\'', "&#39;")), "{title}");
        assert!(told.contains(title), "{title}");
    }
    // The pair that is quoted elsewhere is named, and said not to follow from this parameter set.
    assert!(page.contains("66.61 m/s") && page.contains("62.02 m/s"));
}

#[test]
fn what_is_not_there_is_refused_in_one_line_and_nothing_is_written() {
    let place = folder("reproduce-refused");
    let result = output(yawbench().args(["reproduce", "--out=out"]).current_dir(&place));
    let errors = String::from_utf8_lossy(&result.stderr);
    assert_eq!(result.status.code(), Some(2), "{errors}");
    assert_eq!(errors.lines().count(), 1, "{errors}");
    assert!(errors.contains("to come") && !place.join("out").exists(), "{errors}");
}
