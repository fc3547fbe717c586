//! Patterns for names and paths: `*` is any run of characters, `?` any one character.

/// Whether `pattern` has a character of its own meaning.
pub(super) fn is_glob(pattern: &str) -> bool {
    pattern.contains(['*', '?'])
}

/// Whether `path` fits `pattern`: as a whole or, where the pattern begins with `/`, from some name on. So paths that an
/// asset's own format writes fit wherever the asset is placed.
pub(super) fn matches_path(pattern: &str, path: &str) -> bool {
    matches(pattern, path) || pattern.starts_with('/') && matches(&format!("*{pattern}"), &format!("/{path}"))
}

/// Whether the whole of `name` fits `pattern`. Takes time in proportion to the product of the lengths at most: on a
/// mismatch only the last star gives way.
pub(super) fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    let mut star = None;
    while let Some(character) = name.get(n) {
        match pattern.get(p) {
            Some('*') => {
                p += 1;
                star = Some((p, n));
            }
            Some(wanted) if *wanted == '?' || wanted == character => (p, n) = (p + 1, n + 1),
            _ => match star {
                Some((after, from)) => {
                    star = Some((after, from + 1));
                    (p, n) = (after, from + 1);
                }
                None => return false,
            },
        }
    }
    pattern.iter().skip(p).all(|rest| *rest == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn globs() {
        for (pattern, name, fits) in [
            ("", "", true),
            ("", "a", false),
            ("*", "", true),
            ("*", "Chrome", true),
            ("Chrome*", "Chrome.001", true),
            ("Chrome*", "chrome", false),
            ("*.00?", "Chrome.001", true),
            ("*.00?", "Chrome.0011", false),
            ("a*b*c", "aXbYbZc", true),
            ("a*b*c", "aXbYbZ", false),
            ("?", "é", true),
            ("?", "", false),
            ("**a", "ba", true),
            ("a", "ab", false),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
        assert!(is_glob("a?") && is_glob("*") && !is_glob("plain.001"));
    }

    #[test]
    fn paths() {
        for (pattern, fits) in [
            ("car/World/Wheel", true),
            ("*/Wheel", true),
            ("car/*", true),
            ("World/Wheel", false),
            ("/World/Wheel", true),
            ("/World/*", true),
            ("/car/*", true),
            ("/orld/Wheel", false),
            ("/World", false),
        ] {
            assert_eq!(matches_path(pattern, "car/World/Wheel"), fits, "{pattern}");
        }
    }

    #[test]
    fn many_stars_end() {
        assert!(!matches(&format!("{}b", "a*".repeat(200)), &"a".repeat(2000)));
        assert!(matches(&"*a".repeat(200), &"a".repeat(2000)));
    }
}
