//! The little of HTTP/1.1 that a page on the same machine needs: one request a connection, everything bounded.

use std::io::{self, ErrorKind, Read, Write};

/// Most bytes of the request line and headers together; browsers send about one thousand.
const MAX_HEAD: usize = 16 << 10;
/// Most bytes of a body: requests carry a word, or a vertex and three numbers.
const MAX_BODY: usize = 128;

/// What a connection asks for.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Request {
    pub(super) is_post: bool,
    /// What stands before the question mark, as it was sent: nothing here is decoded.
    pub(super) path: String,
    /// What stands behind it.
    pub(super) query: String,
    pub(super) host: String,
    pub(super) origin: Option<String>,
    /// Where the browser says the request comes from (`Sec-Fetch-Site`).
    pub(super) site: Option<String>,
    pub(super) token: Option<String>,
    pub(super) body: Vec<u8>,
}

impl Request {
    /// A whole number in the query.
    pub(super) fn number(&self, key: &str) -> Option<usize> {
        let pairs = self.query.split('&');
        let value = pairs
            .filter_map(|pair| pair.split_once('='))
            .find(|(name, _)| *name == key)?
            .1;
        parse_number(value)
    }
}

/// A whole number of digits alone: `usize` would also take a sign.
pub(super) fn parse_number(text: &str) -> Option<usize> {
    let is_plain = text.len() <= 15 && text.bytes().all(|byte| byte.is_ascii_digit());
    is_plain.then(|| text.parse().ok()).flatten()
}

/// What is sent back.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) status: u16,
    pub(super) content_type: &'static str,
    pub(super) body: Vec<u8>,
}

impl Answer {
    pub(super) fn new(content_type: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self {
            status: 200,
            content_type,
            body: body.into(),
        }
    }

    pub(super) fn json(value: &impl serde::Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(body) => Self::new("application/json", body),
            Err(error) => Self::error(500, &error.to_string()),
        }
    }

    /// Numbers in the byte order of the page's machine, which is this one: all that browsers run on are little-endian.
    pub(super) fn binary(body: Vec<u8>) -> Self {
        Self::new("application/octet-stream", body)
    }

    /// What went wrong, in words that the page shows.
    pub(super) fn error(status: u16, message: &str) -> Self {
        let body = serde_json::json!({ "error": message }).to_string();
        Self {
            status,
            content_type: "application/json",
            body: body.into(),
        }
    }

    /// Writes status, headers and body.
    pub(super) fn write(&self, stream: &mut impl Write) -> io::Result<()> {
        let (status, kind, length) = (self.status, self.content_type, self.body.len());
        let reason = reason(status);
        let head = format!(
            "HTTP/1.1 {status} {reason}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\
             {SAFETY}\r\n"
        );
        stream.write_all(head.as_bytes())?;
        stream.write_all(&self.body)?;
        stream.flush()
    }
}

/// The page loads nothing from elsewhere, is shown in no other page, and no other page may read what it gets.
const SAFETY: &str = "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\
    Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\n\
    Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
    connect-src 'self'; img-src 'self' data: blob:; media-src blob:; base-uri 'none'; form-action 'none'; \
    frame-ancestors 'none'\r\n";

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        408 => "Request Timeout",
        409 => "Conflict",
        413 => "Content Too Large",
        431 => "Request Header Fields Too Large",
        503 => "Service Unavailable",
        _ => "Internal Server Error",
    }
}

/// Reads a request.
///
/// # Errors
/// What to answer to something that is none, is too long or does not come; nothing where the other side went away.
pub(super) fn read_request(stream: &mut impl Read) -> Result<Request, Option<Answer>> {
    let refuse = |status, message: &str| Some(Answer::error(status, message));
    let (head, mut body) = read_head(stream)?;
    let head = String::from_utf8(head).map_err(|_| refuse(400, "headers that are no text"))?;
    let mut lines = head.split("\r\n");
    let line = lines.next().unwrap_or_default();
    let words: Vec<&str> = line.split(' ').collect();
    let [method, target, "HTTP/1.1" | "HTTP/1.0"] = words[..] else {
        return Err(refuse(400, "this is no HTTP request"));
    };
    if method != "GET" && method != "POST" {
        return Err(refuse(405, "only GET and POST are known here"));
    }
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let mut request = Request {
        is_post: method == "POST",
        path: path.to_owned(),
        query: query.to_owned(),
        ..Request::default()
    };
    let mut length = 0;
    for line in lines {
        let (name, value) =
            (line.split_once(':')).ok_or_else(|| refuse(400, "a header without a colon"))?;
        let value = value.trim().to_owned();
        match name.to_ascii_lowercase().as_str() {
            "host" if request.host.is_empty() => request.host = value,
            // Two could be read differently by two readers.
            "host" => return Err(refuse(400, "more than one Host")),
            "origin" => request.origin = Some(value),
            "sec-fetch-site" => request.site = Some(value),
            "x-koiter-token" => request.token = Some(value),
            "content-length" => {
                length = parse_number(&value).ok_or_else(|| refuse(400, "a wrong length"))?;
            }
            "transfer-encoding" => return Err(refuse(400, "bodies come whole here")),
            _ => {}
        }
    }
    if length > MAX_BODY || body.len() > length {
        return Err(refuse(413, "bodies are one word here"));
    }
    let missing = (length - body.len()) as u64;
    let read = stream.take(missing).read_to_end(&mut body);
    if read.map_err(|error| late(&error))? as u64 != missing {
        return Err(None);
    }
    request.body = body;
    Ok(request)
}

/// The bytes before the empty line, and those behind it that came with them.
fn read_head(stream: &mut impl Read) -> Result<(Vec<u8>, Vec<u8>), Option<Answer>> {
    const END: &[u8] = b"\r\n\r\n";
    let mut bytes = Vec::new();
    let mut chunk = [0; 2048];
    loop {
        let count = stream.read(&mut chunk).map_err(|error| late(&error))?;
        if count == 0 {
            return Err(None);
        }
        bytes.extend(&chunk[..count]);
        if let Some(end) = bytes.windows(END.len()).position(|window| window == END) {
            let rest = bytes.split_off(end + END.len());
            bytes.truncate(end);
            return Ok((bytes, rest));
        }
        if bytes.len() > MAX_HEAD {
            return Err(Some(Answer::error(431, "the headers are too long")));
        }
    }
}

/// The answer where nothing comes in time.
fn late(error: &io::Error) -> Option<Answer> {
    let is_late = matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut);
    is_late.then(|| Answer::error(408, "the request did not come in time"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(text: &str) -> Option<u16> {
        let error = read_request(&mut text.as_bytes()).unwrap_err();
        error.map(|answer| answer.status)
    }

    #[test]
    fn a_request_is_taken_apart_and_nothing_is_decoded() {
        let text = "POST /a/%2e%2e?field=3&x=-1 HTTP/1.1\r\nhOST: a:1\r\nOrigin: b\r\nX-Koiter-Token: t\r\nContent-Length: 4\r\n\r\nstop";
        let request = read_request(&mut text.as_bytes()).unwrap();
        assert!(request.is_post);
        assert_eq!((&*request.path, &*request.host), ("/a/%2e%2e", "a:1"));
        assert_eq!(request.origin.as_deref(), Some("b"));
        assert_eq!(
            (request.token.as_deref(), &*request.body),
            (Some("t"), &b"stop"[..])
        );
        assert_eq!(
            (request.number("field"), request.number("x")),
            (Some(3), None)
        );
        assert_eq!(request.number("none"), None);
    }

    #[test]
    fn garbage_is_refused_by_what_is_wrong_with_it() {
        assert_eq!(status("\r\n\r\n"), Some(400));
        assert_eq!(status("hello\r\n\r\n"), Some(400));
        assert_eq!(status("GET / HTTP/2\r\n\r\n"), Some(400));
        assert_eq!(status("DELETE / HTTP/1.1\r\n\r\n"), Some(405));
        assert_eq!(status("GET / HTTP/1.1\r\nnonsense\r\n\r\n"), Some(400));
        assert_eq!(
            status("GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n"),
            Some(400)
        );
        let length = |text: &str| status(&format!("POST / HTTP/1.1\r\n{text}\r\n\r\n"));
        assert_eq!(length("Content-Length: -1"), Some(400));
        assert_eq!(length("Content-Length: 99999999999999999999"), Some(400));
        assert_eq!(length("Content-Length: 129"), Some(413));
        assert_eq!(length("Transfer-Encoding: chunked"), Some(400));
        assert_eq!(status(&"x".repeat(MAX_HEAD + 4096)), Some(431));
    }

    #[test]
    fn who_goes_away_gets_no_answer() {
        assert_eq!(status(""), None);
        assert_eq!(status("GET / HT"), None);
        assert_eq!(
            status("POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\nsto"),
            None
        );
    }
}
