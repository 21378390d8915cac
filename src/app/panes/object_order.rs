//! Filter and order of the list of objects.

use egui::Ui;

use language::t;

use crate::state::called;
use scene::{Class, SceneBox};
use widgets::theme;

/// The order of the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum ObjectOrder {
    /// By class, then by number.
    #[default]
    Class,
    /// The nearest to the ego vehicle first.
    Distance,
    /// By number.
    Number,
    /// By name.
    Name,
}

const ORDERS: [(ObjectOrder, &str); 4] = [
    (ObjectOrder::Class, "By class"),
    (ObjectOrder::Distance, "Nearest first"),
    (ObjectOrder::Number, "By number"),
    (ObjectOrder::Name, "By name"),
];

/// Order and filter of the list.
#[derive(Clone, Debug, Default)]
pub(super) struct Listing {
    order: ObjectOrder,
    words: String,
}

fn kept() -> egui::Id {
    egui::Id::unique("listing of objects")
}

/// Draws the field for the filter and the choice of the order, and keeps both.
pub(super) fn listing_ui(ui: &mut Ui) -> Listing {
    let mut listing: Listing = ui.data(|d| d.get_temp(kept())).unwrap_or_default();
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let field = egui::TextEdit::singleline(&mut listing.words)
            .hint_text(t("Filter: car, red, 12"))
            .desired_width((ui.available_width() - 112.0).max(60.0));
        ui.add(field).accessible_name(t("Filter the objects"));
        let name = ORDERS
            .iter()
            .find(|(order, _)| *order == listing.order)
            .map_or("", |(_, name)| t(name));
        egui::ComboBox::from_id_salt("order of objects")
            .width(ui.available_width())
            .truncate()
            .selected_text(name)
            .show_ui(ui, |ui| {
                for (order, name) in ORDERS {
                    ui.selectable_value(&mut listing.order, order, t(name));
                }
            })
            .response
            .accessible_name(t("Order of the objects"));
    });
    ui.add_space(theme::GAP / 2.0);
    ui.data_mut(|d| d.insert_temp(kept(), listing.clone()));
    listing
}

impl Listing {
    /// True if the words leave some boxes out.
    pub(super) fn filters(&self) -> bool {
        !self.words.trim().is_empty()
    }

    /// The listed boxes, in order; `ego_m` is the position of the ego vehicle, world frame, m.
    pub(super) fn listed<'a>(
        &self,
        boxes: impl Iterator<Item = &'a SceneBox>,
        ego_m: glam::DVec2,
    ) -> Vec<&'a SceneBox> {
        let words = self.words.to_lowercase();
        let words: Vec<&str> = words.split_whitespace().collect();
        let holds = |b: &&SceneBox| {
            let paint = b.label.paint.map_or("", |paint| paint.name());
            let own = format!("{} {}", called(b), t(&b.class.label()));
            let text = format!("{} {} {paint} {own} ", b.called(), b.class.label()).to_lowercase();
            let number = b.id.0.to_string();
            words
                .iter()
                .all(|w| text.contains(w) || number == w.trim_start_matches('#'))
        };
        let mut out: Vec<&SceneBox> = boxes.filter(holds).collect();
        let class = |b: &SceneBox| Class::OBJECTS.iter().position(|c| *c == b.class);
        match self.order {
            ObjectOrder::Class => out.sort_by_key(|b| (class(b), b.id)),
            ObjectOrder::Number => out.sort_by_key(|b| b.id),
            ObjectOrder::Name => out.sort_by_key(|b| (b.called().to_lowercase(), b.id)),
            ObjectOrder::Distance => {
                let away_m = |b: &SceneBox| b.center_m.truncate().distance(ego_m);
                out.sort_by(|a, b| away_m(a).total_cmp(&away_m(b)));
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};
    use scene::{BoxId, BoxLabel, BoxName, Paint};

    fn made(id: u32, class: Class, x: f64, name: &str, paint: Option<Paint>) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class,
            center_m: DVec3::new(x, 0.0, 0.0),
            size_m: DVec3::ONE,
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: BoxLabel {
                name: BoxName::new(name),
                paint,
            },
        }
    }

    #[test]
    fn words_filter_and_orders_sort() {
        let boxes = [
            made(1, Class::Bus, 30.0, "", None),
            made(2, Class::Car, 20.0, "taxi", Some(Paint::Yellow)),
            made(12, Class::Car, 5.0, "", Some(Paint::Red)),
        ];
        let ids = |order, words: &str| -> Vec<u32> {
            let listing = Listing {
                order,
                words: words.into(),
            };
            listing
                .listed(boxes.iter(), DVec2::ZERO)
                .iter()
                .map(|b| b.id.0)
                .collect()
        };
        assert_eq!(ids(ObjectOrder::Number, ""), [1, 2, 12]);
        assert_eq!(ids(ObjectOrder::Distance, ""), [12, 2, 1]);
        assert_eq!(ids(ObjectOrder::Name, ""), [1, 12, 2]);
        assert_eq!(ids(ObjectOrder::Class, "car"), [2, 12]);
        assert_eq!(ids(ObjectOrder::Class, "YELLOW taxi"), [2]);
        assert_eq!(ids(ObjectOrder::Class, "#12"), [12]);
        assert_eq!(ids(ObjectOrder::Class, "lorry"), [0; 0]);
    }
}
