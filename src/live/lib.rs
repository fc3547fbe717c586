//! What a program needs to show an image while it comes to be, and to begin again when files change. Parts without policy:
//! they know neither scenes nor renders.

pub mod files;
pub mod frame;
pub mod server;
pub mod tev;
pub mod token;
