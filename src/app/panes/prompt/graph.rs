//! The scene graph of a prompt: a picture of its relations, and fields to edit it.

use egui::accesskit::Role;
use egui::{Align2, FontId, Pos2, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use language::{t, tf};
use place::to_graph::Graphed;
use scene::Class;
use scene::graph::{GraphEdge, LaneRole, NodeKind, RelationKind, SceneGraph};
use widgets::icons::section;
use widgets::theme;

/// Height of a line of the picture, points.
const LINE: f32 = 19.0;

fn name_of(graph: &SceneGraph, id: u32) -> String {
    match graph.node(id).map(|n| &n.kind) {
        Some(NodeKind::Ego) => t("ego").into(),
        Some(NodeKind::Object(o)) => format!("{} {id}", t(&o.class.label())),
        Some(NodeKind::Lane { role, .. }) => role_name(*role),
        Some(NodeKind::Crossing { .. }) => t("crossing").into(),
        Some(NodeKind::Junction) => t("junction").into(),
        None => t("nothing").into(),
    }
}

fn role_name(role: LaneRole) -> String {
    let word = format!("{role:?}");
    let mut out = String::new();
    for c in word.chars() {
        if c.is_uppercase() && !out.is_empty() {
            out.push(' ');
        }
        out.extend(c.to_lowercase());
    }
    if let LaneRole::Ego | LaneRole::Left | LaneRole::Right | LaneRole::Oncoming = role {
        out += " lane";
    }
    t(&out).to_owned()
}

fn relation_name(r: RelationKind) -> String {
    t(&r.name().replace('_', " ")).to_owned()
}

/// One line of the picture: the objects that stand in a relation to a node.
#[derive(Debug, PartialEq)]
struct RelationRow {
    to: String,
    relation: String,
    /// Classes, with their number of objects.
    objects: Vec<(Class, usize)>,
}

/// Relations grouped by their target, in the order in which they come; last the objects without a relation.
fn rows(graph: &SceneGraph) -> Vec<RelationRow> {
    let mut keys: Vec<(u32, RelationKind, Option<u32>)> = Vec::new();
    let mut found: Vec<Vec<(Class, usize)>> = Vec::new();
    let count = |objects: &mut Vec<(Class, usize)>, class| match objects.iter_mut().find(|o| o.0 == class) {
        Some(object) => object.1 += 1,
        None => objects.push((class, 1)),
    };
    let class_of = |id: u32| match graph.node(id).map(|n| &n.kind) {
        Some(NodeKind::Object(o)) => Some(o.class),
        _ => None,
    };
    for edge in &graph.edges {
        let key = (edge.to, edge.relation, edge.and);
        let at = keys.iter().position(|k| *k == key).unwrap_or_else(|| {
            keys.push(key);
            found.push(Vec::new());
            keys.len() - 1
        });
        if let Some(class) = class_of(edge.from) {
            count(&mut found[at], class);
        }
    }
    let mut rows: Vec<RelationRow> = keys
        .into_iter()
        .zip(found)
        .filter(|(_, objects)| !objects.is_empty())
        .map(|((to, relation, and), objects)| {
            let to = name_of(graph, to);
            let to = match and {
                Some(id) => tf!("{one} and {other}", one = to, other = name_of(graph, id)),
                None => to,
            };
            let relation = relation_name(relation);
            RelationRow {
                to,
                relation,
                objects,
            }
        })
        .collect();
    let mut free = Vec::new();
    for (id, object) in graph.objects() {
        if !graph.edges.iter().any(|e| e.from == id) {
            count(&mut free, object.class);
        }
    }
    if !free.is_empty() {
        rows.push(RelationRow {
            to: t("anywhere").into(),
            relation: String::new(),
            objects: free,
        });
    }
    rows
}

/// Draws the relations: a line for each, with the objects of a class together.
pub(super) fn picture(ui: &mut Ui, graph: &SceneGraph) {
    let rows = rows(graph);
    let width = ui.available_width().max(120.0);
    let (rect, response) =
        ui.allocate_exact_size(vec2(width, rows.len() as f32 * LINE + 8.0), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, t("Scene graph")));
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, theme::RADIUS, theme::well());
    let font = FontId::proportional(11.5);
    let text = |at: Pos2, align, text: &str, color| painter.text(at, align, text, font.clone(), color);
    // Targets to the left, aligned at their ends; objects to the right.
    let (left, right) = (rect.left() + width * 0.32, rect.left() + width * 0.6);
    for (k, row) in rows.iter().enumerate() {
        let y = rect.top() + 4.0 + (k as f32 + 0.5) * LINE;
        text(pos2(left - 4.0, y), Align2::RIGHT_CENTER, &row.to, theme::text());
        let line = |from: f32, to: f32| {
            painter.line_segment([pos2(from, y), pos2(to, y)], Stroke::new(1.0, theme::text_weak()));
        };
        if row.relation.is_empty() {
            line(left, right - 4.0);
        } else {
            let middle = pos2((left + right) / 2.0 - 2.0, y);
            let name = text(middle, Align2::CENTER_CENTER, &row.relation, theme::text_weak());
            line(left, name.left() - 3.0);
            line(name.right() + 3.0, right - 4.0);
        }
        let mut x = right;
        for (class, n) in &row.objects {
            painter.circle_filled(pos2(x + 4.0, y), 4.0, theme::class_color(*class));
            let name = match n {
                1 => t(&class.label()).to_owned(),
                n => format!("{n} × {}", t(&class.label())),
            };
            x = text(
                pos2(x + 11.0, y),
                Align2::LEFT_CENTER,
                &name,
                theme::text_strong(),
            )
            .right()
                + 9.0;
        }
    }
}

/// Draws the objects with their classes. Returns the one that is to be placed again.
pub(super) fn nodes(ui: &mut Ui, graphed: &mut Graphed, made: bool) -> Option<u32> {
    let mut rolled = None;
    let mut gone = None;
    section(ui, t("Objects"));
    let ids: Vec<u32> = graphed.graph.objects().map(|o| o.0).take(60).collect();
    for id in ids {
        ui.horizontal(|ui| {
            let Some(node) = graphed.graph.nodes.iter_mut().find(|n| n.id == id) else {
                return;
            };
            if let NodeKind::Object(o) = &mut node.kind {
                let combo = egui::ComboBox::from_id_salt(("class of node", id))
                    .selected_text(format!("{} {id}", t(&o.class.label())))
                    .show_ui(ui, |ui| {
                        for class in Class::OBJECTS {
                            ui.selectable_value(&mut o.class, class, t(&class.label()));
                        }
                    });
                combo.response.widget_info(|| {
                    WidgetInfo::labeled(Role::ComboBox, true, tf!("Class of node {n}", n = id))
                });
            }
            let again = ui.add_enabled(made, egui::Button::new(t("Re-roll")).small());
            again.widget_info(|| WidgetInfo::labeled(Role::Button, made, tf!("Re-roll node {n}", n = id)));
            if again.clicked() {
                rolled = Some(id);
            }
            let out = ui.add(egui::Button::new("×").small());
            out.widget_info(|| WidgetInfo::labeled(Role::Button, true, tf!("Take out node {n}", n = id)));
            if out.clicked() {
                gone = Some(id);
            }
        });
    }
    if let Some(id) = gone {
        graphed.graph.nodes.retain(|n| n.id != id);
        graphed
            .graph
            .edges
            .retain(|e| e.from != id && e.to != id && e.and != Some(id));
        graphed
            .nodes
            .iter_mut()
            .for_each(|list| list.retain(|n| *n != id));
    }
    if ui.button(t("Add object")).clicked() {
        let node = place::to_graph::node_of(Class::Car);
        graphed.graph.add(node);
    }
    rolled
}

/// Draws the relations, each with its kind and its target.
pub(super) fn edges(ui: &mut Ui, graph: &mut SceneGraph) {
    section(ui, t("Relations"));
    let all: Vec<(u32, String)> = graph.nodes.iter().map(|n| (n.id, name_of(graph, n.id))).collect();
    let mut gone = None;
    for (k, e) in graph.edges.iter_mut().enumerate().take(80) {
        ui.horizontal_wrapped(|ui| {
            ends(
                ui,
                ("from", k),
                &mut e.from,
                &all,
                &tf!("From of relation {n}", n = k + 1),
            );
            let combo = egui::ComboBox::from_id_salt(("relation", k))
                .selected_text(relation_name(e.relation))
                .show_ui(ui, |ui| {
                    for r in RelationKind::ALL {
                        if r != RelationKind::Between || e.and.is_some() {
                            ui.selectable_value(&mut e.relation, r, relation_name(r));
                        }
                    }
                });
            combo
                .response
                .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, tf!("Relation {n}", n = k + 1)));
            ends(
                ui,
                ("to", k),
                &mut e.to,
                &all,
                &tf!("To of relation {n}", n = k + 1),
            );
            let out = ui.add(egui::Button::new("×").small());
            out.widget_info(|| {
                WidgetInfo::labeled(Role::Button, true, tf!("Take out relation {n}", n = k + 1))
            });
            if out.clicked() {
                gone = Some(k);
            }
        });
    }
    if let Some(k) = gone {
        graph.edges.remove(k);
    }
    let first = graph.objects().map(|o| o.0).next();
    let add = ui.add_enabled(first.is_some(), egui::Button::new(t("Add relation")));
    if add.clicked()
        && let Some(from) = first
    {
        graph
            .edges
            .push(GraphEdge::new(from, RelationKind::InFrontOf, SceneGraph::EGO));
    }
}

fn ends(ui: &mut Ui, salt: (&str, usize), id: &mut u32, all: &[(u32, String)], label: &str) {
    let shown = all
        .iter()
        .find(|n| n.0 == *id)
        .map_or(t("nothing"), |n| n.1.as_str());
    let combo = egui::ComboBox::from_id_salt(salt)
        .selected_text(shown)
        .show_ui(ui, |ui| {
            for (other, name) in all {
                ui.selectable_value(id, *other, name);
            }
        });
    combo
        .response
        .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, label));
}

#[cfg(test)]
mod tests {
    use super::*;
    use place::to_graph::to_graph;
    use words::describe::described;

    #[test]
    fn objects_of_one_relation_share_a_line() {
        let read =
            described("add 5 cone ( blocking ego_lane ) and 1 bus ( waiting crossing ) and 2 parked car")
                .expect("valid");
        let rows = rows(&to_graph(&read, 1).graph);
        let cones = rows.iter().filter(|r| r.objects == [(Class::TrafficCone, 5)]);
        assert_eq!(cones.map(|r| r.to.as_str()).collect::<Vec<_>>(), ["ego lane"]);
        assert!(
            rows.iter()
                .any(|r| r.to == "crossing" && r.objects == [(Class::Bus, 1)]),
            "{rows:?}"
        );
        assert!(rows.len() < 6, "{rows:?}");
    }
}
