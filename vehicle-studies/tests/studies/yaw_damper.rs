//! The reference problem with a yaw damper, as others meet it.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use vehicle_studies::StudyError;
use vehicle_studies::trip::DiscreteFilter;
use vehicle_studies::yaw_damper_problem::{
    Candidate, Condition, Motion, Ours, Problem, Question, Regime, motion_csv, read_command, text,
};

static GO: AtomicBool = AtomicBool::new(false);

fn scenario() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/ss9-160kmh-servo-rig.toml")
}

#[test]
fn a_command_of_ours_that_went_through_csv_scores_as_it_did() {
    let problem = Problem::load(&scenario(), &[Condition::New], &GO).unwrap();
    let motion = Motion { damper: Condition::New, regime: Regime::Track };
    let file = std::env::temp_dir().join(format!("command-{}.csv", std::process::id()));
    for ours in [Ours::None, Ours::Polynomial, Ours::Adaptive] {
        let (command, errors) = problem.own_command(motion, 5, ours);
        std::fs::write(&file, motion_csv(&command)).unwrap();
        let read = read_command(&file, motion.regime).unwrap();
        assert_eq!(read, command);
        let errors = errors.unwrap();
        assert_eq!(problem.open_loop(motion, 5, &read), Some(errors), "{ours:?}");
        // 10 ms late without a compensator.
        let is_late = errors.phase_deg < -8.0;
        assert_eq!(is_late, ours == Ours::None, "{ours:?}: {errors:?}");
    }
    std::fs::remove_file(&file).unwrap();
    // The wanted motion itself is the command of no compensator.
    let none = problem.own_command(motion, 5, Ours::None);
    assert_eq!(problem.open_loop(motion, 5, problem.wanted(motion)), none.1);
}

#[test]
fn a_filter_closes_the_loop_and_one_that_passes_all_is_no_compensator() {
    let question = Question { dampers: vec![Condition::New], ..Question::quick(1) };
    let problem = Problem::load(&scenario(), &question.dampers, &GO).unwrap();
    let identity = DiscreteFilter::new(&[1.0], &[1.0]).unwrap();
    let candidates = [Candidate::Filter(identity), Candidate::Ours(Ours::None)];
    let answer = problem.score(&question, &candidates, &GO, &|_, _| ()).unwrap();
    let [filter, none] = answer.scores.as_slice() else { panic!("{:?}", answer.scores) };
    assert_eq!(filter.nominal, none.nominal);
    assert_eq!((filter.compensator, none.compensator), ("filter", "none"));
    // What others are asked is asked of their filter.
    let said = text(&answer);
    assert!(said.contains("emulated rig") && said.contains("MISSED"), "{said}");
    assert!(answer.aims.iter().all(|aim| aim.compensator == "filter"), "{:?}", answer.aims);
}

/// The adaptive compensator, at the ends of the range of dead times, on the nominal rig and on some
/// that it was not told of; a worn damper loads its rig in one part of the stroke only.
#[test]
fn every_aim_is_met_on_nominal_and_perturbed_rigs() {
    let question = Question { dead_times_ms: vec![1, 15], perturbed_rigs: 3, ..Question::quick(1) };
    let problem = Problem::load(&scenario(), &question.dampers, &GO).unwrap();
    let candidates = [Candidate::Ours(Ours::Adaptive)];
    let answer = problem.score(&question, &candidates, &GO, &|_, _| ()).unwrap();
    assert_eq!(answer.aims.len(), 6, "{:?}", answer.aims);
    assert!(answer.aims.iter().all(|aim| aim.is_met), "{}", text(&answer));
    for damper in &answer.dampers {
        // One rig, and nearly one number whatever is mounted.
        let (_, load) = damper.data_sheet.inverse_under_load();
        assert!((0.9e-8..1.3e-8).contains(&load.m_per_n), "{:?}: {load:?}", damper.damper);
        assert!((0.3e-7..1.5e-7).contains(&load.s_per_n), "{:?}: {load:?}", damper.damper);
    }
}

#[test]
fn work_that_is_stopped_ends_at_once() {
    let stop = AtomicBool::new(true);
    let ended = Problem::load(&scenario(), &[Condition::New], &stop);
    assert!(matches!(ended, Err(StudyError::Stopped)));
}
