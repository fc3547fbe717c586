//! Numbers and names as people read them.

/// A name with control characters escaped.
pub(crate) fn plain(name: &str) -> String {
    name.escape_debug().to_string()
}

/// The same in quotes.
pub(crate) fn quoted(name: &str) -> String {
    format!("\"{}\"", plain(name))
}

/// `1 mesh`, `2 vertices`, `12 345 triangles`.
pub(crate) fn many(count: usize, what: &str) -> String {
    let what = match (count, what) {
        (1, _) => what.to_owned(),
        (_, "mesh") => "meshes".to_owned(),
        (_, "vertex") => "vertices".to_owned(),
        _ => format!("{what}s"),
    };
    format!("{} {what}", grouped(count))
}

/// Digits in threes.
pub(crate) fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let first = digits.len() % 3;
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && index % 3 == first {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A number with four significant digits.
pub(crate) fn number(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    let size = rounded.abs();
    if size != 0.0 && !(1e-4..1e9).contains(&size) { format!("{rounded:e}") } else { rounded.to_string() }
}

/// Three numbers in brackets.
pub(crate) fn vector(values: &[f64; 3]) -> String {
    format!("({})", values.map(number).join(", "))
}

/// A size in binary units.
pub(crate) fn bytes(count: u64) -> String {
    match count {
        0..1024 => format!("{count} B"),
        1024..1_048_576 => format!("{:.1} KiB", count as f64 / 1024.0),
        _ => format!("{:.1} MiB", count as f64 / 1_048_576.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        let numbers = [0.0, 0.123_456, 12_345.678, -1.0, 1.5e9, f64::NAN].map(number);
        assert_eq!(numbers.join(" "), "0 0.1235 12350 -1 1.5e9 NaN");
        let counts = [0, 999, 1000, 12_345, 1_234_567].map(grouped);
        assert_eq!(counts.join(", "), "0, 999, 1 000, 12 345, 1 234 567");
        let words = [many(1, "mesh"), many(2, "mesh"), many(0, "vertex"), many(1, "node")];
        assert_eq!(words.join(", "), "1 mesh, 2 meshes, 0 vertices, 1 node");
        assert_eq!([12, 1536, 3 << 20].map(bytes).join(", "), "12 B, 1.5 KiB, 3.0 MiB");
    }

    #[test]
    fn names_cannot_steer_the_terminal() {
        assert_eq!(quoted("a\u{1b}[2J\"b\n"), "\"a\\u{1b}[2J\\\"b\\n\"");
    }
}
