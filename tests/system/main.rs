//! Tests of the whole program, one module per topic: the command line as a person uses it,
//! scenarios run in this process, and the repository itself.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

#[path = "../support/mod.rs"]
mod support;

mod architecture;
mod bad_input;
mod bench_day;
mod bench_states;
mod blow_up;
mod campaign;
mod characterise;
mod coach;
mod comments;
mod compare;
mod critical_speed;
mod curve;
mod determinism;
mod doctor;
mod golden;
mod hyperqueue;
mod identify_command;
mod identify_empirical;
mod identify_page;
mod interrupted_study;
mod killed_run;
mod known_rig;
mod layout;
mod live_page;
mod measured_run;
mod on_mass;
mod open_loop;
mod own_messages;
mod partial_records;
mod physics;
mod rates;
mod real_records;
mod rehearse;
mod replay;
mod reproduce;
mod ride;
mod rig_calibration;
mod rig_delay;
mod rig_motions;
mod rtcheck;
mod rths_benchmark;
mod run_command;
mod several_rigs;
mod side_by_side;
mod stale_answers;
mod system_calls;
mod track_server;
mod watch;
mod yaw_damper_problem;
