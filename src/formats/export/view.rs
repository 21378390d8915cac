//! A picture of the 3D view.

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds, png};

/// One picture.
pub const EXPORTER: Exporter = Exporter {
    id: "view",
    title: "3D view: PNG of any size, supersampled",
    file_name: Some("view.png"),
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::View],
    write: |_, products| {
        let recipe = products.recipe().clone();
        let p = products.view()?;
        let bytes = recipe.in_png(true, |text| png::rgba(p.width, p.height, &p.rgba, text));
        Ok(vec![OutFile::new("view.png", bytes.map_err(FormatError::new)?)])
    },
};
