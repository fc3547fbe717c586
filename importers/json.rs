//! What JSON takes in memory.

/// Bytes that `serde_json` holds for an object with its first member, and for an item or a further member: a little text
/// can make much of it. Measured.
const OBJECT: u64 = 720;
const ITEM: u64 = 64;

/// Depth at which `serde_json` gives up.
const DEEPEST: u64 = 128;

/// Bytes that the text takes once it is parsed into values, roughly and at most. Needs one look at each byte.
pub(crate) fn cost(text: &[u8]) -> u64 {
    let (mut objects, mut items, mut depth) = (0_u64, 0_u64, 0_u64);
    let (mut quoted, mut escaped) = (false, false);
    for byte in text {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = quoted,
            b'"' => quoted = !quoted,
            _ if quoted => {}
            b'{' | b'[' => {
                depth += 1;
                *if *byte == b'{' { &mut objects } else { &mut items } += 1;
            }
            b'}' | b']' => depth = depth.saturating_sub(1),
            b',' => items += 1,
            _ => {}
        }
        if depth > DEEPEST {
            break;
        }
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
        assert_eq!(cost(br#"["{,\",{"]"#), 10 + 64);
        assert_eq!(
            cost("[".repeat(10_000).as_bytes()),
            10_000 + 129 * 64,
            "nothing is made of what is deeper"
        );
    }
}
