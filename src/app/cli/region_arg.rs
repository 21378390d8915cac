//! The value of `--region`: a word or a rectangle.

use glam::DVec2;

use job::inpaint::InpaintMask;
use scene::Extent;

/// Region that is regenerated.
#[derive(Clone, Debug, PartialEq)]
pub enum RegionArg {
    /// The region that an edit touches.
    Auto,
    /// The whole map, from fresh noise.
    Full,
    /// The region that an edit touches, and the cells of a rectangle.
    Rect(InpaintMask),
}

impl std::str::FromStr for RegionArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "auto" => return Ok(Self::Auto),
            "full" => return Ok(Self::Full),
            _ => {}
        }
        let wanted = || format!("found {text:?}, expected auto, full or four numbers X0,Y0,X1,Y1 in metres");
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|n| n.trim().parse::<f64>()).collect();
        let numbers = numbers.map_err(|_| wanted())?;
        let [x0, y0, x1, y1] = numbers[..] else {
            return Err(wanted());
        };
        if numbers.iter().any(|n| !n.is_finite()) {
            return Err(wanted());
        }
        let mask = InpaintMask::of_rect(reach(), DVec2::new(x0, y0), DVec2::new(x1, y1));
        match mask.is_empty() {
            true => Err("the rectangle covers no cell within 819 m of the origin".into()),
            false => Ok(Self::Rect(mask)),
        }
    }
}

/// Area in which a rectangle may lie: as large as a square map can be.
fn reach() -> Extent {
    Extent::new([-2048; 2], [4096; 2]).unwrap_or(Extent::WINDOW)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_rectangles_and_what_is_neither() {
        assert_eq!("auto".parse(), Ok(RegionArg::Auto));
        assert_eq!("full".parse(), Ok(RegionArg::Full));
        let rect = InpaintMask::of_rect(Extent::WINDOW, DVec2::new(-10.0, -5.0), DVec2::new(10.0, 5.0));
        assert_eq!("-10, 5,10,-5".parse(), Ok(RegionArg::Rect(rect)));
        for bad in ["", "some", "1,2,3", "1,2,3,4,5", "1,2,3,nan", "900,100,990,200"] {
            assert!(bad.parse::<RegionArg>().is_err(), "{bad}");
        }
    }
}
