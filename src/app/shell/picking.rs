//! Placing a scene on roads from a file: the user chooses a place in a window, then a scene is made there.

use std::path::PathBuf;

use crossbeam_channel::{TryRecvError, bounded};
use egui::{Context, Ui};

use super::app::{SceneloomApp, one_line};
use super::files::Picking;
use crate::windows::place_picker::{PlacePicker, place_picker};
use authoring::open;
use formats::import::scene_name;
use language::{t, tf};

impl SceneloomApp {
    /// Reads roads on a thread of its own, then asks for a place on them.
    pub(crate) fn pick_place(&mut self, path: PathBuf, ctx: &Context) {
        let (send, read) = bounded(1);
        let wake = ctx.clone();
        let make = move || {
            let network = open::road_network(&path)?;
            Ok(PlacePicker::new(network, scene_name(&path)))
        };
        let thread = runtime::guard::spawn("roads", make, move |picker| {
            // Sending fails if another scene was opened meanwhile.
            let _ = send.send(picker.unwrap_or_else(|panic| Err(panic.into())));
            wake.request_repaint();
        });
        match thread {
            Ok(_) => self.files.picking = Some(Picking::Reading(read)),
            Err(error) => self.fail(tf!("Not opened: {error}", error = error)),
        }
    }

    /// Draws the window that chooses the place, and makes the scene once it is chosen.
    pub(crate) fn picking_ui(&mut self, ui: &Ui) {
        match self.files.picking.take() {
            None => {}
            Some(Picking::Reading(read)) => match read.try_recv() {
                Err(TryRecvError::Empty) => self.files.picking = Some(Picking::Reading(read)),
                Err(TryRecvError::Disconnected) => {
                    self.fail(t("Not opened: reading it ended unexpectedly").to_owned())
                }
                Ok(Err(error)) => self.fail(tf!("Not opened: {error}", error = one_line(&error))),
                Ok(Ok(picker)) => self.files.picking = Some(Picking::Choosing(Box::new(picker))),
            },
            Some(Picking::Choosing(mut picker)) => {
                let mut open = true;
                if place_picker(ui, &mut picker, &mut open) {
                    let what = tf!("Making a scene on {name}", name = picker.name);
                    let make = move || {
                        let (placement, name) = (picker.placement(), picker.name.clone());
                        Ok(open::on_roads(picker.into_network(), &name, &placement).scene)
                    };
                    self.load(what, None, true, ui.ctx(), make);
                } else if open {
                    self.files.picking = Some(Picking::Choosing(picker));
                }
            }
        }
    }
}
