//! Who may ask.

use std::net::{IpAddr, SocketAddr};

use axum::http::{HeaderMap, HeaderName, StatusCode, header, request::Parts};

use crate::token;

#[derive(Debug)]
pub(super) struct Access {
    pub token: String,
    /// Where the server listens.
    pub address: SocketAddr,
}

impl Access {
    /// The path that is asked for, after the token.
    ///
    /// # Errors
    /// How to answer who may not ask.
    pub fn check(&self, parts: &Parts) -> Result<String, StatusCode> {
        let host = single(&parts.headers, header::HOST).ok_or(StatusCode::BAD_REQUEST)?;
        if !self.is_own_name(host) {
            return Err(StatusCode::MISDIRECTED_REQUEST);
        }
        let has_origin = parts.headers.contains_key(header::ORIGIN);
        if has_origin && !self.is_own_page(parts) {
            return Err(StatusCode::FORBIDDEN);
        }
        let path = parts.uri.path().trim_start_matches('/');
        let (token, path) = path.split_once('/').ok_or(StatusCode::NOT_FOUND)?;
        if token::is_same(token, &self.token) { Ok(path.to_owned()) } else { Err(StatusCode::NOT_FOUND) }
    }

    /// Whether a page that this server sent is asking.
    pub fn is_own_page(&self, parts: &Parts) -> bool {
        let host = single(&parts.headers, header::HOST);
        let origin = single(&parts.headers, header::ORIGIN).and_then(|origin| origin.strip_prefix("http://"));
        host.is_some() && host == origin
    }

    /// Whether a browser that asks `host` means this server. Names other than `localhost` could have been made to lead here
    /// by a page that wants to read what only this machine may (DNS rebinding); addresses cannot.
    fn is_own_name(&self, host: &str) -> bool {
        let Some((name, port)) = split(host) else { return false };
        let name = name.trim_start_matches('[').trim_end_matches(']');
        let is_open = !self.address.ip().is_loopback();
        let is_name = name.parse::<IpAddr>().map_or(name == "localhost", |ip| is_open || ip.is_loopback());
        is_name && port == self.address.port()
    }
}

fn split(host: &str) -> Option<(&str, u16)> {
    match host.rsplit_once(':') {
        Some((name, port)) if !port.ends_with(']') => Some((name, port.parse().ok()?)),
        _ => Some((host, 80)),
    }
}

/// The value of a header that is there once.
fn single(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    let mut values = headers.get_all(name).iter();
    let value = values.next()?.to_str().ok();
    value.filter(|_| values.next().is_none())
}
