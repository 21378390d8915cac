//! LZF by Marc Lehmann (liblzf): the compression of PCD's `binary_compressed`.

/// Most bytes that one byte of LZF can stand for: three bytes copy 264.
pub const MOST_PER_BYTE: usize = 88;

/// Unpacks LZF; `None` unless that gives exactly `size` bytes. Memory grows with what comes out, not with `size`.
pub fn decompress(bytes: &[u8], size: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    let mut rest = bytes;
    while let Some((control, after)) = rest.split_first() {
        let control = usize::from(*control);
        if control < 32 {
            let (literal, after) = after.split_at_checked(control + 1)?;
            out.extend_from_slice(literal);
            rest = after;
        } else {
            let mut length = control >> 5;
            rest = after;
            if length == 7 {
                length += usize::from(*rest.split_off_first()?);
            }
            let back = ((control & 31) << 8) + usize::from(*rest.split_off_first()?) + 1;
            let from = out.len().checked_sub(back)?;
            // The copied range may overlap the bytes that it writes.
            for i in from..from + length + 2 {
                out.push(out[i]);
            }
        }
        if out.len() > size {
            return None;
        }
    }
    (out.len() == size).then_some(out)
}

/// Bytes that unpack to these, none of them packed.
pub fn stored(bytes: &[u8]) -> Vec<u8> {
    let runs = bytes.chunks(32);
    runs.flat_map(|run| std::iter::once(run.len() as u8 - 1).chain(run.iter().copied()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_and_copies_come_out() {
        // "abc", then six bytes from three back, then eleven (7 + 4) from one back.
        let packed = [2, b'a', b'b', b'c', 4 << 5, 2, 7 << 5, 2, 0];
        let plain = b"abcabcabcccccccccccc";
        assert_eq!(decompress(&packed, plain.len()).as_deref(), Some(&plain[..]));
        assert_eq!(decompress(&[], 0), Some(Vec::new()));
    }

    #[test]
    fn what_is_cut_or_points_nowhere_is_refused() {
        let packed = [2, b'a', b'b', b'c', 4 << 5, 2];
        assert!(decompress(&packed, 9).is_some());
        for cut in 1..packed.len() {
            assert_eq!(decompress(&packed[..cut], 9), None, "{cut}");
        }
        for size in [0, 8, 10, usize::MAX] {
            assert_eq!(decompress(&packed, size), None, "{size}");
        }
        // Before the beginning.
        assert_eq!(decompress(&[0, b'a', 1 << 5, 1], 4), None);
        assert_eq!(decompress(&[7 << 5], 9), None);
    }
}
