//! The page of `ajar watch`: plain files that the program carries with it.

use ajar_live::server::Asset;

const HTML: &str = "text/html; charset=utf-8";
const CSS: &str = "text/css; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// The files of the page.
pub const ASSETS: &[Asset] = &[
    Asset { name: "", kind: HTML, text: include_str!("index.html") },
    Asset { name: "style.css", kind: CSS, text: include_str!("style.css") },
    Asset { name: "main.js", kind: SCRIPT, text: include_str!("main.js") },
    Asset { name: "camera.js", kind: SCRIPT, text: include_str!("camera.js") },
    Asset { name: "clipboard.js", kind: SCRIPT, text: include_str!("clipboard.js") },
    Asset { name: "compare.js", kind: SCRIPT, text: include_str!("compare.js") },
    Asset { name: "keys.js", kind: SCRIPT, text: include_str!("keys.js") },
    Asset { name: "layer.js", kind: SCRIPT, text: include_str!("layer.js") },
    Asset { name: "link.js", kind: SCRIPT, text: include_str!("link.js") },
    Asset { name: "panel.js", kind: SCRIPT, text: include_str!("panel.js") },
    Asset { name: "picture.js", kind: SCRIPT, text: include_str!("picture.js") },
    Asset { name: "pointer.js", kind: SCRIPT, text: include_str!("pointer.js") },
    Asset { name: "screen.js", kind: SCRIPT, text: include_str!("screen.js") },
    Asset { name: "shader.js", kind: SCRIPT, text: include_str!("shader.js") },
    Asset { name: "status.js", kind: SCRIPT, text: include_str!("status.js") },
    Asset { name: "variants.js", kind: SCRIPT, text: include_str!("variants.js") },
];
