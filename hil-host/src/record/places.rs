//! The places of the dampers in a record, from `run.json` next to it.

use files::{Limit, input};
use serde::Deserialize;
use std::path::Path;

/// What a run is asked for, and which program runs it.
pub(crate) const ABOUT: &str = "run.json";

/// What `run.json` says of the damper slots.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(default)]
pub(super) struct Places {
    /// The place of every slot on the vehicle.
    pub(super) places: Vec<String>,
    /// Numbers of the slots on rigs, from one.
    pub(super) rig_slots: Vec<usize>,
}

impl Places {
    /// Those of a record; none where no readable `run.json` lies next to it.
    pub(super) fn next_to(record: &Path) -> Self {
        let text = input::read_text(&record.with_file_name(ABOUT), Limit::Text);
        text.ok().and_then(|text| serde_json::from_str(&text).ok()).unwrap_or_default()
    }
}
