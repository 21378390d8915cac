//! Names of camera sources and of the views that they give.

/// Name of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SourceId(&'static str);

impl SourceId {
    /// The source of that name.
    pub const fn new(name: &'static str) -> Self {
        Self(name)
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        self.0
    }
}

impl Default for SourceId {
    /// The source from which the window renders classes and depths.
    fn default() -> Self {
        super::shapes::ID
    }
}

/// Name of a view, the content of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ViewId(&'static str);

impl ViewId {
    /// Classes; several sources give them.
    pub const SEMANTIC: ViewId = ViewId::new("semantic");
    /// Distance along the optical axis; several sources give it.
    pub const DEPTH: ViewId = ViewId::new("depth");

    /// The view of that name.
    pub const fn new(name: &'static str) -> Self {
        Self(name)
    }

    /// Name on the command line and in file names.
    pub fn name(self) -> &'static str {
        self.0
    }
}

impl Default for ViewId {
    fn default() -> Self {
        Self::SEMANTIC
    }
}

/// A setting that belongs to a view, beside what its source needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knob {
    /// Depth of the plane that is shown.
    PlaneDepth,
}

/// Content of a picture, as menus offer it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SourceView {
    /// Its name.
    pub id: ViewId,
    /// Name on a button.
    pub title: &'static str,
    /// Description for the tip of the button.
    pub hint: &'static str,
    /// A setting of the window that decides what is shown.
    pub knob: Option<Knob>,
}

impl SourceView {
    /// A view without a setting of its own.
    pub const fn new(id: ViewId, title: &'static str, hint: &'static str) -> Self {
        Self {
            id,
            title,
            hint,
            knob: None,
        }
    }
}

/// The views that maps of classes and depths give.
pub(super) const MAP_VIEWS: &[SourceView] = &[
    SourceView::new(ViewId::SEMANTIC, "Semantic", "classes"),
    SourceView::new(ViewId::DEPTH, "Depth", "2 m warm to 60 m cold"),
];
