//! The panes of the window, one file each, and the table of all panes. Dock, menus, command palette and settings read
//! it.

pub(crate) mod areas;
mod bev;
mod box_menu;
pub mod box_outlines;
pub mod box_views;
mod camera;
mod camera_difference;
mod camera_header;
mod camera_legend;
pub mod camera_strip;
mod cameras;
pub mod checks;
pub mod compare;
pub mod comparing;
pub mod conditions;
mod group_list;
pub mod history;
pub mod id;
mod label;
pub mod lidar;
mod modelled;
mod motion_menu;
mod object_order;
pub mod objects;
pub mod pane;
mod perception;
pub mod pointed;
pub mod prompt;
mod radar;
mod saved_brushes;
mod splats;
mod statistics;
mod sweep_picture;
mod thing_list;
mod things;
pub(crate) mod timeline;
pub mod tools;
pub mod trade;
pub mod versions;
mod view3d;

use std::sync::LazyLock;

use pane::{Pane, PaneInfo};

/// Number of cameras that have a pane of their own.
const CAMERAS: u8 = 6;

/// Every pane, in the order of the menus.
pub fn all() -> Vec<Box<dyn Pane>> {
    let mut table: Vec<Box<dyn Pane>> = vec![
        Box::new(bev::Bev),
        Box::new(view3d::View3dPane),
        Box::new(cameras::Cameras),
        Box::new(lidar::Lidar::default()),
        Box::new(radar::Radar),
        Box::new(splats::Splats::default()),
        Box::new(box_views::BoxViews::default()),
        Box::new(prompt::PromptPane),
        Box::new(versions::VersionsPane),
        Box::new(tools::Tools),
        Box::new(objects::Objects),
        Box::new(history::History),
        Box::new(trade::Trade),
        Box::new(checks::Checks),
        Box::new(perception::Perception::default()),
        Box::new(statistics::Statistics::default()),
        Box::new(timeline::Timeline::default()),
    ];
    table.extend((0..CAMERAS).map(|i| Box::new(camera::Camera::new(i)) as Box<dyn Pane>));
    table
}

/// The description of every pane, in the same order.
pub fn infos() -> &'static [PaneInfo] {
    static INFOS: LazyLock<Vec<PaneInfo>> = LazyLock::new(|| {
        let info = |pane: &dyn Pane| PaneInfo {
            id: pane.id(),
            title: pane.title(),
            icon: pane.icon(),
            place: pane.place(),
            column_points: pane.column_points(),
        };
        all().iter().map(|pane| info(pane.as_ref())).collect()
    });
    &INFOS
}

/// The description of one pane; `None` if no pane has this name.
pub fn info(id: id::PaneId) -> Option<&'static PaneInfo> {
    infos().iter().find(|info| info.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_titles_are_told_apart() {
        for (i, a) in infos().iter().enumerate() {
            for b in &infos()[i + 1..] {
                assert!(a.id != b.id && a.title != b.title, "{a:?} {b:?}");
            }
            assert!(!a.title.is_empty() && !a.id.name().is_empty());
        }
    }
}
