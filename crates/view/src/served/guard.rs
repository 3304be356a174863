//! Access control: only a page that this server served, in a browser that was given the token, may send requests.

use super::http::{Answer, Request};
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};

/// Returns 128 random bits as 32 hexadecimal digits.
fn secret() -> std::io::Result<String> {
    let mut bytes = [0_u8; 16];
    getrandom::fill(&mut bytes).map_err(std::io::Error::other)?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

/// Returns whether two texts are equal, in a time that does not reveal where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |sum, (a, b)| sum | (a ^ b)) == 0
}

/// The access control of a server: its address, a token that works once, and the cookie for which the token is exchanged.
pub(crate) struct Guard {
    host: String,
    token: String,
    is_spent: AtomicBool,
    cookie: String,
}

impl Guard {
    /// Creates the access control for a server at `host`, which is address and port.
    pub(crate) fn new(host: String) -> std::io::Result<Self> {
        Ok(Self { host, token: secret()?, is_spent: AtomicBool::new(false), cookie: secret()? })
    }

    /// URL that a person opens, with the token.
    pub(crate) fn address(&self) -> String {
        format!("http://{}/?token={}", self.host, self.token)
    }

    /// Returns the name of the cookie. It contains the port, because browsers share cookies between ports, and another `spectra view` must
    /// not overwrite it.
    fn cookie_name(&self) -> String {
        format!("spectra-{}", self.host.rsplit(':').next().unwrap_or_default())
    }

    /// Checks a request: `Ok` if it may pass, otherwise its answer.
    pub(crate) fn look(&self, request: &Request) -> Result<(), Answer> {
        let forbidden = |why| Err(Answer::refused(403, why));
        if request.field("Host")? != Some(self.host.as_str()) {
            return forbidden("this server has a different name");
        }
        match request.field("Origin")? {
            None if !request.is_post => {}
            Some(origin) if origin.strip_prefix("http://") == Some(self.host.as_str()) => {}
            _ => return forbidden("only the page of this server may send requests"),
        }
        if let Some(site) = request.field("Sec-Fetch-Site")?
            && !matches!(site, "same-origin" | "none")
        {
            return forbidden("only the page of this server may send requests");
        }
        let name = self.cookie_name();
        let cookies = request.field("Cookie")?.unwrap_or_default();
        let has_cookie = cookies.split(';').filter_map(|part| part.trim().split_once('='));
        if has_cookie.into_iter().any(|(n, value)| n == name && same(value, &self.cookie)) {
            return Ok(());
        }
        let is_door = !request.is_post && request.path == "/";
        if is_door && request.query_value("token").is_some_and(|token| same(token, &self.token)) {
            if self.is_spent.swap(true, SeqCst) {
                return forbidden(
                    "this address was already used; open it in the same browser, or start `spectra view` again",
                );
            }
            let cookie = format!("{name}={}; HttpOnly; SameSite=Strict; Path=/", self.cookie);
            return Err(Answer::see("/").with("Set-Cookie", cookie));
        }
        forbidden("open the address that `spectra view` printed")
    }
}
