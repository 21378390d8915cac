//! OpenDRIVE roads. A scene is a place on them, which the program asks for.

use super::{Content, Importer};
use crate::{FormatError, Holds, opendrive};

/// See [`opendrive`].
pub const IMPORTER: Importer = Importer {
    id: "opendrive",
    title: "OpenDRIVE roads",
    extensions: &["xodr"],
    holds: &[Holds::Roads],
    largest: opendrive::LARGEST_FILE,
    recognises: |head| {
        let text = String::from_utf8_lossy(head);
        text.contains("<OpenDRIVE")
    },
    in_folder: None,
    read: |source| match opendrive::read(source.bytes) {
        Ok(network) => Ok(Content::Roads(Box::new(network))),
        Err(error) => Err(FormatError::new(error)),
    },
    #[cfg(test)]
    sample: || {
        let lane = r#"<lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>"#;
        format!(
            r#"<OpenDRIVE><road length="300" id="1" junction="-1"><planView><geometry s="0" x="0" y="0" hdg="0" length="300">
            <line/></geometry></planView><lanes><laneSection s="0"><right>{lane}</right></laneSection></lanes></road></OpenDRIVE>"#
        )
        .into_bytes()
    },
};
