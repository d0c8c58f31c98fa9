//! Answers: a status, fields that keep the page on its own, and a body.

use super::request::Refusal;

/// Nothing is fetched from elsewhere, nothing inline is run, nobody frames the page.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      form-action 'none'; base-uri 'none'; frame-ancestors 'none'";

/// The fields of every answer but those of its body.
fn head(status: u16, kind: &str) -> String {
    format!(
        "HTTP/1.1 {status} {}\r\n\
         Content-Type: {kind}\r\n\
         Content-Security-Policy: {POLICY}\r\n\
         X-Content-Type-Options: nosniff\r\n\
         X-Frame-Options: DENY\r\n\
         Referrer-Policy: same-origin\r\n\
         Cross-Origin-Resource-Policy: same-origin\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\n\
         Cache-Control: no-store\r\n\
         Connection: close\r\n",
        reason(status)
    )
}

/// A whole answer.
pub(super) fn answer(kind: &str, body: &str) -> Vec<u8> {
    whole(200, kind, "", body)
}

/// What a refused request gets.
pub(super) fn refused(refusal: Refusal) -> Vec<u8> {
    let allow = if refusal.status == 405 { "Allow: GET, POST\r\n" } else { "" };
    let body = format!("{} {}: {}\n", refusal.status, reason(refusal.status), refusal.why);
    whole(refusal.status, "text/plain; charset=utf-8", allow, &body)
}

fn whole(status: u16, kind: &str, more: &str, body: &str) -> Vec<u8> {
    let head = head(status, kind);
    format!("{head}{more}Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
}

/// The head of a stream of events, which has no length.
pub(super) fn stream() -> Vec<u8> {
    // A browser that has lost the stream asks again after a second.
    format!("{}\r\nretry: 1000\n\n", head(200, "text/event-stream")).into_bytes()
}

/// An event of a stream. JSON has no line ends.
pub(super) fn event(name: &str, json: &str) -> Vec<u8> {
    debug_assert!(!json.contains(['\r', '\n']), "an event of several lines");
    format!("event: {name}\ndata: {json}\n\n").into_bytes()
}

const fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        413 => "Content Too Large",
        431 => "Request Header Fields Too Large",
        503 => "Service Unavailable",
        _ => "Bad Request",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_answer_forbids_what_the_page_does_not_need() {
        let refusal = refused(Refusal::new(405, "no"));
        for bytes in [answer("text/html", "é"), refusal.clone(), stream()] {
            let text = String::from_utf8(bytes).unwrap();
            let (head, body) = text.split_once("\r\n\r\n").unwrap();
            for field in [
                "Content-Security-Policy: default-src 'none';",
                "frame-ancestors 'none'",
                "X-Content-Type-Options: nosniff",
                "Cache-Control: no-store",
                "Connection: close",
            ] {
                assert!(head.contains(field), "{field}: {head}");
            }
            assert!(!head.contains("unsafe") && !head.contains("Access-Control"), "{head}");
            let length = head.lines().find_map(|line| line.strip_prefix("Content-Length: "));
            let length = length.map(|length| length.parse::<usize>().unwrap());
            assert!(length.is_none_or(|length| length == body.len()), "{head}");
        }
        let text = String::from_utf8(refusal).unwrap();
        assert!(text.starts_with("HTTP/1.1 405 Method Not Allowed\r\n"), "{text}");
        assert!(
            text.contains("Allow: GET, POST") && text.ends_with("405 Method Not Allowed: no\n")
        );
        assert_eq!(event("now", "{}"), b"event: now\ndata: {}\n\n");
    }
}
