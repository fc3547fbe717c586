//! Changes to files that keep most of their structure: most damaged files of the world do, and parsers stop early at the
//! others.

use std::ops::Range;

use crate::{laboratory::Target, seeds};

/// Marsaglia's xorshift64: the same changes in every run.
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit.max(1) as u64) as usize
    }

    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }

    fn pick<'a, T: ?Sized>(&mut self, items: &[&'a T]) -> &'a T {
        items[self.below(items.len())]
    }
}

const NUMBERS: [&str; 38] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "5",
    "7",
    "8",
    "12",
    "16",
    "100",
    "127",
    "128",
    "255",
    "256",
    "65535",
    "65536",
    "2147483647",
    "2147483648",
    "4294967295",
    "4294967296",
    "9007199254740993",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "1e-320",
    "1e-45",
    "1e-20",
    "0.5",
    "1e20",
    "1e38",
    "-3.4e38",
    "1e39",
    "1e308",
    "1e999",
    "nan",
];

const WORDS: [&str; 24] = [
    "null",
    "true",
    "[]",
    "{}",
    "\"\"",
    "\"a\"",
    "\"../secret\"",
    "\"/etc/passwd\"",
    "\"file:///etc/passwd\"",
    "\"http://localhost/a\"",
    "\"map.png\"",
    "\"box.obj\"",
    "\"input\"",
    "\"data:,\"",
    "\"*\"",
    "inf",
    "/",
    "//",
    "\\\n",
    "\r",
    "\u{feff}",
    "\u{0}",
    "é",
    "\n",
];

/// Four bytes that are special as an integer or as a float.
const BITS: [u32; 16] = [
    0,
    1,
    2,
    3,
    0xff,
    0x100,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7f80_0000,
    0xff80_0000,
    0x7fc0_0000,
    0x7f7f_ffff,
    0x0000_0001,
    0x3f80_0000,
];

/// Makes one input.
pub struct Mutator(Dice);

impl Mutator {
    /// The maker of input `number`.
    pub fn new(number: u64) -> Self {
        Self(Dice(number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15)))
    }

    /// One of the seeds, changed.
    pub fn mutate(&mut self, target: Target, seeds: &[Vec<u8>]) -> Vec<u8> {
        let seed = &seeds[self.0.below(seeds.len())];
        if target == Target::Picture && self.0.one_in(2) {
            return self.words(seed.clone());
        }
        if target == Target::Picture || self.0.one_in(12) {
            return self.bytes(seed.clone());
        }
        match (target, seeds::taken_apart(seed)) {
            (Target::Glb | Target::Ajar, Some((magic, json, binary))) => self.container(magic, json, binary),
            _ => self.text(seed),
        }
    }

    fn container(&mut self, magic: [u8; 4], json: &[u8], binary: &[u8]) -> Vec<u8> {
        let change = self.0.below(3);
        let json = if change < 2 { self.text(json) } else { json.to_vec() };
        let binary = if change > 0 { self.words(binary.to_vec()) } else { binary.to_vec() };
        seeds::container(magic, json, binary)
    }

    /// Special numbers at multiples of four bytes.
    fn words(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        for _ in 0..=self.0.below(4) {
            let (word, at) = (BITS[self.0.below(BITS.len())], self.0.below(bytes.len() / 4) * 4);
            if let Some(place) = bytes.get_mut(at..at + 4) {
                place.copy_from_slice(&word.to_le_bytes());
            }
        }
        if self.0.one_in(4) { self.bytes(bytes) } else { bytes }
    }

    /// Flipped bits, other bytes, a part missing, an end cut off.
    fn bytes(&mut self, mut bytes: Vec<u8>) -> Vec<u8> {
        let size = bytes.len();
        match self.0.below(4) {
            0 => bytes.truncate(self.0.below(size)),
            1 => {
                let (from, length) = (self.0.below(size), self.0.below(64));
                bytes.drain(from..(from + length).min(size));
            }
            kind => {
                for _ in 0..=self.0.below(4) {
                    let (at, bit, byte) = (self.0.below(size), self.0.below(8), self.0.below(256));
                    if let Some(place) = bytes.get_mut(at) {
                        *place = if kind == 2 { *place ^ (1 << bit) } else { byte as u8 };
                    }
                }
            }
        }
        bytes
    }

    /// Other numbers and words, tokens missing, repeated, in other places.
    fn text(&mut self, text: &[u8]) -> Vec<u8> {
        let mut tokens = tokens(text);
        for _ in 0..=self.0.below(3) {
            self.change(&mut tokens);
        }
        tokens.concat()
    }

    fn change(&mut self, tokens: &mut Vec<&[u8]>) {
        let size = tokens.len();
        let at = self.0.below(size);
        let range =
            if self.0.one_in(4) { at..(at + 1 + self.0.below(12)).min(size) } else { item(tokens, at) };
        match self.0.below(8) {
            0..=3 => {
                let is_number =
                    |token: &&[u8]| token.iter().any(u8::is_ascii_digit) && !token.starts_with(b"\"");
                let number = tokens.iter().skip(at).position(is_number).map(|after| at + after);
                if let Some(token) = number.and_then(|at| tokens.get_mut(at)) {
                    *token = self.0.pick(&NUMBERS).as_bytes();
                }
            }
            4 => {
                if let Some(token) = tokens.get_mut(at) {
                    *token = self.0.pick(&WORDS).as_bytes();
                }
            }
            5 => drop(tokens.drain(range)),
            6 => {
                let part = tokens[range.clone()].to_vec();
                let most = if self.0.one_in(16) { 12 } else { 4 };
                let times = 1 << self.0.below(most);
                tokens.splice(range.end..range.end, part.repeat(times));
            }
            _ => {
                let part = tokens[range].to_vec();
                let to = self.0.below(size);
                let to = if self.0.one_in(4) { to } else { item(tokens, to).start };
                tokens.splice(to..to, part);
            }
        }
    }
}

/// The first line or item of a list after token `at`, with the end of the line or the comma behind it.
fn item(tokens: &[&[u8]], at: usize) -> Range<usize> {
    let is_one_of = |token: &[u8], signs: &[u8]| token.len() == 1 && signs.contains(&token[0]);
    let begins = |token: &&[u8]| is_one_of(token, b",\n[{");
    let start = tokens.iter().skip(at).position(begins).map_or(at, |after| at + after + 1);
    let mut depth = 0;
    for (index, token) in tokens.iter().enumerate().skip(start) {
        depth += i32::from(is_one_of(token, b"[{")) - i32::from(is_one_of(token, b"]}"));
        if depth < 0 {
            return start..index;
        }
        if depth == 0 && is_one_of(token, b",\n") {
            return start..index + 1;
        }
    }
    start..tokens.len()
}

/// Strings, runs of white space, runs of letters, digits and signs of numbers, and what is between them.
fn tokens(text: &[u8]) -> Vec<&[u8]> {
    let kind = |byte: u8| match byte {
        b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' | b'_' | b'.' | b'-' | b'+' => 1,
        b' ' | b'\t' => 2,
        _ => 0,
    };
    let (mut tokens, mut rest) = (Vec::new(), text);
    while let Some(&first) = rest.first() {
        let end = match (first, kind(first)) {
            (b'"', _) => rest.iter().skip(1).position(|&byte| byte == b'"').map_or(rest.len(), |at| at + 2),
            (_, 0) => 1,
            (_, same) => rest.iter().position(|&byte| kind(byte) != same).unwrap_or(rest.len()),
        };
        let (token, after) = rest.split_at(end);
        tokens.push(token);
        rest = after;
    }
    tokens
}
