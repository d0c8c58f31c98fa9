//! Errors of what a run is made of, as errors of the run.

use super::BenchError;
use crate::bus::BusError;
use crate::gateway::GatewayError;
use dbc::DbcError;
use files::{FolderError, InputError};
use scenario::source::ScenarioError;

impl From<ScenarioError> for BenchError {
    fn from(why: ScenarioError) -> Self {
        Self::Scenario(why)
    }
}

impl From<can_protocol::Error> for BenchError {
    fn from(why: can_protocol::Error) -> Self {
        Self::Protocol(why)
    }
}

impl From<BusError> for BenchError {
    fn from(why: BusError) -> Self {
        Self::Bus(why)
    }
}

impl From<DbcError> for BenchError {
    fn from(why: DbcError) -> Self {
        Self::Dbc(Box::new(why))
    }
}

impl From<GatewayError> for BenchError {
    fn from(why: GatewayError) -> Self {
        Self::Gateway(Box::new(why))
    }
}

impl From<FolderError> for BenchError {
    fn from(why: FolderError) -> Self {
        Self::Folder(why)
    }
}

impl From<InputError> for BenchError {
    fn from(why: InputError) -> Self {
        Self::Input(why)
    }
}

impl From<report::Error> for BenchError {
    fn from(why: report::Error) -> Self {
        Self::Report(why)
    }
}

impl From<serde_json::Error> for BenchError {
    fn from(why: serde_json::Error) -> Self {
        Self::Summary(why)
    }
}
