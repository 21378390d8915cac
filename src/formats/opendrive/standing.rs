//! Kinds of objects that stand beside the road, by the names that files give them.

use scene::background::{LineKind, PostKind, TreeKind};

/// Kind of an object that stands beside the road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoadsideObject {
    /// A building.
    Building,
    /// A tree.
    Tree(TreeKind),
    /// An area of shrubs; a hedge where it runs along a line.
    Shrubs,
    /// A thing along a line, such as a fence.
    Line(LineKind),
    /// A small thing, such as a pole.
    Post(PostKind),
    /// Any other thing of some size.
    Obstacle,
    /// A traffic sign or light of `<signals>`.
    Signal(PostKind),
}

impl RoadsideObject {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Building => "building",
            Self::Tree(_) => "tree",
            Self::Shrubs => "vegetation",
            Self::Line(kind) => kind.name(),
            Self::Post(kind) | Self::Signal(kind) => kind.name(),
            Self::Obstacle => "obstacle",
        }
    }

    /// From `type`, `subtype` and `name`, each in lower-case letters only; `None` for an object that is not known or
    /// does not stand beside roads. The name counts only where there is no type.
    pub fn from_names(kind: &str, subtype: &str, name: &str) -> Option<Self> {
        let kind = match kind {
            "" | "none" => name,
            kind => kind,
        };
        let says = |word: &str| kind.contains(word) || subtype.contains(word);
        let is = |words: &[&str]| words.iter().any(|w| says(w));
        Some(match kind {
            "parkingspace" | "trafficisland" | "crosswalk" | "patch" | "roadmark" | "gantry" => return None,
            _ if says("busstop") => Self::Post(PostKind::BusStop),
            "building" | "house" => Self::Building,
            _ if says("hedge") => Self::Line(LineKind::Hedge),
            "tree" => Self::Tree(match subtype {
                "needle" | "conifer" | "fir" | "pine" => TreeKind::Conifer,
                "poplar" | "cypress" => TreeKind::Columnar,
                _ => TreeKind::Broadleaf,
            }),
            "vegetation" | "bush" | "shrub" | "forest" => Self::Shrubs,
            // Poles of a railing are poles.
            _ if kind.ends_with("pole") || kind.ends_with("post") => Self::Post(match subtype {
                "trafficsign" => PostKind::Sign,
                "trafficlight" => PostKind::TrafficLight,
                "streetlamp" => PostKind::StreetLight,
                "bollard" | "permanentdelineator" => PostKind::Bollard,
                _ if is(&["guidepost", "railpole", "railingpole", "railingpost"]) => PostKind::Bollard,
                _ => PostKind::Pole,
            }),
            _ if is(&["streetlamp", "streetlight", "lamppost"]) => Self::Post(PostKind::StreetLight),
            _ if is(&["bollard", "delineator"]) => Self::Post(PostKind::Bollard),
            _ if is(&["bench"]) => Self::Post(PostKind::Bench),
            _ if is(&["retainingwall"]) => Self::Line(LineKind::RetainingWall),
            _ if is(&["wall", "jersey", "noise", "soundbarrier"]) => Self::Line(LineKind::Wall),
            _ if is(&["guardrail"]) => Self::Line(LineKind::GuardRail),
            _ if is(&["fence", "railing"]) => Self::Line(LineKind::Fence),
            "barrier" => Self::Line(LineKind::GuardRail),
            "obstacle" => Self::Obstacle,
            _ if kind == name && name.contains("tree") => Self::Tree(TreeKind::Broadleaf),
            _ if kind == name && name.contains("building") => Self::Building,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_the_standard_and_of_real_files() {
        let of = |kind, subtype, name| RoadsideObject::from_names(kind, subtype, name);
        assert_eq!(of("building", "", "x"), Some(RoadsideObject::Building));
        assert_eq!(
            of("building", "busstop", ""),
            Some(RoadsideObject::Post(PostKind::BusStop))
        );
        assert_eq!(
            of("tree", "needle", ""),
            Some(RoadsideObject::Tree(TreeKind::Conifer))
        );
        assert_eq!(of("vegetation", "bush", ""), Some(RoadsideObject::Shrubs));
        assert_eq!(
            of("vegetation", "hedge", ""),
            Some(RoadsideObject::Line(LineKind::Hedge))
        );
        assert_eq!(
            of("barrier", "", ""),
            Some(RoadsideObject::Line(LineKind::GuardRail))
        );
        assert_eq!(
            of("barrier", "wall", ""),
            Some(RoadsideObject::Line(LineKind::Wall))
        );
        assert_eq!(
            of("soundbarrier", "", ""),
            Some(RoadsideObject::Line(LineKind::Wall))
        );
        assert_eq!(of("railing", "", ""), Some(RoadsideObject::Line(LineKind::Fence)));
        assert_eq!(
            of("railpole", "", ""),
            Some(RoadsideObject::Post(PostKind::Bollard))
        );
        assert_eq!(
            of("guidepost", "", ""),
            Some(RoadsideObject::Post(PostKind::Bollard))
        );
        assert_eq!(
            of("pole", "streetlamp", ""),
            Some(RoadsideObject::Post(PostKind::StreetLight))
        );
        assert_eq!(
            of("streetlamp", "", ""),
            Some(RoadsideObject::Post(PostKind::StreetLight))
        );
        assert_eq!(of("pole", "", ""), Some(RoadsideObject::Post(PostKind::Pole)));
        assert_eq!(
            of("", "", "oaktree"),
            Some(RoadsideObject::Tree(TreeKind::Broadleaf))
        );
        for kind in ["parkingspace", "trafficisland", "crosswalk", "patch", "car", ""] {
            assert_eq!(of(kind, "", ""), None, "{kind}");
        }
    }
}
