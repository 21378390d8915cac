//! The windows that are open over the panes, and their selections.

use super::capture::CaptureDialog;
use super::tour::Tour;

/// A sensor of the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SensorChoice {
    /// A camera, by index.
    Camera(usize),
    /// A LiDAR, by index.
    Lidar(usize),
    /// A radar, by index.
    Radar(usize),
}

impl Default for SensorChoice {
    fn default() -> Self {
        Self::Camera(0)
    }
}

/// The windows that are open.
#[derive(Clone, Debug, Default)]
pub struct OpenWindows {
    /// The log.
    pub log: bool,
    /// The sheet of keys.
    pub keys: bool,
    /// The settings.
    pub settings: bool,
    /// The start screen.
    pub start: bool,
    /// The tour of the first minutes; `None` while it is not running.
    pub tour: Option<Tour>,
    /// The dialog of pictures.
    pub capture: CaptureDialog,
    /// The window of the sensors.
    pub sensors: bool,
    /// The sensor chosen in that window.
    pub sensor: SensorChoice,
}

impl OpenWindows {
    /// Closes the one window that the user most likely looks at. Returns false if none is open.
    pub fn close_one(&mut self) -> bool {
        let all = [
            &mut self.capture.open,
            &mut self.settings,
            &mut self.sensors,
            &mut self.log,
        ];
        match all.into_iter().find(|open| **open) {
            Some(open) => {
                *open = false;
                true
            }
            None => false,
        }
    }
}
