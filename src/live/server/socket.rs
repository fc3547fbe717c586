//! What goes over a WebSocket: to the page documents as text and frames as binary messages; from the page texts.
//!
//! A binary message holds, as little-endian u32, width and height of the frame, 1 if it is the last message of the frame, and
//! a number of tiles; then each tile's number and bytes (`crate::frame`). Only tiles that the page does not have are sent.

use std::{sync::Arc, time::Duration};

use axum::extract::{
    WebSocketUpgrade,
    ws::{Message, WebSocket},
};
use tokio::{
    sync::{mpsc, watch},
    time::timeout,
};

use super::{Program, Reply, Shown};
use crate::frame::Frame;

/// Longest text that a page may send, bytes.
const LONGEST_TEXT: usize = 64 << 10;
/// About the longest message to a page, bytes.
const LONGEST_FRAME: usize = 384 << 10;
/// Answers that wait for a page.
const ANSWERS: usize = 64;

/// With bounds on what is received.
pub(super) fn limited(upgrade: WebSocketUpgrade) -> WebSocketUpgrade {
    upgrade.max_message_size(LONGEST_TEXT).max_frame_size(LONGEST_TEXT)
}

/// Speaks with a page until it leaves, breaks the rules or takes longer than `patience` to read a message. A page that is
/// slower than the frames come misses some.
pub(super) async fn converse(
    socket: WebSocket,
    patience: Duration,
    mut shown: watch::Receiver<Shown>,
    program: Arc<dyn Program>,
) {
    let mut page = Page { socket, patience };
    let (replies, mut answers) = mpsc::channel(ANSWERS);
    let mut seen = Shown::default();
    shown.mark_changed();
    loop {
        let goes_on = tokio::select! {
            message = page.socket.recv() => match message {
                Some(Ok(Message::Text(text))) => program.command(text.as_str().to_owned(), Reply(replies.clone())),
                Some(Ok(Message::Ping(_) | Message::Pong(_))) => true,
                Some(Ok(Message::Binary(_) | Message::Close(_)) | Err(_)) | None => false,
            },
            Some(answer) = answers.recv() => page.send(Message::text(answer)).await,
            changed = shown.changed() => changed.is_ok() && {
                let now = shown.borrow_and_update().clone();
                let sent = page.update(&now, &seen).await;
                seen = now;
                sent
            },
        };
        if !goes_on {
            return;
        }
    }
}

struct Page {
    socket: WebSocket,
    patience: Duration,
}

impl Page {
    async fn update(&mut self, now: &Shown, seen: &Shown) -> bool {
        for document in &now.documents {
            let is_known = seen.documents.iter().any(|known| Arc::ptr_eq(known, document));
            if !is_known && !self.send(Message::text(&**document)).await {
                return false;
            }
        }
        if Arc::ptr_eq(&now.frame, &seen.frame) {
            return true;
        }
        for message in messages(&now.frame, Some(&seen.frame), LONGEST_FRAME) {
            if !self.send(Message::binary(message)).await {
                return false;
            }
        }
        true
    }

    async fn send(&mut self, message: Message) -> bool {
        matches!(timeout(self.patience, self.socket.send(message)).await, Ok(Ok(())))
    }
}

/// The messages that turn the `earlier` frame into `frame`, each of about `longest` bytes; at least one.
pub(super) fn messages<'a>(
    frame: &'a Frame,
    earlier: Option<&'a Frame>,
    longest: usize,
) -> impl Iterator<Item = Vec<u8>> {
    let mut tiles = frame.changes(earlier).peekable();
    let mut is_over = false;
    std::iter::from_fn(move || {
        if is_over {
            return None;
        }
        let (mut bytes, mut count) = (vec![0; 16], 0);
        while bytes.len() < longest
            && let Some((index, tile)) = tiles.next()
        {
            bytes.extend((index as u32).to_le_bytes());
            bytes.extend_from_slice(tile);
            count += 1;
        }
        is_over = tiles.peek().is_none();
        let header = [frame.width() as u32, frame.height() as u32, is_over.into(), count];
        bytes[..16].copy_from_slice(&header.map(u32::to_le_bytes).concat());
        Some(bytes)
    })
}
