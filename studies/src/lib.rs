//! From recorded signals to figures, and records to try them on.
//!
//! [`spectrum`] is Welch's power spectral density with its peak; [`statistics`] are rms, extremes,
//! percentiles and half cycles; [`guiding_force`] filters axle forces and Y/Q as acceptance tests do.
//! None of these knows where a signal comes from; units are those of the caller.
//!
//! [`series_model`] is a series damper by its own integration, apart from the core's, with disturbances
//! that no effect of the catalogue describes; [`hydraulic`] is a damper from its chambers, valves, oil
//! and rubber; [`bench_visit`] moves a damper as a bench does.
//! [`trip`] runs a vehicle in virtual time; [`modes`] and [`describing_function`] are its small vibrations,
//! [`critical_speed`] asks from which speed on it hunts, [`ride`] how it rides, [`curve`] how it goes
//! through a curve. [`study`] is what these have in common: [`sweep`] varies what is asked about,
//! [`shards`] cuts long work into parts. [`response`] filters by a frequency response.
//! [`validation`] sets all of it beside what is known.
//! [`measurement`] is the way in for what a bench measured, [`laboratory`] what a laboratory prints of it.

pub mod bench_visit;
pub mod campaign;
pub mod critical_speed;
pub mod curve;
pub mod describing_function;
pub mod error;
pub mod fnv;
pub mod guiding_force;
pub mod hydraulic;
pub mod identify;
pub mod laboratory;
pub mod measurement;
pub mod modes;
pub mod over_keys;
pub mod reproduce;
pub mod response;
pub mod ride;
pub mod series_model;
pub mod shards;
pub mod spectrum;
pub mod statistics;
pub mod study;
pub mod sweep;
pub mod trip;
pub mod validation;
