//! The stack of a tree walk: in place for every sane tree, on the heap for degenerate ones.

use std::mem::MaybeUninit;

const INLINE: usize = 192;

/// Memory for a stack, not yet written.
pub(super) struct Space {
    inline: [MaybeUninit<u64>; INLINE],
    heap: Vec<MaybeUninit<u64>>,
}

impl Space {
    /// Room for `need` entries.
    #[inline(always)]
    pub(super) fn new(need: usize) -> Self {
        let heap = if need > INLINE { vec![MaybeUninit::uninit(); need] } else { Vec::new() };
        Self { inline: [MaybeUninit::uninit(); INLINE], heap }
    }

    #[inline(always)]
    pub(super) fn stack(&mut self) -> Stack<'_> {
        let entries = if self.heap.is_empty() { &mut self.inline[..] } else { &mut self.heap[..] };
        Stack { entries, len: 0 }
    }
}

/// Entries on top of each other. Everything below `len` has been written.
pub(super) struct Stack<'a> {
    entries: &'a mut [MaybeUninit<u64>],
    len: usize,
}

impl Stack<'_> {
    #[inline(always)]
    pub(super) fn len(&self) -> usize {
        self.len
    }

    #[inline(always)]
    pub(super) fn push(&mut self, entry: u64) {
        self.entries[self.len].write(entry);
        self.len += 1;
    }

    #[inline(always)]
    pub(super) fn pop(&mut self) -> Option<u64> {
        self.len = self.len.checked_sub(1)?;
        // SAFETY: `len` was one more, so `push` has written this entry.
        Some(unsafe { self.entries[self.len].assume_init() })
    }

    /// Pushes, keeping what lies from `bottom` up in descending order.
    #[inline(always)]
    pub(super) fn push_sorted(&mut self, entry: u64, bottom: usize) {
        self.push(entry);
        let mut i = self.len - 1;
        while i > bottom {
            // SAFETY: `i - 1` is below `len`, so `push` has written this entry.
            let below = unsafe { self.entries[i - 1].assume_init() };
            if below >= entry {
                break;
            }
            self.entries[i].write(below);
            i -= 1;
        }
        self.entries[i].write(entry);
    }
}
