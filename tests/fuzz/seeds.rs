//! Writes the seeds of all targets into the folder `corpus` beside this file, where cargo-fuzz looks for them.

use std::{fs, io, path::Path};

fn main() -> io::Result<()> {
    for target in ajar_fuzz::TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target.name());
        fs::create_dir_all(&folder)?;
        for (number, seed) in ajar_fuzz::seeds::of(target).iter().enumerate() {
            fs::write(folder.join(format!("seed{number}")), seed)?;
        }
    }
    Ok(())
}
