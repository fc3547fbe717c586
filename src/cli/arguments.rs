//! Values of arguments.

use std::path::PathBuf;

pub(super) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let numbers = text.split_once(['x', 'X']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    numbers
        .filter(|size: &[u32; 2]| size.iter().all(|n| (1..=65535).contains(n)))
        .ok_or_else(|| "give width and height as 640x480, each 1 to 65535".into())
}

fn four<T: std::str::FromStr>(text: &str) -> Option<[T; 4]> {
    let numbers: Vec<T> = text.split(',').map(|n| n.trim().parse().ok()).collect::<Option<_>>()?;
    numbers.try_into().ok()
}

pub(super) fn parse_crop(text: &str) -> Result<[f64; 4], String> {
    four(text)
        .filter(|[x0, x1, y0, y1]: &[f64; 4]| {
            let unit = 0.0..=1.0;
            x0 < x1 && y0 < y1 && [x0, x1, y0, y1].iter().all(|n| unit.contains(*n))
        })
        .ok_or_else(|| "give x0,x1,y0,y1 with 0 ≤ x0 < x1 ≤ 1 and 0 ≤ y0 < y1 ≤ 1".into())
}

pub(super) fn parse_bounds(text: &str) -> Result<[u32; 4], String> {
    four(text)
        .filter(|[x0, x1, y0, y1]: &[u32; 4]| x0 < x1 && y0 < y1)
        .ok_or_else(|| "give pixels x0,x1,y0,y1 with x0 < x1 and y0 < y1".into())
}

pub(super) fn parse_number(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "give a number".into())
}

pub(super) fn parse_noise(text: &str) -> Result<f64, String> {
    let share = ajar_scene::parse_percent(text)?;
    if share > 0.0 { Ok(share) } else { Err("give a share greater than 0".into()) }
}

/// The name of an image: what is no OpenEXR file must not be called otherwise, nor the preview beside it the same.
pub(super) fn parse_exr(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_exr = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("exr"));
    if is_exr { Ok(path) } else { Err("give a name that ends with .exr; the PNG goes beside it".into()) }
}

pub(super) fn parse_fps(text: &str) -> Result<f64, String> {
    parse_number(text).ok().filter(|fps| *fps > 0.0).ok_or_else(|| "give a number greater than 0".into())
}

pub(super) fn parse_bytes(text: &str) -> Result<u64, String> {
    let (number, unit) = text.split_at(text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len()));
    let shift = match unit.trim().to_ascii_uppercase().as_str() {
        "" | "B" => Some(0),
        "K" | "KB" | "KIB" => Some(10),
        "M" | "MB" | "MIB" => Some(20),
        "G" | "GB" | "GIB" => Some(30),
        _ => None,
    };
    let bytes = shift.and_then(|shift| number.parse::<u64>().ok()?.checked_mul(1 << shift));
    bytes.ok_or_else(|| "give a size as 512M or 8G".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(parse_size("640x480"), Ok([640, 480]));
        assert_eq!(parse_size("1X65535"), Ok([1, 65535]));
        for bad in ["", "640", "0x480", "65536x1", "-1x2", "640x480x3", "6 40x480"] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn parts_of_the_frame() {
        assert_eq!(parse_crop("0, 0.5,0,1"), Ok([0.0, 0.5, 0.0, 1.0]));
        for bad in
            ["", "0,1,0", "0,1,0,1,0", "0.5,0.5,0,1", "0,1.1,0,1", "-0.1,1,0,1", "nan,1,0,1", "0,1,1,0"]
        {
            assert!(parse_crop(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_bounds("0,1,2,3"), Ok([0, 1, 2, 3]));
        for bad in ["0,0,2,3", "0,1,3,2", "0,1,2", "-1,1,2,3", "0.5,1,2,3"] {
            assert!(parse_bounds(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn moments() {
        assert_eq!(parse_number("-1.5"), Ok(-1.5));
        assert_eq!(parse_fps("29.97"), Ok(29.97));
        for bad in ["", "nan", "inf", "1e999", "1 s"] {
            assert!(parse_number(bad).is_err(), "{bad}");
        }
        assert!(parse_fps("0").is_err() && parse_fps("-1").is_err());
    }

    #[test]
    fn noise_and_names() {
        assert_eq!(parse_noise("2%"), Ok(0.02));
        assert!(parse_noise("0").is_err() && parse_noise("0%").is_err() && parse_noise("nan").is_err());
        assert_eq!(parse_exr("a/b.####.EXR"), Ok("a/b.####.EXR".into()));
        for bad in ["a.png", "exr", ".exr", "a", ""] {
            assert!(parse_exr(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn memory() {
        assert_eq!(parse_bytes("512M"), Ok(512 << 20));
        assert_eq!(parse_bytes("8 GiB"), Ok(8 << 30));
        assert_eq!(parse_bytes("17"), Ok(17));
        for bad in ["", "G", "-1G", "1.5G", "8X", "99999999999999999999", "99999999999G"] {
            assert!(parse_bytes(bad).is_err(), "{bad}");
        }
    }
}
