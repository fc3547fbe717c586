use std::{
    io::{Read, Write},
    net::TcpStream,
    sync::Mutex,
    time::Duration,
};

use super::*;

mod crowd;

const PATIENCE: Duration = Duration::from_millis(1500);
const TOKEN: &str = "0123456789abcdef0123456789abcdef";
const ASSETS: &[Asset] = &[
    Asset { name: "", kind: "text/html", text: "<title>page</title>" },
    Asset { name: "main.js", kind: "text/javascript", text: "// script" },
];

/// Takes every text but "no", and answers it.
#[derive(Default)]
struct Echo(Mutex<Vec<String>>);

impl Program for Echo {
    fn command(&self, text: String, reply: Reply) -> bool {
        reply.send(format!("heard {text}"));
        self.0.lock().unwrap().push(text.clone());
        text != "no"
    }

    fn image(&self, name: &str) -> Option<Arc<Frame>> {
        // The second is far more than the system keeps for one who does not read.
        let sides = [("1", 1), ("2", 2048)];
        let (_, side) = sides.into_iter().find(|(known, _)| *known == name)?;
        Some(Arc::new(Frame::new(side, side, &[[1.0, 0.5, 0.25]], None)))
    }
}

struct Bench {
    server: Server,
    stage: Stage,
}

impl Bench {
    fn new(pages: usize) -> Self {
        let (stage, address) = (Stage::default(), "127.0.0.1:0".parse().unwrap());
        let options = Options { address, token: TOKEN.into(), pages, patience: PATIENCE };
        let server = Server::start(options, ASSETS, &stage, Arc::new(Echo::default())).unwrap();
        Self { server, stage }
    }

    fn port(&self) -> u16 {
        self.server.address().port()
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.server.address()).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        stream
    }

    /// The whole answer to a request for `path` with these headers.
    fn ask(&self, path: &str, headers: &str) -> String {
        let mut stream = self.connect();
        write!(stream, "GET {path} HTTP/1.1\r\nConnection: close\r\n{headers}\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        String::from_utf8_lossy(&answer).into_owned()
    }

    /// The status of the answer to a request of a browser on this machine.
    fn status(&self, path: &str) -> u16 {
        status(&self.ask(path, &format!("Host: 127.0.0.1:{}\r\n", self.port())))
    }

    fn open(&self) -> Socket {
        self.open_from(&format!("http://127.0.0.1:{}", self.port())).unwrap()
    }

    /// A WebSocket of a page from there, or the status of the refusal.
    fn open_from(&self, origin: &str) -> Result<Socket, u16> {
        let mut stream = self.connect();
        let port = self.port();
        let headers = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
            Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
        let from = if origin.is_empty() { String::new() } else { format!("Origin: {origin}\r\n") };
        write!(stream, "GET /{TOKEN}/socket HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n{headers}{from}\r\n")
            .unwrap();
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            head.push(byte[0]);
        }
        match status(&String::from_utf8_lossy(&head)) {
            101 => Ok(Socket(stream)),
            other => Err(other),
        }
    }
}

fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).unwrap().parse().unwrap()
}

/// A WebSocket as RFC 6455 §5.2 says it.
struct Socket(TcpStream);

impl Socket {
    fn send(&mut self, first: u8, payload: &[u8]) {
        let mut frame = vec![first];
        match payload.len() {
            n @ 0..126 => frame.push(0x80 | n as u8),
            n @ 126..65536 => frame.extend([&[0xfe][..], &(n as u16).to_be_bytes()].concat()),
            n => frame.extend([&[0xff][..], &(n as u64).to_be_bytes()].concat()),
        }
        // The mask is all zeros, which leaves the payload as it is.
        frame.extend([0; 4]);
        frame.extend(payload);
        // It may be closed already.
        let _ = self.0.write_all(&frame);
    }

    fn say(&mut self, text: &str) {
        self.send(0x81, text.as_bytes());
    }

    /// The next message with its kind; `None` once the connection is over.
    fn next(&mut self) -> Option<(u8, Vec<u8>)> {
        let mut head = [0; 2];
        self.0.read_exact(&mut head).ok()?;
        let length = match head[1] {
            126 => u64::from(u16::from_be_bytes(self.bytes()?)),
            127 => u64::from_be_bytes(self.bytes()?),
            n => n.into(),
        };
        let mut payload = vec![0; length as usize];
        self.0.read_exact(&mut payload).ok()?;
        Some((head[0] & 15, payload))
    }

    fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes = [0; N];
        self.0.read_exact(&mut bytes).ok()?;
        Some(bytes)
    }

    /// The next text.
    fn hear(&mut self) -> Option<String> {
        loop {
            match self.next()? {
                (1, text) => return String::from_utf8(text).ok(),
                (8, _) => return None,
                _ => {}
            }
        }
    }

    /// The next part of a frame: its header, and how many bytes follow.
    fn part(&mut self) -> ([u32; 4], usize) {
        loop {
            let (kind, bytes) = self.next().unwrap();
            if kind == 2 {
                let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
                return ([word(0), word(4), word(8), word(12)], bytes.len() - 16);
            }
        }
    }
}

#[test]
fn only_who_knows_the_token_sees_the_page_and_nothing_else() {
    let bench = Bench::new(4);
    for path in ["", "main.js", "image/1"] {
        assert_eq!(bench.status(&format!("/{TOKEN}/{path}")), 200, "{path}");
    }
    let other = TOKEN.replace('0', "1");
    for path in
        ["/", "/main.js", "//", &format!("/{TOKEN}"), &format!("/{other}/"), &format!("/{other}/main.js")]
    {
        assert_eq!(bench.status(path), 404, "{path}");
    }
    let escapes = [
        "../Cargo.toml",
        "..%2f..%2fetc/passwd",
        "/etc/passwd",
        "main.js/",
        "main.js%00",
        "image/../main.js",
    ];
    for path in escapes {
        assert_eq!(bench.status(&format!("/{TOKEN}/{path}")), 404, "{path}");
    }
    assert!(bench.server.url().ends_with(&format!("/{TOKEN}/")));
}

#[test]
fn answers_forbid_what_the_page_does_not_need() {
    let bench = Bench::new(4);
    for path in [format!("/{TOKEN}/"), "/".to_owned()] {
        let answer = bench.ask(&path, &format!("Host: localhost:{}\r\n", bench.port())).to_lowercase();
        for header in ["content-security-policy: default-src 'none'", "nosniff", "no-referrer", "no-store"] {
            assert!(answer.contains(header), "{header} in {answer}");
        }
        assert!(!answer.contains("access-control-allow-origin"));
    }
}

#[test]
fn other_hosts_and_pages_are_refused() {
    let bench = Bench::new(4);
    let (port, path) = (bench.port(), format!("/{TOKEN}/"));
    let of = |headers: &str| status(&bench.ask(&path, headers));
    for host in ["localhost", "127.0.0.1", "[::1]"] {
        assert_eq!(of(&format!("Host: {host}:{port}\r\n")), 200, "{host}");
    }
    for host in ["evil.example", "127.0.0.1.evil.example", "10.0.0.1", "localhost.", "", "[", "127.0.0.1:1:"]
    {
        assert_eq!(of(&format!("Host: {host}:{port}\r\n")), 421, "{host}");
    }
    assert_eq!(of(&format!("Host: 127.0.0.1:{}\r\n", port ^ 1)), 421);
    assert_eq!(of(&format!("Host: localhost:{port}\r\nOrigin: http://localhost:{port}\r\n")), 200);
    for origin in ["http://evil.example", "null", "https://localhost", "http://localhost"] {
        assert_eq!(of(&format!("Host: localhost:{port}\r\nOrigin: {origin}\r\n")), 403, "{origin}");
    }
    assert_eq!(of(&format!("Host: localhost:{port}\r\nHost: localhost:{port}\r\n")), 400);
    assert_eq!(of(""), 400);
}

#[test]
fn a_server_for_others_knows_addresses_but_no_names() {
    let access = Access { token: TOKEN.into(), address: "0.0.0.0:80".parse().unwrap() };
    let status = |host: &str| {
        let request = axum::http::Request::builder().uri(format!("/{TOKEN}/")).header("host", host);
        access.check(&request.body(()).unwrap().into_parts().0).err().map(|status| status.as_u16())
    };
    assert_eq!(["10.0.0.1", "10.0.0.1:80", "[fd00::1]:80", "localhost"].map(status), [None; 4]);
    assert_eq!(["evil.example", "10.0.0.1:81"].map(status), [Some(421); 2]);
}

#[test]
fn only_reading_is_allowed() {
    let bench = Bench::new(4);
    let mut stream = bench.connect();
    let port = bench.port();
    write!(stream, "POST /{TOKEN}/ HTTP/1.1\r\nHost: localhost:{port}\r\nContent-Length: 0\r\n\r\n").unwrap();
    let mut answer = [0; 12];
    stream.read_exact(&mut answer).unwrap();
    assert_eq!(&answer, b"HTTP/1.1 405");
}

#[test]
fn sockets_are_for_own_pages() {
    let bench = Bench::new(4);
    for origin in ["", "null", "http://evil.example", &format!("https://127.0.0.1:{}", bench.port())] {
        assert_eq!(bench.open_from(origin).err(), Some(403), "{origin}");
    }
    bench.open();
}

#[test]
fn texts_are_answered_and_documents_come_when_they_are_others() {
    let bench = Bench::new(4);
    let mut socket = bench.open();
    let documents: [Arc<str>; 2] = ["one".into(), "two".into()];
    bench.stage.show_documents(documents.to_vec());
    assert_eq!([socket.hear(), socket.hear()], [Some("one".into()), Some("two".into())]);
    bench.stage.show_documents(vec![Arc::clone(&documents[0]), "three".into()]);
    assert_eq!(socket.hear(), Some("three".into()));
    socket.say("hello");
    assert_eq!(socket.hear(), Some("heard hello".into()));
    let mut late = bench.open();
    assert_eq!([late.hear(), late.hear()], [Some("one".into()), Some("three".into())]);
}

#[test]
fn frames_come_in_parts_and_then_only_what_changed() {
    let bench = Bench::new(4);
    let mut pixels = vec![[0.5; 3]; 320 * 320];
    let first = Arc::new(Frame::new(320, 320, &pixels, None));
    bench.stage.show_frame(Arc::clone(&first));
    let mut socket = bench.open();
    let (mut count, mut last) = (0, 0);
    while last == 0 {
        let ([width, height, is_last, tiles], bytes) = socket.part();
        assert_eq!((width, height, bytes), (320, 320, tiles as usize * (4 + 64 * 64 * 6)));
        assert!(bytes < 500_000);
        (count, last) = (count + tiles, is_last);
    }
    assert_eq!(count, 25);
    pixels[0] = [1.0; 3];
    bench.stage.show_frame(Arc::new(Frame::new(320, 320, &pixels, Some(&first))));
    assert_eq!(socket.part(), ([320, 320, 1, 1], 4 + 64 * 64 * 6));
}

#[test]
fn rules_that_are_broken_end_the_connection_and_nothing_else() {
    let bench = Bench::new(64);
    let mut other = bench.open();
    let too_long = vec![b'a'; 65 << 10];
    let broken: [(&str, u8, &[u8]); 7] = [
        ("too long", 0x81, &too_long),
        ("no UTF-8", 0x81, &[0xff, 0xfe]),
        ("a reserved kind", 0x83, b"text"),
        ("a reserved bit", 0xc1, b"text"),
        ("a continuation of nothing", 0x80, b"text"),
        ("a ping in parts", 0x09, b"text"),
        ("binary", 0x82, b"text"),
    ];
    for (what, first, payload) in broken {
        let mut socket = bench.open();
        socket.send(first, payload);
        assert_eq!(socket.hear(), None, "{what}");
    }
    // A length that no memory holds, a frame without mask, noise, and half a frame.
    let raw: [&[u8]; 4] = [
        &[0x81, 0xff, 0x7f, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0],
        &[0x81, 4, b't', b'e', b'x', b't'],
        &[0x55; 300],
        &[0x81, 0x85, 0, 0],
    ];
    for (index, bytes) in raw.into_iter().enumerate() {
        let mut socket = bench.open();
        socket.0.write_all(bytes).unwrap();
        socket.0.shutdown(std::net::Shutdown::Write).unwrap();
        assert_eq!(socket.hear(), None, "{index}");
    }
    let mut refused = bench.open();
    refused.say("no");
    while refused.hear().is_some() {}
    // Parts of one message may not grow beyond what a whole one may be.
    let mut endless = bench.open();
    for part in 0..10 {
        endless.send(if part == 0 { 0x01 } else { 0x00 }, &[b'a'; 10_000]);
    }
    assert_eq!(endless.hear(), None);
    other.say("still there");
    assert_eq!(other.hear(), Some("heard still there".into()));
}

#[test]
fn there_is_a_place_for_so_many_pages_and_it_is_given_again() {
    let bench = Bench::new(3);
    let mut pages: Vec<_> = (0..3).map(|_| bench.open()).collect();
    let origin = format!("http://127.0.0.1:{}", bench.port());
    for _ in 0..100 {
        assert_eq!(bench.open_from(&origin).err(), Some(503));
        let headers = format!("Host: 127.0.0.1:{}\r\nOrigin: {origin}\r\n", bench.port());
        assert!(bench.ask(&format!("/{TOKEN}/socket"), &headers).contains("pages are open, no more can be"));
    }
    pages.iter_mut().for_each(|page| page.say("here"));
    assert!(pages.iter_mut().all(|page| page.hear().is_some()));
    drop(pages.pop());
    // It takes the server a moment to notice.
    let again = std::iter::repeat_with(|| bench.open_from(&origin)).find_map(Result::ok);
    assert!(again.is_some());
}

#[test]
fn a_port_that_is_taken_is_an_error() {
    let bench = Bench::new(1);
    let options =
        Options { address: bench.server.address(), token: TOKEN.into(), pages: 1, patience: PATIENCE };
    assert!(Server::start(options, ASSETS, &bench.stage, Arc::new(Echo::default())).is_err());
}
