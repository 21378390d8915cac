//! Folders for data outside of scenes: settings, and state such as copies of unsaved scenes and the log.

use std::path::PathBuf;

use etcetera::BaseStrategy as _;
use etcetera::base_strategy::choose_native_strategy;

/// Folder of settings: `SCENELOOM_CONFIG_DIR`, else `sceneloom` in the user's folder for settings; `None` without such
/// a folder.
pub fn settings() -> Option<PathBuf> {
    match std::env::var_os("SCENELOOM_CONFIG_DIR") {
        Some(folder) => Some(PathBuf::from(folder)),
        None => Some(choose_native_strategy().ok()?.config_dir().join("sceneloom")),
    }
}

/// Folder of state: `SCENELOOM_STATE_DIR`, else `sceneloom` in the user's folder for state; `None` without such a
/// folder.
pub fn state() -> Option<PathBuf> {
    let own = std::env::var_os("SCENELOOM_STATE_DIR").filter(|v| !v.is_empty());
    own.map(PathBuf::from).or_else(|| {
        let users = choose_native_strategy().ok()?;
        let folder = users.state_dir().unwrap_or_else(|| users.data_dir());
        Some(folder.join("sceneloom"))
    })
}
