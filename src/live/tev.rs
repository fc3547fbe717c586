//! Images for tev, the viewer, over its network protocol (tev's README, "IPC"): little-endian packets that begin with their
//! length, itself included, and a type.

use std::{
    io::{self, Write},
    net::{TcpStream, ToSocketAddrs},
    time::Duration,
};

/// How long tev may take to answer or to read.
const PATIENCE: Duration = Duration::from_secs(2);
/// The channels of an image.
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A connection to tev that shows one image. It comes back after tev did.
#[derive(Debug)]
pub struct Tev {
    address: String,
    name: String,
    stream: Option<TcpStream>,
    /// Of the image that tev shows.
    size: Option<[i32; 2]>,
}

impl Tev {
    /// For a tev at `host:port`, which need not run yet, and an image called `name`.
    pub fn new(address: impl Into<String>, name: impl Into<String>) -> Self {
        Self { address: address.into(), name: name.into(), stream: None, size: None }
    }

    /// Where it is looked for.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Shows an image, rows from the top.
    ///
    /// # Errors
    /// tev cannot be reached; the next call tries again.
    pub fn show(&mut self, width: usize, height: usize, pixels: &[[f32; 3]]) -> io::Result<()> {
        let size = [width, height].map(|n| i32::try_from(n).unwrap_or(i32::MAX));
        let shown = self.send(size, pixels);
        if shown.is_err() {
            (self.stream, self.size) = (None, None);
        }
        shown
    }

    fn send(&mut self, size: [i32; 2], pixels: &[[f32; 3]]) -> io::Result<()> {
        let stream = match &mut self.stream {
            Some(stream) => stream,
            None => self.stream.insert(connect(&self.address)?),
        };
        if self.size != Some(size) {
            if self.size.is_some() {
                stream.write_all(&close_image(&self.name))?;
            }
            stream.write_all(&create_image(&self.name, size))?;
            self.size = Some(size);
        }
        stream.write_all(&update_image(&self.name, size, pixels))
    }
}

fn connect(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "no such address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, PATIENCE) {
            Ok(stream) => {
                stream.set_write_timeout(Some(PATIENCE))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// `CreateImage`: an image of these channels, black.
fn create_image(name: &str, [width, height]: [i32; 2]) -> Vec<u8> {
    let mut packet = Packet::new(4).flag(true).text(name).number(width).number(height);
    packet = packet.number(CHANNELS.len() as i32);
    CHANNELS.into_iter().fold(packet, Packet::text).end()
}

/// `UpdateImageV3`: pixels of the whole image, channels interleaved.
fn update_image(name: &str, [width, height]: [i32; 2], pixels: &[[f32; 3]]) -> Vec<u8> {
    let packet = Packet::new(6).flag(false).text(name).number(CHANNELS.len() as i32);
    let packet = CHANNELS.into_iter().fold(packet, Packet::text);
    let packet = packet.number(0).number(0).number(width).number(height);
    let packet = (0..3).fold(packet, Packet::long);
    let mut packet = [3; 3].into_iter().fold(packet, Packet::long);
    packet.0.extend(pixels.iter().flatten().flat_map(|value| value.to_le_bytes()));
    packet.end()
}

/// `CloseImage`.
fn close_image(name: &str) -> Vec<u8> {
    Packet::new(2).text(name).end()
}

struct Packet(Vec<u8>);

impl Packet {
    fn new(kind: u8) -> Self {
        Self(vec![0, 0, 0, 0, kind])
    }

    fn flag(mut self, flag: bool) -> Self {
        self.0.push(flag.into());
        self
    }

    fn number(mut self, number: i32) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    fn long(mut self, number: i64) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    /// A text ends with a zero, and so holds none.
    fn text(mut self, text: &str) -> Self {
        self.0.extend(text.bytes().filter(|byte| *byte != 0));
        self.0.push(0);
        self
    }

    fn end(mut self) -> Vec<u8> {
        let length = u32::try_from(self.0.len()).unwrap_or(u32::MAX).to_le_bytes();
        self.0[..4].copy_from_slice(&length);
        self.0
    }
}

#[cfg(test)]
mod tests {
    use std::{io::Read, net::TcpListener};

    use super::*;

    #[test]
    fn packets_have_the_lengths_of_the_protocol() {
        let pixels = [[0.5; 3]; 4];
        let packets =
            [create_image("ajar", [2, 2]), update_image("ajar", [2, 2], &pixels), close_image("ajar")];
        assert_eq!(packets.each_ref().map(Vec::len), [29, 133, 10]);
        for packet in packets {
            assert_eq!(packet[..4], (packet.len() as u32).to_le_bytes());
        }
    }

    #[test]
    fn an_image_is_created_once_and_again_in_another_size() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut tev = Tev::new(listener.local_addr().unwrap().to_string(), "a");
        tev.show(1, 1, &[[1.0; 3]]).unwrap();
        tev.show(1, 1, &[[2.0; 3]]).unwrap();
        tev.show(2, 1, &[[2.0; 3]; 2]).unwrap();
        drop(tev);
        let mut sent = Vec::new();
        listener.accept().unwrap().0.read_to_end(&mut sent).unwrap();
        let mut kinds = Vec::new();
        while sent.len() > 4 {
            let length = u32::from_le_bytes(sent[..4].try_into().unwrap()) as usize;
            kinds.push(sent[4]);
            sent.drain(..length);
        }
        assert_eq!(kinds, [4, 6, 6, 2, 4, 6]);
    }

    #[test]
    fn a_tev_that_is_not_there_is_an_error_until_it_is() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        drop(listener);
        let mut tev = Tev::new(address.to_string(), "a");
        assert!(tev.show(1, 1, &[[1.0; 3]]).is_err());
        let Ok(_listener) = TcpListener::bind(address) else { return };
        assert!(tev.show(1, 1, &[[1.0; 3]]).is_ok());
    }
}
