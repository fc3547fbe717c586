//! How long a file takes up to the scene graph, for `tools/bench/usd.py`.
//!
//! Usage: `import FILE`. Prints seconds on the clock. That the program starts, and lets the scene go again, does not count.

use std::{error::Error, io::Write, path::Path, time::Instant};

use ajar_scene::ImportRequest;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: import FILE")?;
    let start = Instant::now();
    let imported =
        ajar_importers::import(&ImportRequest::new(Path::new(&path))).map_err(|e| e.to_string())?;
    let time = start.elapsed();
    drop(imported);
    writeln!(std::io::stdout(), "{}", time.as_secs_f64())?;
    Ok(())
}
