//! The dock: the tree of panes, ready-made workspaces, and moving of panes. `dock_ui.rs` draws it.

use std::collections::HashSet;

use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles, Tree};

pub use super::workspace::Workspace;
use crate::panes;
use crate::panes::id::PaneId;
use crate::panes::pane::PanePlacement;

/// Direction in which a pane is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Split {
    /// The new pane stands to the right.
    Right,
    /// The new pane stands below.
    Down,
}

/// Largest width of a column of panels in a wide window, as a multiple of the width that its texts need.
const WIDEST: f32 = 1.4;

/// Share of a narrow window that all columns of panels get together.
const NARROW: f32 = 0.5;

/// The arrangement of the panes.
#[derive(Clone, PartialEq)]
pub struct Dock {
    pub(crate) tree: Tree<PaneId>,
    /// The tile that is alone on screen, if any.
    pub(crate) maximized: Option<TileId>,
    /// Width that the side columns were fitted to, points.
    fitted: f32,
    /// True for a new arrangement, false for one from an earlier session, in which the user may have set the widths.
    fresh: bool,
}

impl Default for Dock {
    fn default() -> Self {
        Self::workspace(Workspace::Edit)
    }
}

impl Dock {
    /// A ready-made arrangement.
    pub fn workspace(workspace: Workspace) -> Self {
        use LinearDir::{Horizontal, Vertical};
        let mut t = Tiles::default();
        let root = match workspace {
            Workspace::Edit => {
                let views = row(&mut t, Horizontal, &[(PaneId::BEV, 1.0), (PaneId::VIEW3D, 1.0)]);
                let strip = t.insert_pane(PaneId::CAMERAS);
                let center = join(&mut t, Vertical, &[(views, 700.0), (strip, 150.0)]);
                framed(&mut t, center)
            }
            Workspace::Paint => {
                let (bev, view, strip) = (
                    t.insert_pane(PaneId::BEV),
                    t.insert_pane(PaneId::VIEW3D),
                    t.insert_pane(PaneId::of_camera(1)), // of the bundled rigs: the front camera
                );
                let side = join(&mut t, Vertical, &[(view, 1.0), (strip, 1.0)]);
                let center = join(&mut t, Horizontal, &[(bev, 2.0), (side, 1.0)]);
                framed(&mut t, center)
            }
            Workspace::Voxels => {
                let (bev, view, boxes) = (
                    t.insert_pane(PaneId::BEV),
                    t.insert_pane(PaneId::VIEW3D),
                    t.insert_pane(PaneId::BOX_VIEWS),
                );
                let side = join(&mut t, Vertical, &[(bev, 1.0), (boxes, 1.0)]);
                let center = join(&mut t, Horizontal, &[(view, 2.2), (side, 1.0)]);
                framed(&mut t, center)
            }
            Workspace::Sensors => {
                let rows: Vec<TileId> = [[0, 1, 2], [5, 4, 3]] // order of the rig: front row, then back
                    .map(|cameras| row(&mut t, Horizontal, &cameras.map(|c| (PaneId::of_camera(c), 1.0))))
                    .to_vec();
                let rays = row(&mut t, Horizontal, &[(PaneId::LIDAR, 2.0), (PaneId::RADAR, 1.0)]);
                let views = row(&mut t, Vertical, &[(PaneId::BEV, 1.0), (PaneId::VIEW3D, 1.0)]);
                let cameras = join(&mut t, Vertical, &[(rows[0], 1.0), (rows[1], 1.0), (rays, 1.0)]);
                join(&mut t, Horizontal, &[(cameras, 2.0), (views, 1.0)])
            }
            Workspace::Clip => {
                let views = row(&mut t, Horizontal, &[(PaneId::BEV, 1.0), (PaneId::VIEW3D, 1.0)]);
                let (time, strip) = (t.insert_pane(PaneId::TIMELINE), t.insert_pane(PaneId::CAMERAS));
                let center = join(&mut t, Vertical, &[(views, 500.0), (time, 220.0), (strip, 140.0)]);
                framed(&mut t, center)
            }
            Workspace::Trade => {
                let views = row(&mut t, Horizontal, &[(PaneId::BEV, 1.0), (PaneId::VIEW3D, 1.0)]);
                let strip = t.insert_pane(PaneId::CAMERAS);
                let center = join(&mut t, Vertical, &[(views, 700.0), (strip, 150.0)]);
                let (tools, trade) = (t.insert_pane(PaneId::TOOLS), t.insert_pane(PaneId::TRADE));
                join(
                    &mut t,
                    Horizontal,
                    &[(tools, 232.0), (center, 940.0), (trade, 430.0)],
                )
            }
            Workspace::Label => {
                let views = row(&mut t, Horizontal, &[(PaneId::BEV, 1.0), (PaneId::VIEW3D, 1.0)]);
                let boxes = t.insert_pane(PaneId::BOX_VIEWS);
                let strip = t.insert_pane(PaneId::CAMERAS);
                let center = join(
                    &mut t,
                    Vertical,
                    &[(views, 440.0), (boxes, 240.0), (strip, 150.0)],
                );
                framed(&mut t, center)
            }
        };
        Self {
            tree: Tree::new(egui::Id::unique("dock"), root, t),
            maximized: None,
            fitted: 0.0,
            fresh: true,
        }
    }

    /// The dock of an earlier session. `None` if it is invalid: empty, a pane twice, not a tree (a tile within itself
    /// would be walked without end), or a share that is not a number. Panes that this version does not have are left
    /// out.
    pub fn from_kept(mut tree: Tree<PaneId>) -> Option<Self> {
        if !is_tree(&tree) {
            return None;
        }
        let is_unknown = |(id, tile): (&TileId, &Tile<PaneId>)| match tile {
            Tile::Pane(pane) if panes::info(*pane).is_none() => Some(*id),
            _ => None,
        };
        let unknown: Vec<TileId> = tree.tiles.iter().filter_map(is_unknown).collect();
        for tile in unknown {
            tree.remove_recursively(tile);
        }
        let dock = Self {
            tree,
            maximized: None,
            fitted: 0.0,
            fresh: false,
        };
        let panes: Vec<PaneId> = dock.all().map(|(_, pane)| pane).collect();
        let distinct: HashSet<PaneId> = panes.iter().copied().collect();
        (!panes.is_empty() && distinct.len() == panes.len() && dock.tree.root.is_some()).then_some(dock)
    }

    /// Fits the columns of panels to a width of the window, once for each width, so widths that the user drags
    /// afterwards stay. A column gets at least the width that its texts need, and in a fresh dock not much more. In a
    /// narrow window the columns share half of it.
    pub fn fit(&mut self, width: f32) {
        if width == self.fitted || width <= 0.0 {
            return;
        }
        self.fitted = width;
        let Some(Tile::Container(Container::Linear(root))) =
            self.tree.root.and_then(|r| self.tree.tiles.get(r))
        else {
            return;
        };
        if root.dir != LinearDir::Horizontal {
            return;
        }
        let children = root.children.clone();
        let shares: Vec<f32> = children.iter().map(|c| root.shares[*c]).collect();
        let needed: Vec<f32> = children.iter().map(|c| self.width_needed(*c)).collect();
        let (all, sides): (f32, f32) = (shares.iter().sum(), needed.iter().sum());
        // The width of a column that must change: the width it needs, or the largest useful width.
        let most = if self.fresh { WIDEST } else { f32::INFINITY };
        let given = |i: usize| {
            let (has, needs) = (shares[i] / all * width, needed[i]);
            match needs > 0.0 {
                true if has < needs => Some(needs),
                true if has > most * needs => Some(most * needs),
                _ => None,
            }
        };
        let mut given: Vec<Option<f32>> = (0..children.len()).map(given).collect();
        if sides > NARROW * width {
            // In a narrow window the columns get half of it; wider contents are scrolled.
            let share = |needs: &f32| (*needs > 0.0).then_some(needs / sides * NARROW * width);
            given = needed.iter().map(share).collect();
        }
        if all <= 0.0 || given.iter().all(Option::is_none) || given.iter().all(Option::is_some) {
            return;
        }
        // The other children keep their proportions in the rest.
        let taken: f32 = given.iter().flatten().sum();
        let left = given.iter().zip(&shares).filter(|(given, _)| given.is_none());
        let others: f32 = left.map(|(_, share)| share).sum();
        let rest = |share: f32| share / others.max(1e-6) * (width - taken);
        let new: Vec<f32> = given
            .iter()
            .zip(&shares)
            .map(|(given, share)| given.unwrap_or_else(|| rest(*share)))
            .collect();
        let root = self.tree.root.and_then(|r| self.tree.tiles.get_mut(r));
        if let Some(Tile::Container(Container::Linear(root))) = root {
            for (child, share) in children.iter().zip(new) {
                root.shares.set_share(*child, share);
            }
        }
    }

    /// Width that a column of panels needs, points; 0 for views, which take any width.
    fn width_needed(&self, tile: TileId) -> f32 {
        let mut open = vec![tile];
        let mut needed: f32 = 0.0;
        while let Some(id) = open.pop() {
            match self.tree.tiles.get(id) {
                Some(Tile::Pane(pane)) => match panes::info(*pane).map_or(0.0, |p| p.column_points) {
                    points if points > 0.0 => needed = needed.max(points),
                    _ => return 0.0,
                },
                Some(Tile::Container(c)) => open.extend(c.children()),
                None => {}
            }
        }
        needed
    }

    /// The tree, to be saved.
    pub fn tree(&self) -> &Tree<PaneId> {
        &self.tree
    }

    fn all(&self) -> impl Iterator<Item = (TileId, PaneId)> + '_ {
        let pane = |(id, tile): (&TileId, &Tile<PaneId>)| match tile {
            Tile::Pane(pane) => Some((*id, *pane)),
            Tile::Container(_) => None,
        };
        self.tree.tiles.iter().filter_map(pane)
    }

    /// The tile that holds a pane.
    pub fn find(&self, pane: PaneId) -> Option<TileId> {
        self.all().find(|(_, p)| *p == pane).map(|(id, _)| id)
    }

    /// True if the pane is on screen: not behind another tab, nor behind a maximized pane.
    pub fn is_shown(&self, pane: PaneId) -> bool {
        self.find(pane).is_some_and(|id| match self.maximized {
            Some(large) => large == id,
            None => self.tree.active_tiles().contains(&id),
        })
    }

    /// Puts a pane into a tile. If it is elsewhere already, the two panes swap.
    pub fn put(&mut self, tile: TileId, pane: PaneId) {
        let other = self.find(pane).filter(|id| *id != tile);
        let Some(Tile::Pane(here)) = self.tree.tiles.get_mut(tile) else {
            return;
        };
        let before = std::mem::replace(here, pane);
        if let Some(Tile::Pane(there)) = other.and_then(|id| self.tree.tiles.get_mut(id)) {
            *there = before;
        }
    }

    /// Swaps two panes. A pane that is not in the dock takes the other's place.
    pub fn swap(&mut self, a: PaneId, b: PaneId) {
        match (self.find(a), self.find(b)) {
            (Some(tile), _) => self.put(tile, b),
            (None, Some(tile)) => self.put(tile, a),
            (None, None) => {}
        }
    }

    /// Divides a tile. The new half shows a pane that is not in the dock yet.
    pub fn split(&mut self, tile: TileId, split: Split, pane: PaneId) {
        if self.find(pane).is_some() {
            return;
        }
        let dir = match split {
            Split::Right => LinearDir::Horizontal,
            Split::Down => LinearDir::Vertical,
        };
        let tiles = &mut self.tree.tiles;
        let parent = tiles.parent_of(tile);
        let new = tiles.insert_pane(pane);
        let both = tiles.insert_container(Linear::new(dir, vec![tile, new]));
        match parent {
            Some(parent) => {
                if let Some(Tile::Container(container)) = tiles.get_mut(parent) {
                    let _was_there = container.replace_child(tile, both);
                }
            }
            None => self.tree.root = Some(both),
        }
        self.maximized = None;
    }

    /// Closes a tile; the last one stays.
    pub fn close(&mut self, tile: TileId) {
        if self.all().count() > 1 {
            self.tree.remove_recursively(tile);
            self.maximized = None;
        }
    }

    /// Brings a pane to the front, or opens it: a panel in the column of panels, a list of findings below the views,
    /// any other pane below the largest view.
    pub fn open(&mut self, pane: PaneId) {
        self.maximized = None;
        if self.find(pane).is_some() {
            self.tree
                .make_active(|_, tile| matches!(tile, Tile::Pane(p) if *p == pane));
            return;
        }
        let opened = match panes::info(pane).map(|p| p.place) {
            Some(PanePlacement::BelowViews) => self.open_below_views(pane),
            Some(PanePlacement::Column | PanePlacement::ColumnAtOnce) => self.open_in_column(pane),
            Some(PanePlacement::BelowView) | None => false,
        };
        if opened {
            return;
        }
        let beside = [PaneId::VIEW3D, PaneId::BEV, PaneId::CAMERAS]
            .into_iter()
            .find_map(|p| self.find(p));
        if let Some(tile) = beside.or_else(|| self.all().next().map(|(id, _)| id)) {
            self.split(tile, Split::Down, pane);
        }
    }

    /// Shows a pane, or closes it if it is on screen.
    pub fn toggle(&mut self, pane: PaneId) {
        match self.find(pane).filter(|_| self.is_shown(pane)) {
            Some(tile) => self.close(tile),
            None => self.open(pane),
        }
    }

    /// Adds panels that did not exist yet when this dock was saved, if it has the column for them. An arrangement of
    /// views only is left as it is.
    pub fn with_new_panes(mut self, known: &[PaneId]) -> Self {
        // Docks of the first versions do not say which panes they knew.
        let known = if known.is_empty() { &FIRST } else { known };
        for pane in panes::infos() {
            let is_new = pane.place == PanePlacement::ColumnAtOnce && !known.contains(&pane.id);
            if is_new && self.find(pane.id).is_none() {
                self.open_in_column(pane.id);
            }
        }
        self
    }

    /// Opens a pane in the column that holds panels of the right side already. Returns false if there is none.
    fn open_in_column(&mut self, pane: PaneId) -> bool {
        let in_column = |p: &&panes::pane::PaneInfo| p.place.is_column();
        let places: Vec<(TileId, TileId)> = panes::infos()
            .iter()
            .filter(in_column)
            .filter_map(|p| self.find(p.id).and_then(|id| self.vertical_over(id)))
            .collect();
        // Below the lowest of them.
        let row = |(column, child): &(TileId, TileId)| match self.tree.tiles.get(*column) {
            Some(Tile::Container(c)) => c.children().position(|id| id == child),
            _ => None,
        };
        let Some((column, beside)) = places.into_iter().max_by_key(row) else {
            return false;
        };
        self.insert_after(column, beside, pane, 0.22);
        true
    }

    /// Opens a pane below the row of large views, so that it hides no part of them. Returns false if there is no such
    /// row.
    fn open_below_views(&mut self, pane: PaneId) -> bool {
        let of_views = |p: PaneId| self.find(p).and_then(|id| self.vertical_over(id));
        let Some((column, views)) = [PaneId::BEV, PaneId::VIEW3D].into_iter().find_map(of_views) else {
            return false;
        };
        self.insert_after(column, views, pane, 0.24);
        true
    }

    /// The nearest vertical container above a tile, and its child that holds the tile.
    fn vertical_over(&self, tile: TileId) -> Option<(TileId, TileId)> {
        let mut child = tile;
        while let Some(parent) = self.tree.tiles.parent_of(child) {
            if let Some(Tile::Container(Container::Linear(linear))) = self.tree.tiles.get(parent)
                && linear.dir == LinearDir::Vertical
            {
                return Some((parent, child));
            }
            child = parent;
        }
        None
    }

    /// Puts a pane below another child of a column, with this share of its height.
    fn insert_after(&mut self, column: TileId, child: TileId, pane: PaneId, share: f32) {
        let new = self.tree.tiles.insert_pane(pane);
        let Some(Tile::Container(Container::Linear(linear))) = self.tree.tiles.get_mut(column) else {
            return;
        };
        let at = linear
            .children
            .iter()
            .position(|c| *c == child)
            .map_or(0, |i| i + 1);
        let all: f32 = linear.children.iter().map(|c| linear.shares[*c]).sum();
        linear.children.insert(at, new);
        linear.shares.set_share(new, all * share / (1.0 - share));
    }

    /// Tiles that are tabs; the tab bar shows their names.
    pub(crate) fn tabbed(&self) -> HashSet<TileId> {
        let tabs = self.tree.tiles.tiles().filter_map(|tile| match tile {
            Tile::Container(Container::Tabs(tabs)) => Some(tabs.children.iter().copied()),
            _ => None,
        });
        tabs.flatten().collect()
    }

    /// Shows a tile alone, or all tiles again.
    pub fn toggle_maximized(&mut self, tile: TileId) {
        self.maximized = (self.maximized != Some(tile)).then_some(tile);
    }

    /// The first pane of the table that is not in the dock.
    pub fn first_absent(&self) -> Option<PaneId> {
        panes::infos()
            .iter()
            .map(|p| p.id)
            .find(|id| self.find(*id).is_none())
    }
}

fn row<const N: usize>(tiles: &mut Tiles<PaneId>, dir: LinearDir, panes: &[(PaneId, f32); N]) -> TileId {
    let ids = panes.map(|(pane, share)| (tiles.insert_pane(pane), share));
    join(tiles, dir, &ids)
}

fn join(tiles: &mut Tiles<PaneId>, dir: LinearDir, parts: &[(TileId, f32)]) -> TileId {
    let mut linear = Linear::new(dir, parts.iter().map(|(id, _)| *id).collect());
    for (id, share) in parts {
        linear.shares.set_share(*id, *share);
    }
    tiles.insert_container(Container::Linear(linear))
}

/// Puts the tools on the left and the objects on the right of `center`.
fn framed(tiles: &mut Tiles<PaneId>, center: TileId) -> TileId {
    let tools = tiles.insert_pane(PaneId::TOOLS);
    let (objects, prompt) = (
        tiles.insert_pane(PaneId::OBJECTS),
        tiles.insert_pane(PaneId::PROMPT),
    );
    // History and versions share tabs, because the objects and the prompt need the height.
    let past = [PaneId::HISTORY, PaneId::VERSIONS].map(|pane| tiles.insert_pane(pane));
    let past = tiles.insert_tab_tile(past.to_vec());
    let column = join(
        tiles,
        LinearDir::Vertical,
        &[(objects, 2.35), (prompt, 1.7), (past, 0.8)],
    );
    let parts = [(tools, 232.0), (center, 1100.0), (column, 268.0)];
    join(tiles, LinearDir::Horizontal, &parts)
}

/// Panes of the column that existed in the first versions.
const FIRST: [PaneId; 3] = [PaneId::OBJECTS, PaneId::PROMPT, PaneId::VERSIONS];

/// True if every tile is reached from the root at most once, and every child exists.
fn is_tree(tree: &Tree<PaneId>) -> bool {
    let (mut seen, mut open) = (HashSet::new(), Vec::from_iter(tree.root));
    while let Some(id) = open.pop() {
        match tree.tiles.get(id) {
            _ if !seen.insert(id) => return false,
            None => return false,
            Some(Tile::Pane(_)) => {}
            Some(Tile::Container(c)) => {
                if let Container::Linear(linear) = c
                    && linear.shares.iter().any(|(_, s)| !(s.is_finite() && *s >= 0.0))
                {
                    return false;
                }
                open.extend(c.children());
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn workspaces_hold_each_pane_once_and_survive_being_kept() {
        for (workspace, name) in Workspace::ALL {
            let dock = Dock::workspace(workspace);
            let text = serde_json::to_string(dock.tree()).expect("plain data");
            let back = serde_json::from_str(&text).expect("the same");
            assert!(
                Dock::from_kept(back).is_some_and(|kept| kept.tree == dock.tree),
                "{name}"
            );
        }
        let mut twice = Dock::default();
        let tile = twice.find(PaneId::BEV).expect("there");
        twice.tree.tiles.insert(tile, Tile::Pane(PaneId::VIEW3D));
        assert!(Dock::from_kept(twice.tree).is_none());
    }

    #[test]
    fn a_pane_of_another_version_is_left_out() {
        let mut tree = Dock::default().tree;
        let tile = Dock::default().find(PaneId::CAMERAS).expect("there");
        tree.tiles.insert(tile, Tile::Pane(PaneId::named("of_tomorrow")));
        let dock = Dock::from_kept(tree).expect("the others stay");
        assert!(dock.find(PaneId::named("of_tomorrow")).is_none());
        assert!(dock.find(PaneId::BEV).is_some() && dock.find(PaneId::CAMERAS).is_none());
    }

    #[test]
    fn panels_get_the_width_that_they_need() {
        let widths = |dock: &Dock, width: f32| -> Vec<f32> {
            let root = dock.tree.root.and_then(|r| dock.tree.tiles.get(r));
            let Some(Tile::Container(Container::Linear(root))) = root else {
                panic!("a row")
            };
            let all: f32 = root.children.iter().map(|c| root.shares[*c]).sum();
            root.children
                .iter()
                .map(|c| root.shares[*c] / all * width)
                .collect()
        };
        let mut dock = Dock::default();
        dock.fit(1280.0);
        let found = widths(&dock, 1280.0);
        assert!(
            (found[0] - 230.0).abs() < 1.0 && (found[2] - 266.0).abs() < 1.0,
            "{found:?}"
        );
        let mut wide = Dock::default();
        wide.fit(2560.0);
        let found = widths(&wide, 2560.0);
        let most = [230.0, 266.0].map(|needed| needed * WIDEST + 1.0);
        assert!(
            found[0] < most[0] && found[2] < most[1],
            "the views get the rest: {found:?}"
        );
        // A width that the user left stays.
        let mut kept = Dock::from_kept(Dock::default().tree).expect("sound");
        kept.fit(2560.0);
        assert_eq!(widths(&kept, 2560.0), widths(&Dock::default(), 2560.0));
    }

    #[test]
    fn a_tile_within_itself_is_refused() {
        let mut dock = Dock::default();
        let root = dock.tree.root.expect("there");
        let Some(Tile::Container(c)) = dock.tree.tiles.get_mut(root) else {
            panic!("a container");
        };
        c.add_child(root);
        assert!(Dock::from_kept(dock.tree).is_none());
        let mut dock = Dock::default();
        dock.tree.tiles.remove(dock.find(PaneId::BEV).expect("there"));
        assert!(Dock::from_kept(dock.tree).is_none(), "a child is missing");
    }

    #[test]
    fn panes_change_places_split_and_close() {
        let mut dock = Dock::default();
        let (bev, view) = (dock.find(PaneId::BEV), dock.find(PaneId::VIEW3D));
        dock.swap(PaneId::BEV, PaneId::VIEW3D);
        assert_eq!((dock.find(PaneId::VIEW3D), dock.find(PaneId::BEV)), (bev, view));
        assert!(!dock.is_shown(PaneId::LIDAR));
        dock.open(PaneId::LIDAR);
        assert!(dock.is_shown(PaneId::LIDAR));
        let sweep = dock.find(PaneId::LIDAR).expect("opened");
        dock.toggle_maximized(sweep);
        assert!(dock.is_shown(PaneId::LIDAR) && !dock.is_shown(PaneId::BEV));
        dock.close(sweep);
        assert!(dock.is_shown(PaneId::BEV) && dock.find(PaneId::LIDAR).is_none());
        for pane in [
            PaneId::TOOLS,
            PaneId::OBJECTS,
            PaneId::PROMPT,
            PaneId::VERSIONS,
            PaneId::HISTORY,
            PaneId::CAMERAS,
            PaneId::BEV,
            PaneId::VIEW3D,
        ] {
            let tile = dock.find(pane).expect("still there");
            dock.close(tile);
        }
        assert!(dock.find(PaneId::VIEW3D).is_some(), "the last pane stays");
    }
}
