//! The server: it listens on the loopback address, serves the page, and passes the page's requests to its desk.

use super::guard::Guard;
use super::http::{self, Answer, Request};
use super::page_session::PageSession;
use super::render_job::RenderJob;
use super::{bench, choices, study, tester};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io;
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Largest number of connections at a time. If there are more, the oldest one that has not sent its request yet is closed; if there is
/// none, the new one is refused.
const MAX_CONNECTIONS: usize = 64;
/// Longest time that the server waits for a connection that it closes to make room; until then new connections queue in the system.
const CLOSING: Duration = Duration::from_secs(1);
/// Largest number of pages at a time; the one opened first is closed to make room.
const MAX_DESKS: usize = 4;
/// Longest time that a request for a picture waits; after that the page asks again.
const WAIT: Duration = Duration::from_secs(10);

const STUDY: &str = include_str!("../../page/study.html");
const STUDY_SCRIPT: &str = include_str!("../../page/study.js");
const TESTER: &str = include_str!("../../page/tester.html");
const TESTER_SCRIPT: &str = include_str!("../../page/tester.js");
const PAGE: &str = include_str!("../../page/index.html");
const SCRIPT: &str = include_str!("../../page/page.js");
const STYLE: &str = include_str!("../../page/page.css");

/// A server that has opened its port.
pub(crate) struct Server {
    listener: TcpListener,
    guard: Guard,
    /// Scene to show; `None` if only the color tester is served.
    order: Option<RenderJob>,
    desks: Mutex<(u64, BTreeMap<u64, Arc<PageSession>>)>,
    connections: Connections,
    /// Connections whose request has not arrived yet, by number, the oldest first. A page sends its request at once, so a connection that
    /// stays here for long takes a place that others need.
    silent: Mutex<BTreeMap<u64, TcpStream>>,
}

/// Number of open connections.
#[derive(Default)]
struct Connections {
    count: Mutex<usize>,
    one_ended: Condvar,
}

impl Connections {
    fn count(&self) -> MutexGuard<'_, usize> {
        self.count.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits up to [`CLOSING`] until there is room for one more connection; returns whether there is.
    fn have_room(&self) -> bool {
        let waited = self.one_ended.wait_timeout_while(self.count(), CLOSING, |count| *count >= MAX_CONNECTIONS);
        *waited.unwrap_or_else(PoisonError::into_inner).0 < MAX_CONNECTIONS
    }

    fn ended(&self) {
        *self.count() -= 1;
        self.one_ended.notify_all();
    }
}

/// Counts a connection as open until it is dropped.
struct Counted<'a>(&'a Connections);

impl Drop for Counted<'_> {
    fn drop(&mut self) {
        self.0.ended();
    }
}

impl Server {
    /// Opens a port on this machine's loopback address; 0 takes a free one.
    pub(crate) fn bind(port: u16, order: Option<RenderJob>) -> io::Result<Self> {
        let listener = TcpListener::bind(("127.0.0.1", port))?;
        let guard = Guard::new(listener.local_addr()?.to_string())?;
        Ok(Self {
            listener,
            guard,
            order,
            desks: Mutex::default(),
            connections: Connections::default(),
            silent: Mutex::default(),
        })
    }

    /// URL that a person opens, with the token.
    pub(crate) fn address(&self) -> String {
        self.guard.address()
    }

    /// Answers requests until the process ends, or returns the error that ends the server.
    pub(crate) fn serve(self) -> io::Error {
        let server = Arc::new(self);
        let mut number = 0_u64;
        loop {
            number += 1;
            let mut stream = match server.listener.accept() {
                Ok((stream, _)) => stream,
                // The connection ended before it was accepted, or there is no room for one. Neither ends the server.
                Err(_) => {
                    std::thread::sleep(Duration::from_millis(10));
                    continue;
                }
            };
            if !server.makes_room() {
                let _ = stream.set_nonblocking(true);
                let _ = Answer::refused(503, "too many connections").send(&mut stream);
                continue;
            }
            *server.connections.count() += 1;
            // If the stream cannot be cloned, the connection cannot be closed from here, and ends by its timeout.
            if let Ok(held) = stream.try_clone() {
                server.silent().insert(number, held);
            }
            let own = Arc::clone(&server);
            let thread = std::thread::Builder::new().name("request".to_owned());
            let spawned = thread.spawn(move || {
                let _counted = Counted(&own.connections);
                own.answer(number, &mut stream);
            });
            if let Err(error) = spawned {
                // The closure was dropped, and the connection with it.
                server.silent().remove(&number);
                server.connections.ended();
                if error.kind() != io::ErrorKind::WouldBlock {
                    return error;
                }
            }
        }
    }

    fn silent(&self) -> MutexGuard<'_, BTreeMap<u64, TcpStream>> {
        self.silent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether there is room for one more connection. If there is none, closes the connection that has been silent for
    /// longest and waits until it has ended. The wait gives the threads of other connections time to read a request that has just
    /// come, however fast further connections arrive.
    fn makes_room(&self) -> bool {
        if *self.connections.count() < MAX_CONNECTIONS {
            return true;
        }
        let oldest = self.silent().pop_first();
        oldest.is_some_and(|(_, stream)| {
            // A connection that has already ended makes room as well.
            let _ = stream.shutdown(Shutdown::Both);
            self.connections.have_room()
        })
    }

    fn answer(&self, number: u64, stream: &mut TcpStream) {
        let request = http::read(stream);
        self.silent().remove(&number);
        let answer = match request {
            Ok(request) => {
                self.guard.look(&request).and_then(|()| self.asked(&request)).unwrap_or_else(|refused| refused)
            }
            Err(Some(refused)) => refused,
            Err(None) => return,
        };
        // If the other side has gone, no answer is needed.
        let _ = answer.send(stream);
        let _ = stream.shutdown(Shutdown::Write);
    }

    fn asked(&self, request: &Request) -> Result<Answer, Answer> {
        let sent = || -> Result<Value, Answer> {
            serde_json::from_slice(&request.body).map_err(|_| Answer::refused(400, "the body is not JSON"))
        };
        match (request.is_post, request.path.as_str()) {
            (false, "/") if self.order.is_some() => Ok(Answer::new("text/html; charset=utf-8", PAGE)),
            (false, "/" | "/tester") => Ok(Answer::new("text/html; charset=utf-8", TESTER)),
            (false, "/tester.js") => Ok(Answer::new("text/javascript; charset=utf-8", TESTER_SCRIPT)),
            (false, "/study") => Ok(Answer::new("text/html; charset=utf-8", STUDY)),
            (false, "/study.js") => Ok(Answer::new("text/javascript; charset=utf-8", STUDY_SCRIPT)),
            (false, "/choices") => {
                let mut choices = study::choices();
                choices["start"] = self.order.as_ref().and_then(bench::start).into();
                Ok(Answer::json(&choices))
            }
            (true, "/keep") => {
                let order = self.order.as_ref().ok_or_else(|| Answer::refused(404, "no scene is viewed"))?;
                let refused = |why: String| Answer::refused(400, &why);
                let prism = study::Prism::of(|name| request.query_value(name).map(str::to_owned)).map_err(refused)?;
                let kept = bench::keep(order, &prism, request.query_value("text").unwrap_or_default());
                kept.map(|kept| Answer::json(&kept)).map_err(|why| Answer::refused(409, &why))
            }
            (false, "/prism" | "/rays") => {
                let refused = |why: String| Answer::refused(400, &why);
                let prism = study::Prism::of(|name| request.query_value(name).map(str::to_owned)).map_err(refused)?;
                let answer = if request.path == "/prism" {
                    prism.shown()
                } else {
                    let at = |name| number(request, name).map(|v| usize::try_from(v).unwrap_or(usize::MAX));
                    prism.traced(at("first")?, at("count")?)
                };
                Ok(Answer::json(&answer.map_err(refused)?))
            }
            (false, "/diagram") => Ok(Answer::json(&tester::diagram())),
            (false, "/color") => {
                let asked = tester::LightRequest::of(|name| request.query_value(name).map(str::to_owned));
                Ok(Answer::json(&tester::color(&asked.map_err(|why| Answer::refused(400, &why))?)))
            }
            (false, "/page.js") => Ok(Answer::new("text/javascript; charset=utf-8", SCRIPT)),
            (false, "/page.css") => Ok(Answer::new("text/css; charset=utf-8", STYLE)),
            // An empty body opens the scene with which the viewer was started.
            (true, "/open") if request.body.is_empty() => self.open(None),
            (true, "/open") => {
                let sent = sent()?;
                let name = sent["name"].as_str().ok_or_else(|| Answer::refused(400, "the name is missing"))?;
                self.open(Some((name, sent["bundled"] == true)))
            }
            (false, "/openable") => Ok(Answer::json(&choices::listed(self.order()?))),
            (false, "/command") => {
                let command = self.desk(request)?.command();
                command
                    .map(|command| Answer::json(&json!({"command": command})))
                    .ok_or_else(|| Answer::refused(404, "no scene yet"))
            }
            (false, "/scene") => match self.desk(request)?.text() {
                Some(Ok(text)) => Ok(Answer::new("text/yaml; charset=utf-8", text)),
                Some(Err(why)) => Err(Answer::refused(409, &why)),
                None => Err(Answer::refused(404, "no scene yet")),
            },
            (true, "/close") => {
                self.desk(request)?.close();
                Ok(Answer::nothing())
            }
            (true, "/turn") => {
                let desk = self.desk(request)?;
                let sent = sent()?;
                let path = sent["path"].as_str().ok_or_else(|| Answer::refused(400, "the path is missing"))?;
                let turn = desk.turn(path, &sent["value"]).map_err(|why| Answer::refused(400, &why))?;
                Ok(Answer::json(&json!({"turn": turn})))
            }
            (true, "/back") => Ok(Answer::json(&json!({"turn": self.desk(request)?.back()}))),
            (true, "/save") => match self.desk(request)?.save() {
                Ok(count) => Ok(Answer::json(&json!({"saved": count}))),
                Err(why) => Err(Answer::refused(409, &why)),
            },
            (false, "/frame") => {
                let desk = self.desk(request)?;
                let frame = desk.frame_after(number(request, "after")?, WAIT);
                desk.is_asked();
                Ok(frame.map_or_else(Answer::nothing, |f| Answer::new("application/octet-stream", f)))
            }
            (false, "/controls") => Ok(Answer::json(&self.desk(request)?.controls())),
            (false, "/spectra") => {
                let known = self.desk(request)?.spectra();
                known.map(|known| Answer::json(&known)).ok_or_else(|| Answer::refused(404, "no scene yet"))
            }
            (false, "/pixel") => {
                let at = |name| number(request, name).map(|v| u32::try_from(v).unwrap_or(u32::MAX));
                let pixel = self.desk(request)?.pixel(at("x")?, at("y")?);
                pixel.map(|pixel| Answer::json(&pixel)).ok_or_else(|| Answer::refused(404, "no such pixel"))
            }
            (false, "/section") => {
                let drawn = self.desk(request)?.section(request.query_value("ground") == Some("dark"));
                let drawn = drawn.filter(|svg| !svg.is_empty()).ok_or_else(|| Answer::refused(404, "no drawing"))?;
                Ok(Answer::new("image/svg+xml", drawn.as_bytes()))
            }
            _ => Err(Answer::refused(404, "there is nothing here")),
        }
    }

    /// Returns the desk that a request names, and records the request there.
    fn desk(&self, request: &Request) -> Result<Arc<PageSession>, Answer> {
        let desks = self.desks.lock().unwrap_or_else(PoisonError::into_inner);
        let desk = desks.1.get(&number(request, "desk")?).filter(|desk| !desk.is_closed());
        let desk = desk.ok_or_else(|| Answer::refused(404, "this page is closed: reload it"))?;
        desk.is_asked();
        Ok(Arc::clone(desk))
    }

    /// Returns the order with which the viewer was started.
    fn order(&self) -> Result<&RenderJob, Answer> {
        self.order.as_ref().ok_or_else(|| Answer::refused(404, "no scene is viewed"))
    }

    /// Opens a desk for a page, for the viewer's order or for `other`: a name from the list of choices, and whether it is a bundled scene.
    fn open(&self, other: Option<(&str, bool)>) -> Result<Answer, Answer> {
        let order = match other {
            None => self.order()?.clone(),
            Some((name, is_bundled)) => {
                choices::opened(self.order()?, name, is_bundled).map_err(|why| Answer::refused(400, &why))?
            }
        };
        let mut desks = self.desks.lock().unwrap_or_else(PoisonError::into_inner);
        desks.1.retain(|_, desk| !desk.is_closed());
        while desks.1.len() >= MAX_DESKS {
            let Some((_, oldest)) = desks.1.pop_first() else { break };
            oldest.close();
        }
        let desk = PageSession::open(order);
        let desk = desk.map_err(|error| Answer::refused(503, &format!("another page cannot be opened: {error}")))?;
        desks.0 += 1;
        let number = desks.0;
        desks.1.insert(number, desk);
        Ok(Answer::json(&json!({"desk": number})))
    }
}

fn number(request: &Request, name: &str) -> Result<u64, Answer> {
    let text = request.query_value(name).filter(|text| text.len() <= 19 && text.bytes().all(|b| b.is_ascii_digit()));
    text.and_then(|text| text.parse().ok()).ok_or_else(|| Answer::refused(400, &format!("`{name}` is not a number")))
}
