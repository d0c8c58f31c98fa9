//! Where a page may be served: on the loopback of this machine, and nowhere else.

use std::fmt;
use std::net::SocketAddr;
use std::str::FromStr;

/// A loopback address and a port; port 0 is any free one.
///
/// ```
/// use hil_host::live::LiveAddress;
/// assert!("127.0.0.1:0".parse::<LiveAddress>().is_ok());
/// assert!("[::1]:8080".parse::<LiveAddress>().is_ok());
/// assert!("0.0.0.0:8080".parse::<LiveAddress>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LiveAddress(SocketAddr);

impl LiveAddress {
    /// The address for a socket.
    pub const fn socket(self) -> SocketAddr {
        self.0
    }
}

/// A text that is no such address.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotLoopback {
    /// Whether it is an address, of another network.
    is_elsewhere: bool,
}

impl FromStr for LiveAddress {
    type Err = NotLoopback;

    fn from_str(text: &str) -> Result<Self, NotLoopback> {
        match text.parse::<SocketAddr>() {
            Ok(address) if address.ip().is_loopback() => Ok(Self(address)),
            parsed => Err(NotLoopback { is_elsewhere: parsed.is_ok() }),
        }
    }
}

impl fmt::Display for LiveAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl fmt::Display for NotLoopback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("expected a loopback address with a port, such as 127.0.0.1:8080")?;
        if self.is_elsewhere {
            f.write_str("; from another machine it is reached by `ssh -L 8080:127.0.0.1:8080`")?;
        }
        Ok(())
    }
}

impl std::error::Error for NotLoopback {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_loopback_is_served() {
        for text in ["127.0.0.1:80", "127.0.0.2:0", "[::1]:8080"] {
            assert_eq!(text.parse::<LiveAddress>().map(|found| found.to_string()), Ok(text.into()));
        }
        let elsewhere = ["0.0.0.0:80", "192.168.1.7:80", "[::]:80", "[::ffff:127.0.0.1]:80"];
        for text in elsewhere {
            let why = text.parse::<LiveAddress>().unwrap_err().to_string();
            assert!(why.contains("expected a loopback") && why.contains("ssh -L"), "{text}: {why}");
        }
        for text in ["", "80", "127.0.0.1", "localhost:80", "127.0.0.1:99999", "127.0.0.1:80/a"] {
            let why = text.parse::<LiveAddress>().unwrap_err().to_string();
            assert!(why.ends_with("such as 127.0.0.1:8080"), "{text}: {why}");
        }
    }
}
