//! Who may ask for what.
//!
//! A browser lets any site send requests to this address, and a site may even change the address of
//! its own name to it (DNS rebinding). Three things tell the page's own requests from theirs, and
//! none of them can be set by a script of another site:
//!
//! ```text
//! Host            the address that is served, by its number or as localhost
//! Origin          where it is sent: http:// and that host; the button needs it
//! Sec-Fetch-Site  where it is sent: same-origin, or none for an address that was typed
//! ```
//!
//! The button also needs the token of this run, which only the page itself holds. Besides the page
//! and its data the button is all that there is: nothing can be armed, started or set.
//!
//! Limit: any program on this machine can read the page and press the button, as at the terminal.

use super::request::{Refusal, Request};
use crate::draw::Draw;
use std::fmt::Write as _;
use std::net::SocketAddr;

/// The header field that holds the token.
pub(super) const TOKEN_FIELD: &str = "x-yawbench-token";

/// What a request asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wish {
    Page,
    Script,
    Style,
    Events,
    RampOut,
}

/// What the requests of this run have to show.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Gate {
    hosts: Vec<String>,
    token: String,
}

impl Gate {
    /// The gate of a served address, with a token of its own.
    pub(super) fn new(address: SocketAddr, draw: &mut Draw) -> Self {
        let mut token = String::new();
        for _ in 0..4 {
            // Writing to a string cannot fail.
            let _ = write!(token, "{:08x}", draw.number());
        }
        let mut hosts = vec![address.to_string(), format!("localhost:{}", address.port())];
        if address.port() == 80 {
            // Browsers leave out the port that they would ask anyway.
            let bare = hosts.iter().filter_map(|host| host.strip_suffix(":80").map(str::to_owned));
            hosts.extend(bare.collect::<Vec<_>>());
        }
        Self { hosts, token }
    }

    /// The token of this run.
    pub(super) fn token(&self) -> &str {
        &self.token
    }

    /// What a request asks for, if it may.
    pub(super) fn admit(&self, request: &Request) -> Result<Wish, Refusal> {
        let host = request.field("host")?.filter(|host| self.hosts.iter().any(|own| own == host));
        let Some(host) = host else {
            return Err(Refusal::new(403, "this page has another address"));
        };
        let origin = request.field("origin")?;
        if origin.is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
            return Err(Refusal::new(403, "requests of other sites are refused"));
        }
        let site = request.field("sec-fetch-site")?;
        if site.is_some_and(|site| !matches!(site, "same-origin" | "none")) {
            return Err(Refusal::new(403, "requests of other sites are refused: type the address"));
        }
        let (method, wish) = match request.path.as_str() {
            "/" => ("GET", Wish::Page),
            "/page.js" => ("GET", Wish::Script),
            "/page.css" => ("GET", Wish::Style),
            "/events" => ("GET", Wish::Events),
            "/ramp-out" => ("POST", Wish::RampOut),
            _ => return Err(Refusal::new(404, "there is nothing here")),
        };
        if request.method != method {
            return Err(Refusal::new(405, "this cannot be asked for in this way"));
        }
        if wish == Wish::RampOut {
            if origin.is_none() {
                return Err(Refusal::new(403, "the button is pressed on the page"));
            }
            if !is_same(request.field(TOKEN_FIELD)?.unwrap_or_default(), &self.token) {
                return Err(Refusal::new(403, "this is the page of another run: load it again"));
            }
        }
        Ok(wish)
    }
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn is_same(one: &str, other: &str) -> bool {
    let differences = one.bytes().zip(other.bytes()).fold(0, |found, (a, b)| found | (a ^ b));
    one.len() == other.len() && differences == 0
}

#[cfg(test)]
mod tests {
    use super::*;

    const ADDRESS: &str = "127.0.0.1:8080";

    fn gate() -> Gate {
        Gate::new(ADDRESS.parse().unwrap(), &mut Draw::seeded(1, 0))
    }

    /// What is answered to a request line and some header fields.
    fn asked(line: &str, fields: &[(&str, &str)]) -> Result<Wish, u16> {
        let fields = fields.iter().map(|(name, value)| format!("{name}: {value}\r\n"));
        let text = format!("{line} HTTP/1.1\r\n{}\r\n", fields.collect::<String>());
        let request = Request::read(text.as_bytes()).unwrap().unwrap();
        gate().admit(&request).map_err(|refusal| refusal.status)
    }

    #[test]
    fn the_page_and_its_parts_are_given_to_its_own_address() {
        let host = ("Host", ADDRESS);
        for (path, wish) in [
            ("/", Wish::Page),
            ("/page.js", Wish::Script),
            ("/page.css", Wish::Style),
            ("/events", Wish::Events),
        ] {
            assert_eq!(asked(&format!("GET {path}"), &[host]), Ok(wish));
            assert_eq!(asked(&format!("GET {path}"), &[("Host", "localhost:8080")]), Ok(wish));
            assert_eq!(asked(&format!("POST {path}"), &[host]), Err(405));
            assert_eq!(asked(&format!("GET {path}?a"), &[host]), Err(404));
        }
        for path in ["//", "/../", "/record.npy", "/arm", "/favicon.ico"] {
            assert_eq!(asked(&format!("GET {path}"), &[host]), Err(404), "{path}");
        }
        assert_eq!(asked("OPTIONS /ramp-out", &[host]), Err(405));
    }

    #[test]
    fn the_port_of_http_may_be_left_out() {
        let gate = Gate::new("[::1]:80".parse().unwrap(), &mut Draw::seeded(1, 0));
        assert_eq!(gate.hosts, ["[::1]:80", "localhost:80", "[::1]", "localhost"]);
    }

    #[test]
    fn another_host_or_site_gets_nothing() {
        for host in ["evil.example:8080", "127.0.0.1", "127.0.0.1:80", "localhost", ""] {
            assert_eq!(asked("GET /", &[("Host", host)]), Err(403), "{host}");
        }
        assert_eq!(asked("GET /", &[]), Err(403));
        let host = ("Host", ADDRESS);
        for origin in
            ["http://evil.example", "null", "https://127.0.0.1:8080", "http://localhost:8080"]
        {
            assert_eq!(asked("GET /events", &[host, ("Origin", origin)]), Err(403), "{origin}");
        }
        for (site, answer) in [
            ("cross-site", Err(403)),
            ("same-site", Err(403)),
            ("same-origin", Ok(Wish::Page)),
            ("none", Ok(Wish::Page)),
        ] {
            assert_eq!(asked("GET /", &[host, ("Sec-Fetch-Site", site)]), answer, "{site}");
        }
    }

    #[test]
    fn the_button_needs_its_own_page() {
        let gate = gate();
        let (host, origin) = (("Host", ADDRESS), ("Origin", "http://127.0.0.1:8080"));
        let token = (TOKEN_FIELD, gate.token());
        let press = |fields: &[(&str, &str)]| asked("POST /ramp-out", fields);
        assert_eq!(press(&[host, origin, token]), Ok(Wish::RampOut));
        assert_eq!(press(&[host, origin]), Err(403));
        assert_eq!(press(&[host, token]), Err(403));
        assert_eq!(press(&[origin, token]), Err(403));
        let rebound =
            [("Host", "evil.example:8080"), ("Origin", "http://evil.example:8080"), token];
        assert_eq!(press(&rebound), Err(403));
        let cut = &gate.token()[1..];
        for wrong in ["", cut, &"0".repeat(32), &format!("{}0", gate.token())] {
            assert_eq!(press(&[host, origin, (TOKEN_FIELD, wrong)]), Err(403), "{wrong}");
        }
        let other = Gate::new(ADDRESS.parse().unwrap(), &mut Draw::seeded(2, 0));
        assert_ne!(other.token(), gate.token());
        assert_eq!(
            (gate.token().len(), gate.token().bytes().all(|b| b.is_ascii_hexdigit())),
            (32, true)
        );
        let pressed_by_a_link = asked("GET /ramp-out", &[host, origin, token]);
        assert_eq!(pressed_by_a_link, Err(405));
    }
}
