//! The bytes of buffers, from the binary chunk, data URIs and files, and views into them.

use std::{cell::RefCell, collections::HashMap};

use ajar_scene::{Cause, Diagnostic, Severity};
use gltf::json::{Root, buffer::Buffer};

use super::{Context, at, container::Bytes, meshopt, uri};

/// All buffers. One that cannot be had is an error only for what needs it.
pub(super) struct Buffers {
    loaded: Vec<Result<Bytes, Diagnostic>>,
    /// Buffer views that were compressed, or made of what was, by index.
    decoded: HashMap<usize, Result<Vec<u8>, Diagnostic>>,
    asked_for: RefCell<Vec<bool>>,
}

/// Bytes of a buffer view.
pub(super) struct View<'a> {
    /// All of the view.
    pub bytes: &'a [u8],
    /// Distance of elements, where the view states one.
    pub stride: Option<usize>,
}

impl Buffers {
    /// Reads all buffers and decodes their compressed views; `binary` is the GLB's chunk, which belongs to the first buffer if that has no URI.
    ///
    /// # Errors
    /// Only the memory limit.
    pub fn load(root: &Root, mut binary: Option<Bytes>, context: &mut Context) -> Result<Self, Diagnostic> {
        let mut loaded = Vec::with_capacity(root.buffers.len());
        for (i, buffer) in root.buffers.iter().enumerate() {
            let chunk = if i == 0 { binary.take() } else { None };
            loaded.push(load(buffer, &format!("buffers[{i}]"), chunk, context));
        }
        let mut decoded = HashMap::new();
        for (i, view) in root.buffer_views.iter().enumerate() {
            match meshopt::decode(view, &loaded, context, &format!("bufferViews[{i}]")).transpose() {
                Some(Err(error)) if error.cause == Cause::Resource => return Err(error),
                Some(found) => drop(decoded.insert(i, found)),
                None => {}
            }
        }
        let asked_for = RefCell::new(vec![false; loaded.len()]);
        Ok(Self { loaded, decoded, asked_for })
    }

    /// The bytes of `bufferViews[index]`, which `element` refers to.
    ///
    /// # Errors
    /// The buffer cannot be had or the view reaches beyond it.
    pub fn view(&self, root: &Root, index: usize, element: &str) -> Result<View<'_>, Diagnostic> {
        let view = at(&root.buffer_views, index, "bufferViews", element)?;
        let buffer = view.buffer.value();
        if let Some(asked) = self.asked_for.borrow_mut().get_mut(buffer) {
            *asked = true;
        }
        let stride = view.byte_stride.map(|stride| stride.0);
        if let Some(decoded) = self.decoded.get(&index) {
            return Ok(View { bytes: decoded.as_ref().map_err(Clone::clone)?, stride });
        }
        let element = format!("bufferViews[{index}]");
        let bytes = at(&self.loaded, buffer, "buffers", &element)?.as_ref().map_err(Clone::clone)?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = start.checked_add(view.byte_length.0);
        let range = end.and_then(|end| Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
        let bytes = range.and_then(|range| bytes.get(range)).ok_or_else(|| {
            let (length, total) = (view.byte_length.0, bytes.len());
            let message =
                format!("{length} bytes from {start} on reach beyond buffers[{buffer}] of {total} bytes");
            Diagnostic::error(message).element(element)
        })?;
        Ok(View { bytes, stride })
    }

    /// Makes `bytes` the content of the new `bufferViews[index]`.
    pub fn add(&mut self, index: usize, bytes: Vec<u8>) {
        self.decoded.insert(index, Ok(bytes));
    }

    /// Warns about buffers that cannot be had and that nothing asked for.
    pub fn check_unused(&self, context: &mut Context) {
        for (buffer, asked) in self.loaded.iter().zip(self.asked_for.borrow().iter()) {
            if let (Err(error), false) = (buffer, asked) {
                context.report.add(Diagnostic { severity: Severity::Warning, ..error.clone() });
            }
        }
    }
}

fn load(
    buffer: &Buffer,
    element: &str,
    chunk: Option<Bytes>,
    context: &mut Context,
) -> Result<Bytes, Diagnostic> {
    let source = format!("{element}.uri");
    let mut bytes = match (&buffer.uri, chunk) {
        (Some(uri), _) => match uri::data(uri, context, &source)? {
            Some(bytes) => bytes.into(),
            None => {
                let path = uri::file(uri, context, &source)?;
                uri::read_file(&path, context, &source)?.into()
            }
        },
        (None, Some(chunk)) => chunk,
        (None, None) => {
            return Err(Diagnostic::error("the buffer has neither URI nor binary chunk").element(element));
        }
    };
    let stated = buffer.byte_length.0;
    match usize::try_from(stated) {
        Ok(stated) if stated <= bytes.len() => bytes.truncate(stated),
        _ => {
            let message = format!("the buffer is shorter than it says: {} of {stated} bytes", bytes.len());
            return Err(Diagnostic::error(message).element(element));
        }
    }
    Ok(bytes)
}
