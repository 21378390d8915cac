//! A picture of the 3D view.

use super::{Exporter, OutFile, Product, Span, with_text};
use crate::{FormatError, Holds, png};

/// One picture.
pub const EXPORTER: Exporter = Exporter {
    id: "view",
    title: "3D view: PNG of any size, supersampled",
    file_name: Some("view.png"),
    holds: &[Holds::Pictures],
    lost: "",
    span: Span::Moment,
    needs: &[Product::View],
    write: |scene, products| {
        let p = products.view()?;
        let bytes = with_text(scene, |text| png::rgba(p.width, p.height, &p.rgba, text));
        Ok(vec![OutFile::new("view.png", bytes.map_err(FormatError::new)?)])
    },
};
