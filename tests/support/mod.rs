//! What several topics share.

pub(crate) mod bits;
pub(crate) mod command;
pub(crate) mod live_page;
pub(crate) mod opened;
pub(crate) mod record;
pub(crate) mod schema;
pub(crate) mod session;
pub(crate) mod visit;
pub(crate) mod whole_run;
