//! Indices: triangles by the edges and vertices they share with the last ones, and plain sequences.

/// The first byte of either stream.
const TRIANGLES: u8 = 0xe1;
const SEQUENCE: u8 = 0xd1;
/// Bytes at the end: the table of common codes, and padding.
const TABLE: usize = 16;
const TAIL: usize = 4;

/// The last sixteen of something.
struct Recent<T> {
    items: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    /// The one pushed `ago` pushes before the last.
    fn get(&self, ago: usize) -> T {
        self.items[self.next.wrapping_sub(1 + ago) & 15]
    }

    fn push(&mut self, item: T) {
        self.items[self.next & 15] = item;
        self.next = self.next.wrapping_add(1);
    }
}

/// Reads triangles.
struct Decoder<'a> {
    data: std::slice::Iter<'a, u8>,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
    /// The smallest vertex that was not met.
    next: u32,
    /// The last vertex that was stored as a number.
    last: u32,
}

/// `count` corners of triangles; `None` if the stream is broken.
pub(super) fn triangles(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let (&header, rest) = bytes.split_first()?;
    if header != TRIANGLES || !count.is_multiple_of(3) {
        return None;
    }
    let (codes, rest) = rest.split_at_checked(count / 3)?;
    let (data, table) = rest.split_at_checked(rest.len().checked_sub(TABLE)?)?;
    let mut decoder = Decoder {
        data: data.iter(),
        edges: Recent { items: [[u32::MAX; 2]; 16], next: 0 },
        vertices: Recent { items: [u32::MAX; 16], next: 0 },
        next: 0,
        last: 0,
    };
    let mut found = Vec::with_capacity(count);
    for &code in codes {
        let triangle = match code {
            0..0xf0 => decoder.beside(code)?,
            0xf0..0xfe => decoder.apart(0, table[usize::from(code & 15)], false)?,
            _ => {
                let more = *decoder.data.next()?;
                if more == 0 {
                    decoder.next = 0;
                }
                decoder.apart(if code == 0xfe { 0 } else { 15 }, more, true)?
            }
        };
        found.extend(triangle);
    }
    decoder.data.as_slice().is_empty().then_some(found)
}

impl Decoder<'_> {
    /// A triangle on a recent edge.
    fn beside(&mut self, code: u8) -> Option<[u32; 3]> {
        let [a, b] = self.edges.get(usize::from(code >> 4));
        let c = match code & 15 {
            0 => self.fresh(),
            recent @ 1..13 => self.vertices.get(usize::from(recent)),
            13 => self.number(self.last.wrapping_sub(1)),
            14 => self.number(self.last.wrapping_add(1)),
            _ => self.stored()?,
        };
        if !(1..13).contains(&(code & 15)) {
            self.vertices.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some([a, b, c])
    }

    /// A triangle of three vertices: each fresh (0), recent, or, where that is allowed, stored (15).
    fn apart(&mut self, first: u8, others: u8, may_store: bool) -> Option<[u32; 3]> {
        let kinds = [first, others >> 4, others & 15];
        // All are named before the first is pushed, and fresh ones before stored ones.
        let mut triangle = [0; 3];
        for (vertex, kind) in triangle.iter_mut().zip(kinds) {
            *vertex = match kind {
                0 => self.fresh(),
                15 if may_store => 0,
                recent => self.vertices.get(usize::from(recent) - 1),
            };
        }
        for (vertex, kind) in triangle.iter_mut().zip(kinds) {
            if kind == 15 && may_store {
                *vertex = self.stored()?;
            }
        }
        for (vertex, kind) in triangle.into_iter().zip(kinds) {
            if kind == 0 || kind == 15 && may_store {
                self.vertices.push(vertex);
            }
        }
        let [a, b, c] = triangle;
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some(triangle)
    }

    fn fresh(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    fn number(&mut self, vertex: u32) -> u32 {
        self.last = vertex;
        vertex
    }

    fn stored(&mut self) -> Option<u32> {
        let difference = unzigzag(variable(&mut self.data)?);
        Some(self.number(self.last.wrapping_add(difference)))
    }
}

/// `count` indices; `None` if the stream is broken.
pub(super) fn sequence(bytes: &[u8], count: usize) -> Option<Vec<u32>> {
    let (&header, rest) = bytes.split_first()?;
    let mut data = rest.get(..rest.len().checked_sub(TAIL)?)?.iter();
    // Each takes a byte or more.
    if header != SEQUENCE || count > data.len() {
        return None;
    }
    let mut last = [0u32; 2];
    let mut found = Vec::with_capacity(count);
    for _ in 0..count {
        let number = variable(&mut data)?;
        let base = &mut last[(number & 1) as usize];
        *base = base.wrapping_add(unzigzag(number >> 1));
        found.push(*base);
    }
    data.as_slice().is_empty().then_some(found)
}

fn unzigzag(x: u32) -> u32 {
    (x >> 1) ^ (x & 1).wrapping_neg()
}

/// A number of up to five bytes of seven bits, the lowest first.
fn variable(data: &mut std::slice::Iter<'_, u8>) -> Option<u32> {
    let mut number = 0;
    for shift in [0, 7, 14, 21, 28] {
        let byte = *data.next()?;
        number |= u32::from(byte & 127) << shift;
        if byte < 128 {
            return Some(number);
        }
    }
    None
}

/// Indices of two or four bytes.
pub(super) fn bytes(indices: &[u32], stride: usize) -> Option<Vec<u8>> {
    match stride {
        2 => Some(indices.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect()),
        4 => Some(indices.iter().flat_map(|i| i.to_le_bytes()).collect()),
        _ => None,
    }
}
