//! How a scene changes: document, undo, picking.
