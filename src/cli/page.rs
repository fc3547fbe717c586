//! The page of `ajar watch`: where it is and who may see it.

use std::{
    fs, io,
    net::{IpAddr, Ipv4Addr, SocketAddr},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::Duration,
};

use ajar_live::{
    server::{Options, Server},
    token,
};
use ajar_scene::{Cause, Diagnostic, Severity};

use super::log::Format;
use crate::{viewer, watch::Watch};

/// Where the page is if nothing else has the port.
const PORT: u16 = 7347;
/// Most pages at once.
const PAGES: usize = 16;
/// How long a connection may say nothing that makes it one of a page, and a page read nothing.
const PATIENCE: Duration = Duration::from_secs(10);

#[derive(Clone, Debug, clap::Args)]
pub(super) struct Door {
    /// Port of the page [default: that of last time, 7347, or any that is free]
    #[arg(long, value_name = "N")]
    port: Option<u16>,
    /// Open the page in the browser
    #[arg(long)]
    open: bool,
    /// Serve the page at this address of this machine, to all who can reach it and know the link
    #[arg(long, value_name = "ADDRESS")]
    listen: Option<IpAddr>,
}

/// Serves the page.
///
/// # Errors
/// The address is taken or not of this machine.
pub(super) fn open(door: &Door, scene: &Path, watch: &Watch<'_>, log: Format) -> Result<Server, Diagnostic> {
    let ip = door.listen.unwrap_or(Ipv4Addr::LOCALHOST.into());
    if !ip.is_loopback() {
        let warning =
            format!("the page is served at {ip}: who can reach it and knows the link sees and steers it");
        let hint = "the link is not encrypted on its way; on a network you do not trust, tunnel to 127.0.0.1 instead";
        log.messages(&[Diagnostic::warning(warning).hint(hint)], Severity::Warning);
    }
    let memory = memory(scene);
    let token =
        secret(memory.as_deref()).map_err(|e| refused("make a secret for the link of the page", &e))?;
    let (stage, program) = watch.for_pages();
    let start = |port| {
        let options = Options {
            address: SocketAddr::new(ip, port),
            token: token.clone(),
            pages: PAGES,
            patience: PATIENCE,
        };
        Server::start(options, viewer::ASSETS, &stage, program.clone())
    };
    let server = match door.port {
        Some(port) => start(port),
        None => any(start, memory.map(|file| file.with_extension("port")).as_deref()),
    };
    let server = server.map_err(|e| refused(&format!("serve the page at {ip}"), &e))?;
    if door.open && !browse(&server.url()) {
        let note = Diagnostic::warning("no browser could be opened").hint("open the link yourself");
        log.messages(&[note], Severity::Warning);
    }
    Ok(server)
}

fn refused(what: &str, error: &io::Error) -> Diagnostic {
    Diagnostic::error(format!("cannot {what}: {error}")).because(Cause::System)
}

/// The file that keeps the secret for a scene, so that pages which are open find the program again, and only theirs.
fn memory(scene: &Path) -> Option<PathBuf> {
    let folder = |name: &str| std::env::var_os(name).filter(|it| !it.is_empty()).map(PathBuf::from);
    let state = folder("XDG_STATE_HOME").or_else(|| Some(folder("HOME")?.join(".local/state")))?;
    let path = scene.canonicalize().or_else(|_| std::path::absolute(scene)).ok()?;
    let name = blake3::hash(path.as_os_str().as_encoded_bytes()).to_hex();
    Some(state.join("ajar/watch").join(&name[..16]))
}

/// The secret in the link, the same as last time where it can be kept.
fn secret(memory: Option<&Path>) -> io::Result<String> {
    match memory.map(token::kept) {
        Some(Ok(token)) => Ok(token),
        _ => token::new(),
    }
}

/// Starts at the port of last time, which `memory` holds, else at the usual one, else at any.
fn any(start: impl Fn(u16) -> io::Result<Server>, memory: Option<&Path>) -> io::Result<Server> {
    let last = memory.and_then(|file| fs::read_to_string(file).ok()?.trim().parse().ok());
    let known = last.into_iter().chain([PORT]);
    let server = known.map(&start).find_map(Result::ok).map_or_else(|| start(0), Ok)?;
    if let Some(file) = memory {
        // It is a convenience.
        let _ = fs::write(file, server.address().port().to_string());
    }
    Ok(server)
}

/// Opens the link in the browser of the desktop.
fn browse(url: &str) -> bool {
    let program = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
    let mut command = Command::new(program);
    command.arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}
