//! A request of a browser, read from bytes that anybody may have sent.
//!
//! Only what the page needs is understood: a request line, header fields, no body. Everything else
//! is refused with a status, and so is anything that is long.

/// Longest head: request line and header fields, bytes.
pub(super) const HEAD_MAX: usize = 8 * 1024;

/// Most header fields.
const FIELDS_MAX: usize = 64;

/// The end of a head.
const END: &[u8] = b"\r\n\r\n";

/// A request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) method: String,
    pub(super) path: String,
    /// Names in lower case, and values.
    fields: Vec<(String, String)>,
}

/// Why a request is not answered with what it asks for: a status and its reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Refusal {
    pub(super) status: u16,
    pub(super) why: &'static str,
}

impl Refusal {
    pub(super) const fn new(status: u16, why: &'static str) -> Self {
        Self { status, why }
    }
}

const BAD: Refusal = Refusal::new(400, "this is no request of a browser");
const LONG: Refusal = Refusal::new(431, "the request is too long");

impl Request {
    /// Reads the bytes that have come so far; none while the head is not complete.
    pub(super) fn read(bytes: &[u8]) -> Result<Option<Self>, Refusal> {
        let end = bytes.windows(END.len()).position(|window| window == END);
        let head = bytes.get(..end.unwrap_or(bytes.len())).unwrap_or_default();
        // Refused before it is complete: what is no text will never be a request.
        if !head.iter().all(|byte| matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n')) {
            return Err(BAD);
        }
        if head.len() > HEAD_MAX {
            return Err(LONG);
        }
        if end.is_none() {
            return Ok(None);
        }
        let head = std::str::from_utf8(head).map_err(|_| BAD)?;
        let mut lines = head.split("\r\n");
        let (method, path) = request_line(lines.next().unwrap_or_default())?;
        let mut fields = Vec::new();
        for line in lines {
            if fields.len() == FIELDS_MAX {
                return Err(LONG);
            }
            fields.push(field(line)?);
        }
        let request = Self { method: method.to_owned(), path: path.to_owned(), fields };
        request.check_body()?;
        Ok(Some(request))
    }

    /// The value of a header field; none where it is missing. One that comes twice is refused:
    /// nobody can say which of both counts.
    pub(super) fn field(&self, name: &str) -> Result<Option<&str>, Refusal> {
        let mut found = self.fields.iter().filter(|(own, _)| own == name);
        let first = found.next().map(|(_, value)| value.as_str());
        if found.next().is_some() { Err(BAD) } else { Ok(first) }
    }

    /// Nothing that is asked for has a body.
    fn check_body(&self) -> Result<(), Refusal> {
        if self.field("transfer-encoding")?.is_some() {
            return Err(BAD);
        }
        match self.field("content-length")? {
            None | Some("0") => Ok(()),
            Some(length) if length.bytes().all(|byte| byte.is_ascii_digit()) => {
                Err(Refusal::new(413, "no request has a body here"))
            }
            Some(_) => Err(BAD),
        }
    }
}

/// Method and path of a request line.
fn request_line(line: &str) -> Result<(&str, &str), Refusal> {
    let mut parts = line.split(' ');
    let (Some(method), Some(path), Some(version), None) =
        (parts.next(), parts.next(), parts.next(), parts.next())
    else {
        return Err(BAD);
    };
    let is_method = !method.is_empty() && method.bytes().all(|byte| byte.is_ascii_uppercase());
    let is_path = path.starts_with('/') && !path.contains(['\t', '\r', '\n']);
    let is_version = matches!(version, "HTTP/1.0" | "HTTP/1.1");
    if is_method && is_path && is_version { Ok((method, path)) } else { Err(BAD) }
}

/// Name and value of a header field.
fn field(line: &str) -> Result<(String, String), Refusal> {
    let (name, value) = line.split_once(':').ok_or(BAD)?;
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"!#$%&'*+-.^_`|~".contains(&byte);
    if name.is_empty() || !name.bytes().all(is_name) || value.contains(['\r', '\n']) {
        return Err(BAD);
    }
    Ok((name.to_ascii_lowercase(), value.trim_matches([' ', '\t']).to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Result<Option<Request>, Refusal> {
        Request::read(text.as_bytes())
    }

    fn status(text: &str) -> u16 {
        read(text).expect_err("a refusal").status
    }

    #[test]
    fn a_request_is_read_when_its_head_is_complete() {
        let text =
            "POST /ramp-out HTTP/1.1\r\nHost: a:1\r\nX-Token:  b \r\ncontent-length: 0\r\n\r\n";
        for end in 0..text.len() {
            assert_eq!(read(&text[..end]), Ok(None), "{end}");
        }
        let request = read(text).unwrap().unwrap();
        assert_eq!((request.method.as_str(), request.path.as_str()), ("POST", "/ramp-out"));
        assert_eq!(request.field("host"), Ok(Some("a:1")));
        assert_eq!(request.field("x-token"), Ok(Some("b")));
        assert_eq!(request.field("origin"), Ok(None));
    }

    #[test]
    fn what_no_browser_sends_is_refused() {
        for text in [
            "\r\n\r\n",
            "GET / HTTP/2.0\r\n\r\n",
            "GET /\r\n\r\n",
            "GET  / HTTP/1.1\r\n\r\n",
            "get / HTTP/1.1\r\n\r\n",
            "GET http://a/ HTTP/1.1\r\n\r\n",
            "GET / HTTP/1.1 \r\n\r\n",
            "GET / HTTP/1.1\r\nHost\r\n\r\n",
            "GET / HTTP/1.1\r\n: a\r\n\r\n",
            "GET / HTTP/1.1\r\nHost : a\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: a\r\n b\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: a\nOrigin: b\r\n\r\n",
            "GET / HTTP/1.1\r\nContent-Length: 0\r\nContent-Length: 0\r\n\r\n",
            "GET / HTTP/1.1\r\nContent-Length: -1\r\n\r\n",
            "GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n",
            "GET /\u{e9} HTTP/1.1\r\n\r\n",
            "\u{16}\u{3}\u{1}",
        ] {
            assert_eq!(status(text), 400, "{text:?}");
        }
        assert_eq!(status("POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\nhello"), 413);
        let twice = read("GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n").unwrap().unwrap();
        assert_eq!(twice.field("host"), Err(BAD));
    }

    #[test]
    fn a_long_request_is_refused_before_it_is_complete() {
        assert_eq!(status(&format!("GET /{}", "a".repeat(HEAD_MAX))), 431);
        let fields = |count: usize| format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(count));
        assert!(read(&fields(FIELDS_MAX)).is_ok());
        assert_eq!(status(&fields(FIELDS_MAX + 1)), 431);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn no_bytes_are_too_much_for_it(bytes in proptest::collection::vec(any::<u8>(), 0..9000)) {
            if let Ok(Some(request)) = Request::read(&bytes) {
                prop_assert!(request.path.starts_with('/'));
                prop_assert!(request.fields.len() <= FIELDS_MAX);
            }
        }

        #[test]
        fn nor_is_a_request_with_any_part_of_it_changed(
            at in 0_usize..80, with in any::<u8>(), cut in 0_usize..80
        ) {
            let mut bytes =
                b"POST /ramp-out HTTP/1.1\r\nHost: 127.0.0.1:8080\r\nOrigin: http://127.0.0.1\r\n\r\n"
                    .to_vec();
            let at = at % bytes.len();
            bytes[at] = with;
            bytes.truncate(bytes.len().saturating_sub(cut));
            if let Ok(Some(request)) = Request::read(&bytes) {
                prop_assert!(request.method.bytes().all(|byte| byte.is_ascii_uppercase()));
            }
        }
    }
}
