//! `--serve`: the page of a run on this machine.

use crate::error::CommandError;
use hil_host::control::Requests;
use hil_host::live::{LiveAddress, LivePage};

/// Serves a page whose button asks `requests` for the end, and says where it is.
///
/// # Errors
/// The port is in use.
pub(crate) fn served(
    address: LiveAddress,
    requests: &'static Requests,
) -> Result<LivePage, CommandError> {
    let page = LivePage::serve(address, requests).map_err(|why| {
        CommandError::option(format!("--serve {address}"), format!("a free port ({why})"))
    })?;
    files::say!("page: http://{}/", page.address());
    Ok(page)
}
