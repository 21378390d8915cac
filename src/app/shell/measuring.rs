//! Performance measurements of the application: when the frames of `perf.rs` begin and end.

use std::path::Path;

use serde_json::json;

use super::app::SceneloomApp;
use super::trace::Trace;

impl SceneloomApp {
    /// Writes measurements to a file from now on. Errors name the file.
    pub fn trace_to(&mut self, path: &Path) -> anyhow::Result<()> {
        let adapter = self.views.render_state.as_ref().map(|s| s.adapter.get_info());
        let first = json!({
            "kind": "start",
            "version": env!("CARGO_PKG_VERSION"),
            "scene": &*self.document.scene().name,
            "boxes": self.document.scene().frame().boxes.len(),
            "cores": std::thread::available_parallelism().map_or(1, usize::from),
            "adapter": adapter.map(|a| a.name),
        });
        self.frames.perf.trace = Some(Trace::start(path, self.frames.clock, &first)?);
        Ok(())
    }

    /// Notes that a frame begins. `before_s` is the time of the last frame by the window system, s.
    pub(crate) fn frame_begins(&mut self, before_s: Option<f32>) {
        let (clock, render_state) = (self.frames.clock, &self.views.render_state);
        let wait = || {
            if let Some(state) = render_state {
                // A lost device is noticed later, when the view is drawn.
                let _ = state.device.poll(wgpu::PollType::wait_indefinitely());
            }
            clock.elapsed().as_secs_f64()
        };
        let now_s = clock.elapsed().as_secs_f64();
        self.frames
            .perf
            .frame_begins(now_s, before_s.map(f64::from), wait);
    }

    /// Shows the edits of this frame in the same frame: the panels are laid out again, and only that pass is painted.
    /// Returns false if the window does not lay them out again (it has already done so). Generation, sensors and checks
    /// learn of the edit in the second pass.
    pub(crate) fn show_at_once(&mut self, ctx: &egui::Context) -> bool {
        if ctx.current_pass_index() > 0 {
            return false;
        }
        ctx.request_discard("the scene was edited");
        if !ctx.will_discard() {
            return false;
        }
        self.frames.perf.shown_at_once();
        true
    }

    /// Notes that a frame was drawn and the user's commands were carried out.
    pub(crate) fn frame_drawn(&mut self, ctx: &egui::Context, edited: bool) {
        let events = ctx.input(|i| i.raw.events.len());
        let working = self.generation.live.running.is_some();
        let active =
            self.files.opening.is_some() || !self.sensors_are_current() || self.document.is_dragging();
        let now_s = self.now_s();
        if self.frames.perf.drawn(now_s, events, edited, active, working) {
            ctx.request_repaint();
        }
    }
}
