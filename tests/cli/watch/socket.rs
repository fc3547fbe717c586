//! A page without a browser: the WebSocket of RFC 6455, as far as it is needed.

use std::{
    io::{Read, Write},
    net::TcpStream,
};

use exr::prelude::f16;
use serde_json::{Value, json};

use super::{PATIENCE, Watch};

/// Side of the tiles of frames, pixels.
const TILE: usize = 64;

/// What a page gets.
pub(super) enum Message {
    Document(Value),
    Frame(Frame),
}

/// A frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Frame {
    pub size: [usize; 2],
    pub pixels: Vec<[f32; 3]>,
}

impl Frame {
    pub fn mean(&self) -> f32 {
        self.pixels.iter().flatten().sum::<f32>() / (3 * self.pixels.len()) as f32
    }

    /// Takes over the tiles of a message; returns whether it was the last one of the frame.
    fn take(&mut self, message: &[u8]) -> bool {
        let number = |at: usize| u32::from_le_bytes(message[at..at + 4].try_into().unwrap()) as usize;
        let [width, height, is_last, count] = [0, 4, 8, 12].map(number);
        if self.size != [width, height] {
            *self = Self { size: [width, height], pixels: vec![[0.0; 3]; width * height] };
        }
        let (mut at, columns) = (16, width.div_ceil(TILE));
        for _ in 0..count {
            let (x, y) = (number(at) % columns * TILE, number(at) / columns * TILE);
            at += 4;
            for row in y..(y + TILE).min(height) {
                for pixel in &mut self.pixels[row * width + x..row * width + (x + TILE).min(width)] {
                    let code = |i: usize| [message[at + i], message[at + i + 1]];
                    *pixel = [0, 2, 4].map(|i| f16::from_le_bytes(code(i)).to_f32());
                    at += 6;
                }
            }
        }
        is_last == 1
    }
}

pub(super) struct Page {
    stream: TcpStream,
    frame: Frame,
    /// As of the last word of it.
    state: Value,
}

impl Page {
    /// The page of a program that has just been started.
    pub fn of(watch: &mut Watch) -> Self {
        let url = watch.wait_for(|it| it["page"].is_string())["page"].as_str().unwrap().to_owned();
        Self::open(&url)
    }

    pub fn open(url: &str) -> Self {
        let (host, path) = url.strip_prefix("http://").unwrap().split_once('/').unwrap();
        let mut stream = TcpStream::connect(host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let headers = "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
            Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
        write!(
            stream,
            "GET /{path}socket HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n{headers}\r\n"
        )
        .unwrap();
        let mut head = Vec::new();
        while !head.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            head.push(byte[0]);
        }
        assert!(head.starts_with(b"HTTP/1.1 101"));
        Self { stream, frame: Frame::default(), state: Value::Null }
    }

    /// Asks for something.
    pub fn ask(&mut self, request: Value) {
        let text = request.to_string();
        assert!(text.len() < 126);
        // The mask is all zeros, which leaves the text as it is.
        let frame = [&[0x81, 0x80 | text.len() as u8, 0, 0, 0, 0], text.as_bytes()].concat();
        self.stream.write_all(&frame).unwrap();
    }

    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        self.stream.read_exact(&mut bytes).unwrap();
        bytes
    }

    /// The next document or whole frame.
    #[track_caller]
    pub fn next(&mut self) -> Message {
        loop {
            let [kind, length] = self.bytes();
            let length = match length {
                126 => u64::from(u16::from_be_bytes(self.bytes())),
                127 => u64::from_be_bytes(self.bytes()),
                n => n.into(),
            };
            let mut payload = vec![0; length as usize];
            self.stream.read_exact(&mut payload).unwrap();
            match kind & 15 {
                1 => {
                    let document: Value = serde_json::from_slice(&payload).unwrap();
                    if document["type"] == "state" {
                        self.state = document.clone();
                    }
                    return Message::Document(document);
                }
                2 if self.frame.take(&payload) => return Message::Frame(self.frame.clone()),
                _ => {}
            }
        }
    }

    /// Waits for a document of which this is true.
    #[track_caller]
    pub fn wait_for(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        loop {
            if let Message::Document(it) = self.next()
                && what(&it)
            {
                return it;
            }
        }
    }

    /// Waits for a state of which this is true, if it is not.
    #[track_caller]
    pub fn wait_for_state(&mut self, what: impl Fn(&Value) -> bool) -> Value {
        if !what(&self.state) {
            self.wait_for(|it| it["type"] == "state" && what(it));
        }
        self.state.clone()
    }

    /// Waits for an image that is done; returns its number.
    #[track_caller]
    pub fn wait_until_done(&mut self) -> u64 {
        self.wait_for_state(|it| it["phase"] == "done")["image"].as_u64().unwrap()
    }

    /// Changes a value and waits for an image with it that is done.
    #[track_caller]
    pub fn set(&mut self, table: &str, name: &str, key: &str, value: impl Into<Value>) {
        let before = Some(self.wait_until_done());
        self.ask(json!({ "do": "set", "table": table, "name": name, "key": key, "value": value.into() }));
        self.wait_for_state(|it| it["phase"] == "done" && it["image"].as_u64() > before);
    }
}
