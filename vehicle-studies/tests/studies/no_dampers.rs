//! A vehicle without dampers.

use crate::support::{GO, bogie, linear};
use vehicle_studies::study::Study;

#[test]
fn a_vehicle_without_dampers_gets_one_linear_column_and_not_one_for_every_stroke() {
    let place = bogie("no-dampers");
    let asked = linear(&place);
    let point = asked.point(&asked.identity().unwrap(), 0, &GO).unwrap().unwrap();
    assert_eq!(point.answer.linear.len(), 1);
    let text = asked.study.text(std::slice::from_ref(&point));
    assert_eq!(text.matches("linear, ").count(), 1, "{text}");
    assert!(text.contains("linear, no dampers"), "{text}");
    // The Hopf point of the literature: 68.66 m/s.
    let kmh = point.answer.linear[0].critical.kmh().unwrap();
    assert!((0.0..0.5).contains(&(kmh - 3.6 * 68.666)), "{kmh}");
    std::fs::remove_dir_all(&place).unwrap();
}
