//! Quantities as people write them: `10m`, `2%`. The scene file and the command line read them alike.

use std::time::Duration;

/// Reads a time span: a number of seconds, or numbers with the units `ms`, `s`, `m`, `h`, `d`, as in `90s`, `1.5h`
/// or `1h30m`.
///
/// # Errors
/// A sentence that says what was expected; also for negative, infinite and absurdly long times.
pub fn parse_duration(text: &str) -> Result<Duration, String> {
    let wrong =
        || format!("\"{}\" is not a time, expected something like 90s, 10m or 1h30m", text.escape_debug());
    let mut rest = text.trim();
    let mut seconds = 0.0;
    if rest.is_empty() {
        return Err(wrong());
    }
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        let (number, tail) = rest.split_at(digits);
        let letters = tail.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(tail.len());
        let (unit, tail) = tail.split_at(letters);
        let scale = match unit {
            "ms" => 1e-3,
            "s" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            "d" => 86400.0,
            // Without a unit the number stands alone: `1h30` would be a riddle.
            "" if number.len() == text.trim().len() => 1.0,
            _ => return Err(wrong()),
        };
        seconds += scale * number.parse::<f64>().map_err(|_| wrong())?;
        rest = tail.trim_start();
    }
    Duration::try_from_secs_f64(seconds).map_err(|_| wrong())
}

/// Reads a fraction: `2%` or `0.02`, both 0.02.
///
/// # Errors
/// A sentence that says what was expected; also for numbers outside [0, 1].
pub fn parse_percent(text: &str) -> Result<f64, String> {
    let wrong = || format!("\"{}\" is not a share, expected something like 2% or 0.02", text.escape_debug());
    let fraction = match text.trim().strip_suffix('%') {
        Some(percent) => percent.trim_end().parse::<f64>().map_err(|_| wrong())? / 100.0,
        None => text.trim().parse::<f64>().map_err(|_| wrong())?,
    };
    if (0.0..=1.0).contains(&fraction) { Ok(fraction) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations() {
        for (text, seconds) in [
            ("90", 90.0),
            ("90s", 90.0),
            (" 10m ", 600.0),
            ("10min", 600.0),
            ("1h", 3600.0),
            ("1.5h", 5400.0),
            ("1h30m", 5400.0),
            ("1h 30m 5s", 5405.0),
            ("250ms", 0.25),
            ("2d", 172_800.0),
            ("0.5", 0.5),
        ] {
            assert_eq!(parse_duration(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", " ", "m", "-1s", "1x", "1h30", "30 1h", "1.2.3s", "inf", "nan", "1e3", "١s"] {
            assert!(parse_duration(text).is_err(), "{text}");
        }
        assert!(parse_duration(&"9".repeat(400)).is_err());
        assert_eq!(
            parse_duration("soon").unwrap_err(),
            "\"soon\" is not a time, expected something like 90s, 10m or 1h30m"
        );
    }

    #[test]
    fn percents() {
        for (text, fraction) in [("2%", 0.02), ("2 %", 0.02), ("0.02", 0.02), ("100%", 1.0), ("0", 0.0)] {
            assert_eq!(parse_percent(text), Ok(fraction), "{text}");
        }
        for text in ["", "%", "2", "101%", "-1%", "nan", "NaN%", "two"] {
            assert!(parse_percent(text).is_err(), "{text}");
        }
    }
}
