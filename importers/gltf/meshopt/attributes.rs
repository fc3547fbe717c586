//! Vertices: blocks of elements, whose bytes are stored one after the other as differences.

/// The first byte of a stream.
const HEADER: u8 = 0xa0;
/// Elements of a group.
const GROUP: usize = 16;
/// Bytes of a block, and its most elements.
const BLOCK: usize = 8192;
const MOST: usize = 256;
/// The end of a stream holds the element before the first one, padded to so many bytes.
const TAIL: usize = 32;

/// `count` elements of `stride` bytes; `None` if the stream is broken.
pub(super) fn decode(bytes: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    if stride == 0 || stride > MOST || !stride.is_multiple_of(4) || bytes.first() != Some(&HEADER) {
        return None;
    }
    let end = bytes.len().checked_sub(stride.max(TAIL))?;
    let mut last = bytes.get(bytes.len() - stride..)?.to_vec();
    let mut rest = bytes.get(1..end)?;
    let mut decoded = vec![0; count * stride];
    let block = ((BLOCK / stride) & !(GROUP - 1)).min(MOST);
    for elements in decoded.chunks_mut(block * stride) {
        for (k, last) in last.iter_mut().enumerate() {
            let differences = column(&mut rest, elements.len() / stride)?;
            for (element, difference) in elements.chunks_exact_mut(stride).zip(differences) {
                *last = last.wrapping_add(unzigzag(difference));
                element[k] = *last;
            }
        }
    }
    rest.is_empty().then_some(decoded)
}

fn unzigzag(x: u8) -> u8 {
    (x >> 1) ^ (x & 1).wrapping_neg()
}

/// Takes `n` bytes off the front.
fn take<'a>(rest: &mut &'a [u8], n: usize) -> Option<&'a [u8]> {
    let (front, back) = rest.split_at_checked(n)?;
    *rest = back;
    Some(front)
}

/// The differences of one byte of all elements of a block, rounded up to whole groups.
fn column(rest: &mut &[u8], count: usize) -> Option<Vec<u8>> {
    let groups = count.div_ceil(GROUP);
    let header = take(rest, groups.div_ceil(4))?;
    let mut found = Vec::with_capacity(groups * GROUP);
    for group in 0..groups {
        match header[group / 4] >> (group % 4 * 2) & 3 {
            0 => found.extend([0; GROUP]),
            1 => packed(rest, 2, &mut found)?,
            2 => packed(rest, 4, &mut found)?,
            _ => found.extend(take(rest, GROUP)?),
        }
    }
    Some(found)
}

/// A group of numbers of `bits` each, the first in the highest bits; those that do not fit follow as bytes.
fn packed(rest: &mut &[u8], bits: usize, found: &mut Vec<u8>) -> Option<()> {
    let bytes = take(rest, GROUP * bits / 8)?;
    let large = (1 << bits) - 1;
    for i in 0..GROUP {
        let place = i * bits;
        let number = bytes[place / 8] >> (8 - bits - place % 8) & large;
        found.push(if number == large { take(rest, 1)?[0] } else { number });
    }
    Some(())
}
