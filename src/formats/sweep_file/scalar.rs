//! Numbers in the records of a file.

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// The type that PCD names by a letter and a size in bytes.
    pub(super) fn of_kind(letter: &str, size: usize) -> Option<Self> {
        Some(match (letter, size) {
            ("F", 4) => Self::F32,
            ("F", 8) => Self::F64,
            ("I", 1) => Self::I8,
            ("I", 2) => Self::I16,
            ("I", 4) => Self::I32,
            ("I", 8) => Self::I64,
            ("U", 1) => Self::U8,
            ("U", 2) => Self::U16,
            ("U", 4) => Self::U32,
            ("U", 8) => Self::U64,
            _ => return None,
        })
    }

    /// Bytes of one.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// True for fractions.
    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The number at the beginning of these bytes; NaN if they are too few.
    pub(super) fn value(self, bytes: &[u8], is_big: bool) -> f64 {
        macro_rules! number {
            ($type:ty) => {
                bytes.first_chunk().map_or(f64::NAN, |b| match is_big {
                    true => <$type>::from_be_bytes(*b) as f64,
                    false => <$type>::from_le_bytes(*b) as f64,
                })
            };
        }
        match self {
            Self::I8 => number!(i8),
            Self::U8 => number!(u8),
            Self::I16 => number!(i16),
            Self::U16 => number!(u16),
            Self::I32 => number!(i32),
            Self::U32 => number!(u32),
            Self::I64 => number!(i64),
            Self::U64 => number!(u64),
            Self::F32 => number!(f32),
            Self::F64 => number!(f64),
        }
    }

    /// Writes a number over the beginning of these bytes, rounded and limited to what the type holds. Too few bytes stay
    /// as they are.
    pub(super) fn put(self, value: f64, is_big: bool, bytes: &mut [u8]) {
        macro_rules! number {
            ($value:expr) => {{
                let encoded = match is_big {
                    true => $value.to_be_bytes(),
                    false => $value.to_le_bytes(),
                };
                if let Some(to) = bytes.first_chunk_mut() {
                    *to = encoded;
                }
            }};
        }
        // Casts of floats saturate.
        let whole = value.round();
        match self {
            Self::I8 => number!((whole as i8)),
            Self::U8 => number!((whole as u8)),
            Self::I16 => number!((whole as i16)),
            Self::U16 => number!((whole as u16)),
            Self::I32 => number!((whole as i32)),
            Self::U32 => number!((whole as u32)),
            Self::I64 => number!((whole as i64)),
            Self::U64 => number!((whole as u64)),
            Self::F32 => number!((value as f32)),
            Self::F64 => number!(value),
        }
    }
}
