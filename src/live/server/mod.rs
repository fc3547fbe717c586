//! A page for one program: its assets, images, and a WebSocket over which it sees frames and sends what it wants.
//!
//! Who may ask: those who know the token, which is the first part of every path; from an address that is this machine, unless
//! the program listens elsewhere on purpose; and not from pages of others, which is what `Host` and `Origin` say
//! (RFC 6455 §10.2). Everything else is answered as if nothing were there.

mod access;
mod socket;
#[cfg(test)]
mod tests;

use std::{
    io,
    net::{SocketAddr, TcpListener},
    sync::Arc,
    thread,
    time::Duration,
};

use axum::{
    Router,
    body::Body,
    extract::{FromRequestParts, Request, State, WebSocketUpgrade},
    http::{HeaderName, HeaderValue, Method, StatusCode, header, request::Parts},
    response::{IntoResponse, Response},
    serve::Listener,
};
use hyper::server::conn::http1;
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use tokio::sync::{Semaphore, mpsc, oneshot, watch};

use crate::frame::Frame;
use access::Access;

/// A file of the page.
#[derive(Clone, Copy, Debug)]
pub struct Asset {
    /// Its name; empty for the page itself.
    pub name: &'static str,
    /// Media type.
    pub kind: &'static str,
    /// Its content.
    pub text: &'static str,
}

/// What all pages see.
#[derive(Clone, Debug, Default)]
struct Shown {
    frame: Arc<Frame>,
    /// Each is sent when it is another one than before.
    documents: Vec<Arc<str>>,
}

/// Where what all pages see is put. Clones are the same place.
#[derive(Clone, Debug, Default)]
pub struct Stage(watch::Sender<Shown>);

impl Stage {
    /// Shows an image.
    pub fn show_frame(&self, frame: Arc<Frame>) {
        self.0.send_modify(|shown| shown.frame = frame);
    }

    /// Shows documents, each of which pages get if it is another one than before.
    pub fn show_documents(&self, documents: Vec<Arc<str>>) {
        self.0.send_modify(|shown| shown.documents = documents);
    }
}

/// Sends a text to the page that asked for it. A page that reads too slowly misses it.
#[derive(Clone, Debug)]
pub struct Reply(mpsc::Sender<String>);

impl Reply {
    /// Sends it.
    pub fn send(&self, text: String) {
        // A page that is gone wants no answer.
        let _ = self.0.try_send(text);
    }
}

/// What stands behind the page.
pub trait Program: Send + Sync + 'static {
    /// A page sent this text. Must not take long. Returns whether it was taken; otherwise the page is dropped.
    fn command(&self, text: String, reply: Reply) -> bool;

    /// The image of a name that a page asks for. May take its time.
    fn image(&self, name: &str) -> Option<Arc<Frame>>;
}

/// How to serve.
#[derive(Clone, Debug)]
pub struct Options {
    /// Where to listen; port 0 is any that is free.
    pub address: SocketAddr,
    /// The secret.
    pub token: String,
    /// Most pages at once.
    pub pages: usize,
    /// How long a connection may take to say what it wants, and a page to read a message; then it is closed. Six times as
    /// long one lives that is no page's.
    pub patience: Duration,
}

/// Most connections at once that are not those of pages: each takes a descriptor, of which others need some. More wait.
const CONNECTIONS: usize = 128;

/// Patiences after which a connection ends that became no page: who reads an image slowly must not hold its place for ever.
const READING: u32 = 6;

/// A server at work; it ends when dropped.
#[derive(Debug)]
pub struct Server {
    address: SocketAddr,
    token: String,
    _end: oneshot::Sender<()>,
}

impl Server {
    /// Begins to serve `assets`, and what is on `stage`, on a thread of its own.
    ///
    /// # Errors
    /// The address is taken or not of this machine, or the thread cannot be started.
    pub fn start(
        options: Options,
        assets: &'static [Asset],
        stage: &Stage,
        program: Arc<dyn Program>,
    ) -> io::Result<Self> {
        let listener = TcpListener::bind(options.address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let (end, ended) = oneshot::channel();
        let access = Access { token: options.token.clone(), address };
        let pages = Arc::new(Semaphore::new(options.pages));
        let room = Arc::new(Room {
            access,
            assets,
            shown: stage.0.subscribe(),
            program,
            pages,
            most_pages: options.pages,
            patience: options.patience,
        });
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        thread::Builder::new().name("server".into()).spawn(move || {
            runtime.block_on(async {
                tokio::select! {
                    _ = serve(listener, room) => {}
                    _ = ended => {}
                }
            });
            // What still waits for a page or for the program is dropped.
            runtime.shutdown_background();
        })?;
        Ok(Self { address, token: options.token, _end: end })
    }

    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The address of the page for a browser on this machine, with the token.
    pub fn url(&self) -> String {
        let mut address = self.address;
        if address.ip().is_unspecified() {
            address.set_ip(if address.is_ipv4() {
                [127, 0, 0, 1].into()
            } else {
                [0, 0, 0, 0, 0, 0, 0, 1].into()
            });
        }
        format!("http://{address}/{}/", self.token)
    }
}

struct Room {
    access: Access,
    assets: &'static [Asset],
    shown: watch::Receiver<Shown>,
    program: Arc<dyn Program>,
    pages: Arc<Semaphore>,
    most_pages: usize,
    patience: Duration,
}

async fn serve(listener: TcpListener, room: Arc<Room>) -> io::Result<()> {
    let mut listener = tokio::net::TcpListener::from_std(listener)?;
    let patience = room.patience;
    let router = Router::new().fallback(answer).with_state(room);
    let places = Arc::new(Semaphore::new(CONNECTIONS));
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(patience);
    while let Ok(place) = Arc::clone(&places).acquire_owned().await {
        // axum's, which goes on when the system refuses.
        let (stream, _) = Listener::accept(&mut listener).await;
        // Small messages must not wait for others. A system that refuses still works.
        let _ = stream.set_nodelay(true);
        let service = TowerToHyperService::new(router.clone());
        let connection = http.serve_connection(TokioIo::new(stream), service).with_upgrades();
        tokio::spawn(async move {
            // One that breaks off is no loss. It ends here where it becomes a WebSocket.
            let _ = tokio::time::timeout(READING * patience, connection).await;
            drop(place);
        });
    }
    Ok(())
}

async fn answer(State(room): State<Arc<Room>>, request: Request) -> Response {
    let (mut parts, _) = request.into_parts();
    let mut response = match room.access.check(&parts) {
        Err(status) => status.into_response(),
        Ok(path) => dispatch(&room, &path, &mut parts).await,
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name.clone(), HeaderValue::from_static(value));
    }
    response
}

async fn dispatch(room: &Arc<Room>, path: &str, parts: &mut Parts) -> Response {
    if parts.method != Method::GET {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    if path == "socket" {
        return open_socket(room, parts).await;
    }
    if let Some(name) = path.strip_prefix("image/") {
        return image(room, name.to_owned()).await;
    }
    match room.assets.iter().find(|asset| asset.name == path) {
        Some(asset) => ([(header::CONTENT_TYPE, asset.kind)], asset.text).into_response(),
        None => StatusCode::NOT_FOUND.into_response(),
    }
}

async fn open_socket(room: &Arc<Room>, parts: &mut Parts) -> Response {
    if !room.access.is_own_page(parts) {
        return StatusCode::FORBIDDEN.into_response();
    }
    // Also for who does not ask for a WebSocket: scripts cannot read why they did not get one, but this.
    let Ok(place) = Arc::clone(&room.pages).try_acquire_owned() else {
        let why = format!("{} pages are open, no more can be: close one", room.most_pages);
        return (StatusCode::SERVICE_UNAVAILABLE, why).into_response();
    };
    let upgrade = match WebSocketUpgrade::from_request_parts(parts, &()).await {
        Ok(upgrade) => upgrade,
        Err(refused) => return refused.into_response(),
    };
    let (patience, shown, program) = (room.patience, room.shown.clone(), Arc::clone(&room.program));
    socket::limited(upgrade).on_upgrade(async move |socket| {
        socket::converse(socket, patience, shown, program).await;
        drop(place);
    })
}

async fn image(room: &Arc<Room>, name: String) -> Response {
    let program = Arc::clone(&room.program);
    let found = tokio::task::spawn_blocking(move || program.image(&name)).await;
    match found {
        Ok(Some(frame)) => {
            let bytes: Vec<u8> = socket::messages(&frame, None, usize::MAX).flatten().collect();
            ([(header::CONTENT_TYPE, "application/octet-stream")], Body::from(bytes)).into_response()
        }
        Ok(None) => StatusCode::NOT_FOUND.into_response(),
        Err(_) => StatusCode::INTERNAL_SERVER_ERROR.into_response(),
    }
}

/// The page may load what is its own and nothing else, and nobody may look at it from outside.
const HEADERS: [(HeaderName, &str); 6] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];
