//! The error that every table of formats returns when something cannot be read or written.

use std::error::Error;
use std::fmt;

use scene::message;

/// Why a file was not read or written, in one line of at most [`message::LONGEST`] characters. Each format has a typed error
/// of its own; this one carries any of them.
pub struct FormatError {
    line: String,
    of: Box<dyn Error + Send + Sync>,
}

impl FormatError {
    /// From a format's own error or a sentence.
    pub fn new(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        let of = error.into();
        Self {
            line: message::of_error(&*of),
            of,
        }
    }

    /// Puts `place` in front of the line: what was being done, most often the file's name.
    pub fn at(self, place: &impl fmt::Display) -> Self {
        Self {
            line: message::one_line(&format_args!("{place}: {}", self.line)),
            of: self.of,
        }
    }

    /// The format's own error, if it is of this type.
    pub fn downcast_ref<E: Error + 'static>(&self) -> Option<&E> {
        self.of.downcast_ref()
    }
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.line)
    }
}

impl fmt::Debug for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FormatError({:?})", self.line)
    }
}

/// Its line tells the causes already.
impl Error for FormatError {}
