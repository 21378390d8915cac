//! Flight through a view: the pointer turns the head, keys move. Keys are read by their position on the keyboard, not
//! by their label, so W A S D are under one hand on a French keyboard too.

use std::collections::BTreeSet;

use egui::{Context, Event, Id, Key, Ui};
use glam::DVec3;

use viewport::ViewCamera;

/// Turn per point that the pointer moves, rad.
const TURN_RAD: f64 = 0.0036;
/// Speed of flight, m/s.
const FLY_MPS: f64 = 14.0;

/// The keys of flight that are down, named as on a US keyboard.
type Down = BTreeSet<Key>;

fn id() -> Id {
    Id::unique("keys of flight")
}

/// True for the keys that steer.
pub fn steers(physical: Key) -> bool {
    matches!(physical, Key::W | Key::A | Key::S | Key::D | Key::Q | Key::E)
}

/// Notes the keys that went down or up; to be called in each frame.
pub fn note(ctx: &Context) {
    let (changes, focused) = ctx.input(|i| {
        let change = |event: &Event| match event {
            Event::Key {
                key,
                physical_key,
                pressed,
                ..
            } => Some((physical_key.unwrap_or(*key), *pressed)),
            _ => None,
        };
        let changes: Vec<(Key, bool)> = i.events.iter().filter_map(change).collect();
        (changes, i.focused)
    });
    ctx.data_mut(|data| {
        let down: &mut Down = data.get_temp_mut_or_default(id());
        if !focused {
            // No event comes when a key is released in another window.
            down.clear();
        }
        for (key, pressed) in changes {
            if pressed && steers(key) {
                down.insert(key);
            } else {
                down.remove(&key);
            }
        }
    });
}

/// The direction that the keys steer: right, up and ahead, each -1 to 1.
fn way(ctx: &Context) -> DVec3 {
    let down: Down = ctx.data(|data| data.get_temp(id())).unwrap_or_default();
    let axis = |plus, minus| f64::from(i8::from(down.contains(&plus)) - i8::from(down.contains(&minus)));
    DVec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S))
}

/// Turns the head by a movement of the pointer, points, and moves by the keys: faster with Shift, slower with Alt.
pub fn fly(ui: &Ui, camera: &mut ViewCamera, dx: f64, dy: f64) {
    camera.turn_head(dx * TURN_RAD, dy * TURN_RAD);
    let (modifiers, dt) = ui.input(|i| (i.modifiers, f64::from(i.stable_dt.min(0.1))));
    let pace = match (modifiers.shift, modifiers.alt) {
        (true, _) => 4.0,
        (false, true) => 0.25,
        (false, false) => 1.0,
    };
    camera.fly(way(ui.ctx()) * (FLY_MPS * pace * dt));
    ui.ctx().request_repaint();
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, RawInput};

    fn frame(ctx: &Context, events: Vec<Event>, focused: bool) -> DVec3 {
        let input = RawInput {
            events,
            focused,
            ..Default::default()
        };
        let mut out = DVec3::ZERO;
        let _ = ctx.run_ui(input, |ui| {
            note(ui.ctx());
            out = way(ui.ctx());
        });
        out
    }

    fn key(key: Key, physical_key: Option<Key>, pressed: bool) -> Event {
        Event::Key {
            key,
            physical_key,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    #[test]
    fn keys_count_by_where_they_lie() {
        let ctx = Context::default();
        // On a French keyboard Z lies where W is, and Q where A is.
        let ahead = frame(&ctx, vec![key(Key::Z, Some(Key::W), true)], true);
        assert_eq!(ahead, DVec3::Z);
        let left_too = frame(&ctx, vec![key(Key::Q, Some(Key::A), true)], true);
        assert_eq!(left_too, DVec3::new(-1.0, 0.0, 1.0));
        // Keys stay down until they are released.
        assert_eq!(frame(&ctx, Vec::new(), true), left_too);
        let left = frame(&ctx, vec![key(Key::Z, Some(Key::W), false)], true);
        assert_eq!(left, -DVec3::X);
        // The key labelled W has another position on that keyboard.
        assert_eq!(frame(&ctx, vec![key(Key::W, Some(Key::Z), true)], true), left);
        assert_eq!(frame(&ctx, Vec::new(), false), DVec3::ZERO);
        // If the system does not report the physical key, the label counts.
        assert_eq!(frame(&ctx, vec![key(Key::E, None, true)], true), DVec3::Y);
    }
}
