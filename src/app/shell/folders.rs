//! Where the program keeps what is not a scene: settings, and state such as copies of unsaved scenes and the log.

use std::path::PathBuf;

use etcetera::BaseStrategy as _;
use etcetera::base_strategy::choose_native_strategy;

/// Settings: `SCENELOOM_CONFIG_DIR`, else `sceneloom` in the user's folder for settings; none if there is no such folder.
pub fn settings() -> Option<PathBuf> {
    match std::env::var_os("SCENELOOM_CONFIG_DIR") {
        Some(folder) => Some(PathBuf::from(folder)),
        None => Some(choose_native_strategy().ok()?.config_dir().join("sceneloom")),
    }
}

/// State: `SCENELOOM_STATE_DIR`, else `sceneloom` in the user's folder for state; none if there is no such folder.
pub fn state() -> Option<PathBuf> {
    let own = std::env::var_os("SCENELOOM_STATE_DIR").filter(|v| !v.is_empty());
    own.map(PathBuf::from).or_else(|| {
        let users = choose_native_strategy().ok()?;
        let folder = users.state_dir().unwrap_or_else(|| users.data_dir());
        Some(folder.join("sceneloom"))
    })
}
