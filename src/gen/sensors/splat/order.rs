//! Front-to-back order: a stable radix sort of depths by bits that grow with the number.

/// Bits that compare like the number: negative numbers below positive ones, -0.0 equal to 0.0.
/// `None` for NaN, which has no place in an order.
pub fn monotone_bits(value: f32) -> Option<u32> {
    if value.is_nan() {
        return None;
    }
    let bits = (value + 0.0).to_bits(); // -0.0 + 0.0 = 0.0
    let negative = bits >> 31 == 1;
    Some(if negative { !bits } else { bits | 1 << 31 })
}

/// Indices of `depths` from near to far; equal depths keep the order of their index, NaN is left out.
/// Panics beyond 2^32 items.
pub fn depth_order(depths: &[f32]) -> Vec<u32> {
    const DIGIT: u32 = 11;
    const BUCKETS: usize = 1 << DIGIT;
    assert!(u32::try_from(depths.len()).is_ok(), "{} items", depths.len());
    let mut items: Vec<(u32, u32)> = Vec::with_capacity(depths.len());
    let mut counts = [[0u32; BUCKETS]; 3];
    for (index, &depth) in depths.iter().enumerate() {
        if let Some(key) = monotone_bits(depth) {
            items.push((key, index as u32));
            for (digit, counts) in counts.iter_mut().enumerate() {
                counts[bucket(key, digit)] += 1;
            }
        }
    }
    let mut sorted = vec![(0, 0); items.len()];
    for (digit, counts) in counts.iter_mut().enumerate() {
        // A digit that all keys share moves nothing.
        if counts.iter().any(|&c| c as usize == items.len()) {
            continue;
        }
        let mut start = 0;
        for count in counts.iter_mut() {
            (start, *count) = (start + *count, start);
        }
        for &item in &items {
            let at = &mut counts[bucket(item.0, digit)];
            sorted[*at as usize] = item;
            *at += 1;
        }
        std::mem::swap(&mut items, &mut sorted);
    }
    items.into_iter().map(|(_, index)| index).collect()
}

fn bucket(key: u32, digit: usize) -> usize {
    (key >> (11 * digit) & 0x7ff) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a stable comparison sort gives.
    fn plain(depths: &[f32]) -> Vec<u32> {
        let mut order: Vec<u32> = (0..depths.len() as u32)
            .filter(|&i| !depths[i as usize].is_nan())
            .collect();
        order.sort_by(|&a, &b| {
            let (a, b) = (depths[a as usize], depths[b as usize]);
            a.partial_cmp(&b).expect("no NaN")
        });
        order
    }

    fn noise(i: u64) -> f32 {
        let v = i.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        f32::from_bits(((v ^ (v >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 32) as u32)
    }

    #[test]
    fn row_43_depth_sort() {
        let special = [
            0.0,
            -0.0,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MIN_POSITIVE,
            1e-45,
            -1e-45,
            f32::MAX,
            f32::MIN,
            -f32::NAN,
            1.0,
            1.0,
            -0.0,
            0.0,
        ];
        assert_eq!(depth_order(&special), plain(&special));
        assert!(depth_order(&[]).is_empty());
        assert_eq!(depth_order(&[3.0]), vec![0]);
        assert!(depth_order(&[f32::NAN]).is_empty());
        assert_eq!(depth_order(&[2.0; 5000]), (0..5000).collect::<Vec<_>>());
        // Any bit pattern, and many equal ones.
        let wild: Vec<f32> = (0..100_000).map(noise).collect();
        assert_eq!(depth_order(&wild), plain(&wild));
        let few: Vec<f32> = (0..100_000).map(|i| (noise(i).to_bits() % 50) as f32).collect();
        assert_eq!(depth_order(&few), plain(&few));
    }

    /// One more than f32 can count: positions must be integers.
    #[test]
    fn row_43_depth_sort_of_2_24_plus_1() {
        let n = (1u64 << 24) + 1;
        let depths: Vec<f32> = (0..n).map(|i| (noise(i).to_bits() >> 12) as f32).collect();
        let order = depth_order(&depths);
        assert_eq!(order.len() as u64, n);
        let mut seen = vec![false; n as usize];
        for pair in order.windows(2) {
            let (a, b) = (depths[pair[0] as usize], depths[pair[1] as usize]);
            assert!(a < b || (a == b && pair[0] < pair[1]));
        }
        for i in order {
            assert!(!std::mem::replace(&mut seen[i as usize], true), "{i} twice");
        }
    }
}
