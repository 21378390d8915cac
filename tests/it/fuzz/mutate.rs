//! Seeded damage to valid files: cut, flipped, repeated, numbers at the edge, lengths that lie, nests of brackets.

use numeric::splitmix::SplitMix64;

/// What a number in a text may become.
const NUMBERS: [&str; 22] = [
    "NaN",
    "null",
    "inf",
    "-inf",
    "0",
    "-0",
    "-1",
    "1",
    "1e-320",
    "5e-324",
    "1e-300",
    "1e300",
    "-1e300",
    "1e999",
    "255",
    "256",
    "65536",
    "4294967295",
    "4294967296",
    "9223372036854775808",
    "18446744073709551616",
    "99999999999999999999999999999999999999999999",
];

/// A number of bytes that a length may become.
const LENGTHS: [u64; 8] = [
    0,
    1,
    0xff,
    0xffff,
    0x7fff_ffff,
    0xffff_ffff,
    0x7fff_ffff_ffff_ffff,
    u64::MAX,
];

/// One to four pieces of damage.
pub fn damage(valid: &[u8], dice: &mut SplitMix64) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..=dice.below(4) {
        once(&mut bytes, dice);
    }
    bytes
}

fn once(bytes: &mut Vec<u8>, dice: &mut SplitMix64) {
    let n = bytes.len();
    let at = dice.below(n);
    match dice.below(12) {
        0 => bytes.truncate(at),
        1 | 2 if n > 0 => bytes[at] ^= 1 << dice.below(8),
        3 if n > 0 => bytes[at] = dice.bits() as u8,
        4 => {
            // A piece goes.
            let to = (at + 1 + dice.below(64)).min(n);
            bytes.drain(at.min(to)..to);
        }
        5 if n > 0 => {
            // A piece comes again, elsewhere.
            let to = (at + 1 + dice.below(256)).min(n);
            let piece = bytes[at..to].to_vec();
            let here = dice.below(bytes.len());
            bytes.splice(here..here, piece);
        }
        6 => {
            // A length lies.
            let value = LENGTHS[dice.below(LENGTHS.len())].to_le_bytes();
            let width = [2, 4, 8][dice.below(3)];
            for (i, v) in value.iter().take(width).enumerate() {
                if let Some(b) = bytes.get_mut(at + i) {
                    *b = *v;
                }
            }
        }
        7 => {
            // A nest.
            let what = b"([{<"[dice.below(4)];
            let many = [3, 40, 200, 5000][dice.below(4)];
            bytes.splice(at..at, std::iter::repeat_n(what, many));
        }
        _ => number(bytes, dice),
    }
}

/// Replaces a number, or a text in quotes, of a text.
fn number(bytes: &mut Vec<u8>, dice: &mut SplitMix64) {
    let digit = |b: &u8| b.is_ascii_digit();
    let start = dice.below(bytes.len());
    let Some(from) = bytes[start..].iter().position(digit).map(|i| start + i) else {
        return;
    };
    let in_number = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'e' | b'E' | b'-' | b'+');
    let to = from + bytes[from..].iter().take_while(|b| in_number(b)).count();
    let from = if from > 0 && bytes[from - 1] == b'-' {
        from - 1
    } else {
        from
    };
    bytes.splice(from..to, NUMBERS[dice.below(NUMBERS.len())].bytes());
}
