//! Points whose trips share batches have the answers of points that are asked one by one.

use crate::support::GO;
use rayon::prelude::*;
use std::fmt::Debug;
use std::path::Path;
use std::sync::Arc;
use vehicle_studies::critical_speed::{self, Question};
use vehicle_studies::grid::{Axis, Grid};
use vehicle_studies::ride;
use vehicle_studies::study::{Study, Varied, VariedStudy};
use vehicle_studies::trip::Together;

/// The answers at all points: one by one, and among others on one core and on two.
fn answers<S: Study<Answer: Debug>>(study: S, axis: &str) -> Vec<S::Answer> {
    let scenario = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh.toml");
    let axis: Axis = axis.parse().unwrap();
    let varied = Varied { scenario, grid: Grid::new(vec![axis]).unwrap() };
    let asked = VariedStudy { varied, study };
    let identity = asked.identity().unwrap();
    let points = 0..asked.varied.grid.len();
    let alone: Vec<S::Answer> = points
        .clone()
        .map(|index| asked.point(&identity, index, &GO).unwrap().unwrap())
        .inspect(|point| assert_eq!(point.failure, None))
        .map(|point| point.answer)
        .collect();
    for cores in [1, 2] {
        let together = Arc::new(Together::on(cores));
        let point = |index| {
            asked.point_among_others(&identity, index, &GO, &together).unwrap().unwrap().answer
        };
        let all = points.clone().into_par_iter().with_max_len(1).map(point);
        let answers: Vec<S::Answer> = together.install(|| all.collect());
        assert!(answers == alone, "{cores} cores: {answers:?}, alone {alone:?}");
    }
    alone
}

#[test]
fn critical_speeds_do_not_depend_on_who_else_is_under_way() {
    let procedure = critical_speed::Procedure {
        from_kmh: 280.0,
        to_kmh: 300.0,
        step_kmh: 10.0,
        hold_s: 1.5,
        watched_s: 0.5,
        ..critical_speed::Procedure::default()
    };
    let study = Question { procedure, ascent: false, fold: true, strokes_m: Vec::new() };
    let found = answers(study, "damper.clearance_2a_m=0.2e-3:8e-3:3");
    let folds: Vec<_> = found.iter().map(|answer| answer.fold.as_ref().unwrap()).collect();
    // They hunt, each in its own way.
    assert!(folds.iter().all(|fold| fold.cycle.len() > 1), "{folds:?}");
    assert!(folds[0] != folds[1] && folds[1] != folds[2], "{folds:?}");
}

#[test]
fn rides_do_not_depend_on_who_else_is_under_way() {
    let study = ride::Procedure {
        run_in_s: 1.0,
        section_s: 20.0,
        seeds: vec![1, 2],
        ..ride::Procedure::default()
    };
    let found = answers(study, "damper.ke_n_per_m=4e6,12e6");
    assert!(found[0].ride.is_some() && found[0] != found[1]);
}
