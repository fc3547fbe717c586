//! What JSON takes in memory.

/// Bytes that `serde_json` holds for an object with its first member, and for an item or a further member: a little text
/// can make much of it. Measured.
const OBJECT: u64 = 720;
const ITEM: u64 = 64;

/// Bytes that the text takes once it is parsed into values, roughly and at most. Needs one look at each byte.
pub(crate) fn cost(text: &[u8]) -> u64 {
    let (mut objects, mut items) = (0_u64, 0_u64);
    for byte in text {
        objects += u64::from(*byte == b'{');
        items += u64::from(matches!(byte, b',' | b'['));
    }
    text.len() as u64 + objects * OBJECT + items * ITEM
}

#[cfg(test)]
mod tests {
    use super::cost;

    #[test]
    fn cost_is_by_what_text_makes() {
        assert_eq!(cost(b"[1,2,3]"), 7 + 3 * 64);
        assert_eq!(cost(br#"{"a":{}}"#), 8 + 2 * 720);
    }
}
