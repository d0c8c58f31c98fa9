//! The bench without a kernel's CAN: the rig in virtual time, the loop on the memory bus.
#![allow(clippy::unwrap_used, reason = "a test stops where it fails")]

mod control_loop;
mod delay_gate;
mod driven_rigs;
mod fault_table;
mod faults;
mod gateway;
mod gateway_maps;
mod locomotive_node;
mod plausibility;
mod ramps;
mod rates;
mod rig_answers;
mod rig_physics;
mod rig_process;
mod rig_states;
mod second_sender;
mod servo_controller;
mod several_rigs;
mod sound_rigs;
mod stand_ins;
mod support;
mod track_by_message;
mod unfit_rigs;
