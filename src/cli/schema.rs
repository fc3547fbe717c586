//! `ajar schema`.

use super::{Exit, print};

pub(super) fn run() -> Exit {
    print(ajar_scene::SCHEMA.trim_end());
    Exit::Ok
}
