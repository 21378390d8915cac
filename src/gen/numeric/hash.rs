//! FNV-1a: hashes for identifying bytes. Not for keys that somebody may choose so that they collide.
//!
//! Fowler, Noll and Vo; the constants are those of the FNV internet draft (draft-eastlake-fnv).

/// The 64-bit hash of bytes that are added piece by piece. [`Fnv1a::get`] reads the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv1a(u64);

impl Default for Fnv1a {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv1a {
    /// The hash of no bytes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a byte.
    #[inline]
    pub fn add(&mut self, byte: u8) {
        self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }

    /// The hash with more bytes added.
    pub fn with(mut self, bytes: impl IntoIterator<Item = u8>) -> Self {
        bytes.into_iter().for_each(|b| self.add(b));
        self
    }

    /// The hash of all bytes so far.
    pub fn get(self) -> u64 {
        self.0
    }
}

/// The 64-bit hash of bytes.
pub fn fnv1a_64(bytes: &[u8]) -> u64 {
    Fnv1a::new().with(bytes.iter().copied()).get()
}

/// The 32-bit hash of bytes, for buckets of hashed words.
pub fn fnv1a_32(bytes: &[u8]) -> u32 {
    bytes
        .iter()
        .fold(0x811c_9dc5, |h, b| (h ^ u32::from(*b)).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known answers published with the algorithm (test_fnv.c of Noll).
    #[test]
    fn known_answers() {
        for (text, long, short) in [
            ("", 0xcbf2_9ce4_8422_2325, 0x811c_9dc5),
            ("a", 0xaf63_dc4c_8601_ec8c, 0xe40c_292c),
            ("foobar", 0x8594_4171_f739_67e8, 0xbf9c_f968),
        ] {
            assert_eq!(fnv1a_64(text.as_bytes()), long, "{text:?}");
            assert_eq!(fnv1a_32(text.as_bytes()), short, "{text:?}");
        }
        assert_eq!(
            Fnv1a::new().with(*b"foo").with(*b"bar").get(),
            fnv1a_64(b"foobar")
        );
    }
}
