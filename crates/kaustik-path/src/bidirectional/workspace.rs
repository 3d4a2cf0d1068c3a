//! Memory for the two subpaths of one evaluation.

use std::cell::Cell;

use super::vertex::PathVertex;

/// Both subpaths. Scratch only: nothing that is in it survives a call, so that values stay a
/// function of the coordinates; what is kept from call to call is the memory.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    pub(super) light: Subpath,
    pub(super) eye: Subpath,
}

thread_local! {
    /// One for each thread and not one for each value: populations keep thousands of values.
    static WORKSPACE: Cell<Option<Box<Workspace>>> = const { Cell::new(None) };
}

impl Workspace {
    /// Runs `work` with the thread's memory; a call within a call has memory of its own.
    pub(super) fn with<T>(work: impl FnOnce(&mut Self) -> T) -> T {
        let mut workspace = WORKSPACE.take().unwrap_or_default();
        workspace.light.clear();
        workspace.eye.clear();
        let result = work(&mut workspace);
        WORKSPACE.set(Some(workspace));
        result
    }
}

/// Vertices in a row, behind them slots that were used before.
#[derive(Debug, Default)]
pub(super) struct Subpath {
    slots: Vec<PathVertex>,
    len: usize,
}

impl Subpath {
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// The slot for the next vertex; it counts only after [`keep`](Self::keep).
    #[inline]
    pub(super) fn next(&mut self) -> &mut PathVertex {
        if self.len == self.slots.len() {
            self.slots.push(PathVertex::default());
        }
        &mut self.slots[self.len]
    }

    /// Keeps what was written into the next slot.
    #[inline]
    pub(super) fn keep(&mut self) {
        self.len += 1;
    }

    /// The vertices, from the subpath's end inwards.
    #[inline]
    pub(super) fn vertices(&self) -> &[PathVertex] {
        &self.slots[..self.len]
    }

    /// The last vertex kept, of which there must be one.
    #[inline]
    pub(super) fn last_mut(&mut self) -> &mut PathVertex {
        &mut self.slots[self.len - 1]
    }
}
