//! Compare mode that the user chose.

use language::t;

/// How two states are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CompareMode {
    /// Only the present state is shown.
    #[default]
    Off,
    /// The reference state on the left of a line, the present one on its right.
    Wipe,
    /// The reference state beside the present one.
    Side,
    /// Voxels that differ are marked.
    Difference,
}

impl CompareMode {
    /// Every mode with its name and what it does.
    pub const ALL: [(CompareMode, &'static str, &'static str); 4] = [
        (CompareMode::Off, "Off", "only the present state"),
        (CompareMode::Wipe, "Wipe", "before on the left of a line"),
        (CompareMode::Side, "Side by side", "before beside after"),
        (CompareMode::Difference, "Diff", "voxels that differ"),
    ];

    /// The next mode.
    pub fn next(self) -> Self {
        let at = Self::ALL.iter().position(|(mode, ..)| *mode == self).unwrap_or(0);
        Self::ALL[(at + 1) % Self::ALL.len()].0
    }
}

/// The compare mode, and the state of its key and its wipe line.
#[derive(Clone, Debug)]
pub struct CompareSettings {
    /// How the present state is compared with the reference state.
    pub mode: CompareMode,
    /// True while the key that shows the reference state is held.
    pub holding_reference: bool,
    /// Place of the wipe line, 0 to 1.
    pub wipe_at: f32,
    /// Name of the version that the user chose to compare with; `None`: the one before.
    pub with: Option<String>,
}

impl CompareSettings {
    /// Names of the two states, the reference state first.
    pub fn names(&self) -> [&str; 2] {
        match &self.with {
            Some(name) => [name, t("now")],
            None => [t("before"), t("after")],
        }
    }
}

impl Default for CompareSettings {
    fn default() -> Self {
        Self {
            mode: CompareMode::Off,
            holding_reference: false,
            wipe_at: 0.5,
            with: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_go_round() {
        let mut mode = CompareMode::Off;
        for _ in CompareMode::ALL {
            mode = mode.next();
        }
        assert_eq!(mode, CompareMode::Off);
    }
}
