//! The part of HTTP/1.1 that a page on the same machine needs: one request per connection, with limits on everything.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Largest header of a request, bytes.
const MAX_HEAD: usize = 8 << 10;
/// Largest body of a request, bytes.
const MAX_BODY: usize = 4 << 10;
/// Largest number of header fields of a request.
const MAX_FIELDS: usize = 64;
/// Time from the connection within which a request must be complete, or it is dropped.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time within which an answer must be read, or it is dropped.
const TAKEN: Duration = Duration::from_secs(10);

/// A request of a page.
#[derive(Debug)]
pub(crate) struct Request {
    /// Whether the method is POST; otherwise it is GET.
    pub is_post: bool,
    /// Path without the query.
    pub path: String,
    query: String,
    fields: Vec<(String, String)>,
    /// Body of the request.
    pub body: Vec<u8>,
}

impl Request {
    /// Returns a header field, if it is given; an error if it is given more than once.
    pub(crate) fn field(&self, name: &str) -> Result<Option<&str>, Answer> {
        let mut all = self.fields.iter().filter(|(n, _)| n.eq_ignore_ascii_case(name)).map(|(_, v)| v.as_str());
        match (all.next(), all.next()) {
            (_, Some(_)) => Err(Answer::refused(400, "a header field is given twice")),
            (first, None) => Ok(first),
        }
    }

    /// Returns a value of the query. The page sends nothing that needs escaping, so no escapes are decoded.
    pub(crate) fn query_value(&self, name: &str) -> Option<&str> {
        self.query.split('&').filter_map(|part| part.split_once('=')).find(|(n, _)| *n == name).map(|(_, v)| v)
    }
}

/// The answer to a request.
#[derive(Debug)]
pub(crate) struct Answer {
    status: u16,
    kind: &'static str,
    fields: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Answer {
    /// Creates an answer with a document of this media type.
    pub(crate) fn new(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status: 200, kind, fields: Vec::new(), body: body.into() }
    }

    /// Creates an answer with JSON data.
    pub(crate) fn json(value: &serde_json::Value) -> Self {
        Self::new("application/json", value.to_string())
    }

    /// Creates an answer without content: there is nothing new.
    pub(crate) fn nothing() -> Self {
        Self { status: 204, ..Self::new("text/plain; charset=utf-8", "") }
    }

    /// Creates an answer that redirects to another path.
    pub(crate) fn see(place: &str) -> Self {
        Self { status: 303, ..Self::new("text/plain; charset=utf-8", "") }.with("Location", place.to_owned())
    }

    /// Creates an answer that refuses the request, with the status and the reason.
    pub(crate) fn refused(status: u16, why: &str) -> Self {
        Self { status, ..Self::new("text/plain; charset=utf-8", format!("{why}\n")) }
    }

    /// Adds a header field to the answer.
    pub(crate) fn with(mut self, name: &'static str, value: String) -> Self {
        self.fields.push((name, value));
        self
    }

    /// Sends the answer.
    pub(crate) fn send(&self, stream: &mut TcpStream) -> io::Result<()> {
        let reason = match self.status {
            200 => "OK",
            204 => "No Content",
            303 => "See Other",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            408 => "Request Timeout",
            409 => "Conflict",
            413 => "Content Too Large",
            431 => "Request Header Fields Too Large",
            501 => "Not Implemented",
            503 => "Service Unavailable",
            _ => "Bad Request",
        };
        let mut head = format!(
            "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
             connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nReferrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n",
            self.status,
            self.kind,
            self.body.len()
        );
        for (name, value) in &self.fields {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head.push_str("\r\n");
        stream.set_write_timeout(Some(TAKEN))?;
        // Header and body are sent together; a separate body would wait for the other side to acknowledge the header.
        stream.set_nodelay(true)?;
        let mut all = head.into_bytes();
        all.extend_from_slice(&self.body);
        stream.write_all(&all)?;
        stream.flush()
    }
}

/// Reads a request. The error is the answer to a bad request, or `None` if the connection sent nothing.
pub(crate) fn read(stream: &mut TcpStream) -> Result<Request, Option<Answer>> {
    let end = Instant::now() + PATIENCE;
    let mut bytes: Vec<u8> = Vec::new();
    let mut more = |bytes: &mut Vec<u8>| -> Result<(), Option<Answer>> {
        let late = || if bytes.is_empty() { None } else { Some(Answer::refused(408, "the request took too long")) };
        let left = end.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()).ok_or_else(late)?;
        let mut some = [0; 2048];
        let read = stream.set_read_timeout(Some(left)).and_then(|()| stream.read(&mut some));
        match read {
            Ok(0) => Err(None),
            Ok(count) => {
                bytes.extend(&some[..count]);
                Ok(())
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(()),
            Err(_) => Err(late()),
        }
    };
    let (mut request, head) = loop {
        let mut fields = [httparse::EMPTY_HEADER; MAX_FIELDS];
        let mut parsed = httparse::Request::new(&mut fields);
        match parsed.parse(&bytes) {
            Ok(httparse::Status::Complete(head)) if head <= MAX_HEAD => break (taken(&parsed)?, head),
            Ok(httparse::Status::Partial) if bytes.len() < MAX_HEAD => more(&mut bytes)?,
            Ok(_) | Err(httparse::Error::TooManyHeaders) => {
                return Err(Some(Answer::refused(431, "the header of the request is too large")));
            }
            Err(_) => return Err(Some(Answer::refused(400, "this is not an HTTP request"))),
        }
    };
    if request.field("Transfer-Encoding").map_err(Some)?.is_some() {
        return Err(Some(Answer::refused(501, "a body must be sent whole, with its length")));
    }
    let length = match request.field("Content-Length").map_err(Some)? {
        None => 0,
        Some(text) if !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit()) => {
            text.parse().unwrap_or(usize::MAX)
        }
        Some(_) => return Err(Some(Answer::refused(400, "the length of the body is not a number"))),
    };
    if length > MAX_BODY {
        return Err(Some(Answer::refused(413, "the body of the request is too large")));
    }
    while bytes.len() < head + length {
        more(&mut bytes)?;
    }
    request.body = bytes[head..head + length].to_vec();
    Ok(request)
}

fn taken(parsed: &httparse::Request<'_, '_>) -> Result<Request, Option<Answer>> {
    let is_post = match parsed.method {
        Some("GET") => false,
        Some("POST") => true,
        _ => return Err(Some(Answer::refused(405, "only GET and POST are answered"))),
    };
    let target = parsed.path.unwrap_or_default();
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let mut fields = Vec::new();
    for field in parsed.headers.iter() {
        let Ok(value) = std::str::from_utf8(field.value) else {
            return Err(Some(Answer::refused(400, "the header of the request is not text")));
        };
        fields.push((field.name.to_owned(), value.to_owned()));
    }
    Ok(Request { is_post, path: path.to_owned(), query: query.to_owned(), fields, body: Vec::new() })
}
