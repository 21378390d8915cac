//! Comparison of two states of the scene in every view at once: by holding a key, by a wipe line, side by side, or by
//! marked differences.

use std::sync::Arc;

use egui::{Color32, ColorImage, CursorIcon, Rect, Sense, Stroke, Ui, pos2, vec2};

use scene::{Scene, SceneRev, VoxelGrid};

use super::camera_strip::CameraStrip;
pub use super::comparing::{CompareMode, CompareSettings};
use super::sweep_picture::SweepPicture;
use crate::bev_image::from_above;
use crate::camera_views::Wanted;
use crate::canvas::BevCanvas;
use crate::painting::PaintWish;
use crate::sensing::{Haste, Sensing};
use crate::view3d::View3d;
use language::{t, tf};
use viewport::MarkedVoxels;
use widgets::theme;

/// Voxels that differ between two grids.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VoxelDifference {
    /// Voxels that are occupied only in the later grid, `[x, y, z]`.
    pub added: Vec<[usize; 3]>,
    /// Voxels that are occupied only in the earlier grid.
    pub removed: Vec<[usize; 3]>,
    /// Voxels whose class differs.
    pub changed: Vec<[usize; 3]>,
}

/// Colours of added voxels, removed voxels, and voxels of another class.
pub(crate) const DIFFERENCE_COLORS: [[u8; 3]; 3] = [[70, 205, 110], [235, 70, 60], [240, 180, 60]];

impl VoxelDifference {
    /// Compares two grids, on the map of the later one.
    pub fn between(before: &VoxelGrid, after: &VoxelGrid) -> Self {
        let (before, mut out) = (before.crop(after.extent()), Self::default());
        for [x, y] in after.extent().all_columns() {
            let (a, b) = (before.column(x, y), after.column(x, y));
            if a == b {
                continue;
            }
            for z in (0..b.len()).filter(|z| a[*z] != b[*z]) {
                let free = scene::Class::FREE;
                let of_kind = match (a[z] == free, b[z] == free) {
                    (true, _) => &mut out.added,
                    (_, true) => &mut out.removed,
                    _ => &mut out.changed,
                };
                of_kind.push([x, y, z]);
            }
        }
        out
    }

    /// The legend: each colour with its number of voxels. Colours without voxels are left out.
    pub(crate) fn legend(&self) -> Vec<(Color32, String)> {
        let counts = [&self.added, &self.removed, &self.changed].map(|list| list.len());
        let texts = [
            tf!("{n} added", n = counts[0]),
            tf!("{n} removed", n = counts[1]),
            tf!("{n} of another class", n = counts[2]),
        ];
        let parts = DIFFERENCE_COLORS.iter().zip(counts).zip(texts);
        parts
            .filter(|((_, count), _)| *count > 0)
            .map(|(([r, g, b], _), text)| (Color32::from_rgb(*r, *g, *b), text))
            .collect()
    }

    /// The differing voxels with their colours, for the 3D view.
    pub(crate) fn marked(&self) -> [MarkedVoxels<'_>; 3] {
        let lists = [&self.added, &self.removed, &self.changed];
        std::array::from_fn(|i| MarkedVoxels {
            voxels: lists[i],
            color: DIFFERENCE_COLORS[i],
        })
    }

    /// Difference from above, a colour for each column: red where any voxel was removed, else green where any was
    /// added, else amber where any is of another class.
    fn image(before: &VoxelGrid, after: &VoxelGrid) -> ColorImage {
        let (before, free) = (before.crop(after.extent()), scene::Class::FREE);
        from_above(after.extent(), |x, y| {
            let (a, b) = (before.column(x, y), after.column(x, y));
            let any = |f: &dyn Fn(u8, u8) -> bool| a.iter().zip(b).any(|(a, b)| a != b && f(*a, *b));
            let kind = if any(&|a, b| a != free && b == free) {
                1
            } else if any(&|a, _| a == free) {
                0
            } else if any(&|_, _| true) {
                2
            } else {
                return Color32::TRANSPARENT;
            };
            let [r, g, b] = DIFFERENCE_COLORS[kind];
            Color32::from_rgba_unmultiplied(r, g, b, 200)
        })
    }
}

/// The reference state of a comparison, with its own bird's-eye view, 3D view, camera strip and sensors.
#[derive(Default)]
pub struct Compare {
    /// The version that the user chose to compare with; `None`: the one before the present version.
    pub chosen: Option<Arc<Scene>>,
    /// The reference state: what the present state is compared with, while there is a comparison.
    pub(crate) reference: Option<Arc<Scene>>,
    pub(crate) bev_view: BevCanvas,
    pub(crate) view3d: Option<View3d>,
    pub(crate) strip: CameraStrip,
    pub(crate) sweep: SweepPicture,
    pub(crate) sensing: Option<Sensing>,
    /// The state whose sensors were requested last.
    requested_rev: Option<SceneRev>,
    difference: Option<(SceneRev, SceneRev, VoxelDifference, egui::TextureHandle)>,
}

impl Compare {
    /// Sets the reference state and requests its pictures and sweep; without a state, or unless `senses`, stops
    /// painting.
    pub(crate) fn prepare(
        &mut self,
        reference: Option<Arc<Scene>>,
        wanted: Wanted,
        senses: bool,
        painting: &PaintWish,
        wake: impl Fn() + Send + Sync + 'static,
    ) {
        self.reference = reference;
        let scene = match &self.reference {
            Some(scene) if senses => scene,
            _ => {
                if let Some(sensing) = &mut self.sensing {
                    sensing.drain();
                    sensing.rest();
                }
                return;
            }
        };
        if self.sensing.is_none() {
            // Without a thread the cameras of the reference state stay empty; the views do not need them.
            self.sensing = Sensing::spawn(std::time::Duration::ZERO, wake).ok();
        }
        if let Some(sensing) = &mut self.sensing {
            // Pictures of another version are dropped before new ones come.
            if self.requested_rev.replace(scene.rev) != Some(scene.rev) {
                sensing.forget();
            }
            sensing.paint_with(painting);
            sensing.ask(scene, wanted, Haste::Rest);
            sensing.drain();
        }
    }

    /// Forgets the reference state and the results of its sensors, because another scene is opened.
    pub(crate) fn forget(&mut self) {
        (self.chosen, self.reference, self.requested_rev) = (None, None, None);
        (self.strip, self.sweep, self.difference) = Default::default();
        if let Some(sensing) = &mut self.sensing {
            sensing.forget();
        }
    }

    /// The voxels that differ between the reference state and `after`, with a picture of them; `None` without a
    /// comparison.
    pub(crate) fn difference(
        &mut self,
        ui: &Ui,
        after: &Scene,
    ) -> Option<(&VoxelDifference, egui::TextureId)> {
        let reference = self.reference.as_ref()?;
        let is_current = |(a, b, ..): &(SceneRev, SceneRev, _, _)| *a == reference.rev && *b == after.rev;
        if !self.difference.as_ref().is_some_and(is_current) {
            let (a, b) = (&reference.frame().occupancy, &after.frame().occupancy);
            let image = VoxelDifference::image(a, b);
            let texture = ui
                .ctx()
                .load_texture("difference", image, egui::TextureOptions::NEAREST);
            let found = VoxelDifference::between(a, b);
            self.difference = Some((reference.rev, after.rev, found, texture));
        }
        self.difference
            .as_ref()
            .map(|(_, _, found, texture)| (found, texture.id()))
    }

    /// The compare mode: off without a reference state, and while the key that shows it alone is held.
    pub(crate) fn mode(&self, settings: &CompareSettings) -> CompareMode {
        match &self.reference {
            Some(_) if !settings.holding_reference => settings.mode,
            _ => CompareMode::Off,
        }
    }

    /// True if the reference state is shown alone, because its key is held; `scene` is the scene this pane was given.
    pub(crate) fn shows_reference(&self, settings: &CompareSettings, scene: &Arc<Scene>) -> bool {
        settings.holding_reference && self.reference.as_ref().is_some_and(|r| Arc::ptr_eq(r, scene))
    }
}

/// The wipe line over a view; it can be dragged.
pub(crate) fn wipe_line(ui: &Ui, rect: Rect, settings: &mut CompareSettings) {
    let at = &mut settings.wipe_at;
    let x = rect.left() + rect.width() * *at;
    let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(14.0, rect.height()));
    let id = ui.scope_id().with("wipe");
    let response = ui.interact(grip, id, Sense::drag());
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if let (true, Some(p)) = (response.dragged(), response.interact_pointer_pos()) {
        *at = ((p.x - rect.left()) / rect.width().max(1.0)).clamp(0.02, 0.98);
    }
    let painter = ui.painter_at(rect);
    painter.vline(
        x,
        rect.y_range(),
        Stroke::new(3.0, Color32::from_black_alpha(120)),
    );
    painter.vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
    painter.circle(
        pos2(x, rect.center().y),
        6.0,
        theme::accent(),
        Stroke::new(1.5, Color32::WHITE),
    );
    let [reference, now] = settings.names();
    tag(ui, rect.left_top() + vec2(8.0, 8.0), reference, false);
    tag(ui, rect.right_top() + vec2(-8.0, 8.0), now, true);
}

/// Draws a legend in the upper left corner of a view, with as many rows as its width needs.
pub(crate) fn legend(ui: &Ui, at: egui::Pos2, entries: &[(Color32, String)]) {
    const SWATCH: f32 = 10.0;
    if entries.is_empty() {
        return tag(ui, at, t("no voxel differs"), false);
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let painter = ui.painter();
    let widest = (ui.clip_rect().right() - at.x - SWATCH - 30.0).max(40.0);
    let galleys: Vec<_> = entries
        .iter()
        .map(|(_, text)| painter.layout(text.clone(), font.clone(), theme::ON_CANVAS, widest))
        .collect();
    let height = galleys.iter().map(|g| g.size().y).fold(SWATCH, f32::max) + 6.0;
    let (mut places, mut next, mut width) = (Vec::new(), at + vec2(8.0, 0.0), 0.0_f32);
    for galley in &galleys {
        let size = vec2(SWATCH + 5.0 + galley.size().x, height);
        if next.x + size.x + 12.0 > ui.clip_rect().right() && next.x > at.x + 8.0 {
            next = pos2(at.x + 8.0, next.y + height);
        }
        places.push(Rect::from_min_size(next, size));
        next.x += size.x + 12.0;
        width = width.max(next.x - at.x - 4.0);
    }
    let rect = Rect::from_min_size(at, vec2(width, next.y + height - at.y));
    painter.rect_filled(rect, 3.0, Color32::from_black_alpha(190));
    for ((galley, (color, text)), place) in galleys.into_iter().zip(entries).zip(places) {
        let middle = place.left_center();
        let swatch = Rect::from_center_size(middle + vec2(SWATCH / 2.0, 0.0), vec2(SWATCH, SWATCH));
        painter.rect_filled(swatch, 2.0, *color);
        let left = middle + vec2(SWATCH + 5.0, -galley.size().y / 2.0);
        painter.galley(left, galley, theme::ON_CANVAS);
        let response = ui.interact(place, ui.scope_id().with(text), Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, text));
    }
}

/// A label in a corner of a view.
pub(crate) fn tag(ui: &Ui, at: egui::Pos2, text: &str, from_right: bool) {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = ui
        .painter()
        .layout_no_wrap(text.to_owned(), font, theme::ON_CANVAS);
    let size = galley.size() + vec2(10.0, 4.0);
    let min = if from_right { at - vec2(size.x, 0.0) } else { at };
    let rect = Rect::from_min_size(min, size);
    ui.painter()
        .rect_filled(rect, 3.0, Color32::from_black_alpha(170));
    ui.painter()
        .galley(rect.min + vec2(5.0, 2.0), galley, theme::ON_CANVAS);
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Class;

    /// Pictures and sweep are never of another state than the reference state, even if the pictures of that state take
    /// long.
    #[test]
    fn another_state_has_no_pictures_of_the_one_before() {
        use crate::open;
        use std::time::{Duration, Instant};

        let scenes = ["straight", "t-junction"]
            .map(|name| Arc::new(open::from_template(name, 3).expect("a template")));
        let mut compare = Compare::default();
        let wanted = Wanted::default();
        let prepare = |compare: &mut Compare, scene: &Arc<Scene>| {
            compare.prepare(Some(scene.clone()), wanted, true, &PaintWish::default(), || {});
        };
        let sensed = |compare: &Compare, rev: SceneRev| {
            let sensing = compare.sensing.as_ref().expect("a thread");
            !sensing.cameras_stale(rev) && !sensing.lidar_stale(rev)
        };
        let start = Instant::now();
        while !(compare.sensing.is_some() && sensed(&compare, scenes[0].rev)) {
            prepare(&mut compare, &scenes[0]);
            assert!(start.elapsed() < Duration::from_secs(120), "no pictures");
            std::thread::sleep(Duration::from_millis(2));
        }
        loop {
            prepare(&mut compare, &scenes[1]);
            let sensing = compare.sensing.as_ref().expect("a thread");
            assert!(sensing.cameras().is_none() || !sensing.cameras_stale(scenes[1].rev));
            assert!(sensing.lidar().is_none() || !sensing.lidar_stale(scenes[1].rev));
            if sensed(&compare, scenes[1].rev) {
                break;
            }
            assert!(start.elapsed() < Duration::from_secs(240), "no pictures");
            std::thread::sleep(Duration::from_millis(2));
        }
        compare.forget();
        assert!(compare.reference.is_none() && compare.sensing.is_some_and(|s| s.cameras().is_none()));
    }

    #[test]
    fn differences_are_counted_by_kind() {
        let mut before = VoxelGrid::new();
        before.set(1, 2, 3, Class::Car.id());
        before.set(4, 5, 6, Class::Car.id());
        let mut after = before.clone();
        assert_eq!(
            VoxelDifference::between(&before, &after),
            VoxelDifference::default()
        );
        after.set(1, 2, 3, Class::FREE);
        after.set(4, 5, 6, Class::Bus.id());
        after.set(7, 8, 9, Class::Bus.id());
        let found = VoxelDifference::between(&before, &after);
        assert_eq!(
            (&found.added[..], &found.removed[..]),
            (&[[7, 8, 9]][..], &[[1, 2, 3]][..])
        );
        assert_eq!(found.changed, [[4, 5, 6]]);
        let legend: Vec<String> = found.legend().into_iter().map(|(_, text)| text).collect();
        assert_eq!(legend, ["1 added", "1 removed", "1 of another class"]);
        // The colour of a column matches that of its voxels in 3D.
        let image = VoxelDifference::image(&before, &after);
        let drawn = |color: [u8; 3]| {
            let [r, g, b] = color;
            let color = Color32::from_rgba_unmultiplied(r, g, b, 200);
            image.pixels.iter().filter(|p| **p == color).count()
        };
        assert_eq!(DIFFERENCE_COLORS.map(drawn), [1, 1, 1]);
    }
}
