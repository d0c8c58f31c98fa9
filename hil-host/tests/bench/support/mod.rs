//! What several topics share.

pub(crate) mod host;
pub(crate) mod locomotive;
pub(crate) mod own_messages;
pub(crate) mod rig;
