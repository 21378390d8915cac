//! Work on some cells gives the bits of work on all of them, on any number of threads.

use super::*;

/// Decoding some cells gives the labels of decoding all of them, also at the map's edge.
#[test]
fn decode_cells_is_a_part_of_decode() {
    let models = models();
    let latent = uniform(LATENT, 9);
    let all = models.vae.decode(&latent).expect("a finite latent");
    for (xs, ys) in [(0..1, 0..1), (20..24, 30..41), (47..50, 0..50), (12..13, 49..50)] {
        let wanted: Vec<bool> = (0..CELLS)
            .map(|c| xs.contains(&(c / 50)) && ys.contains(&(c % 50)))
            .collect();
        let some = models
            .vae
            .decode_cells(&latent, &wanted)
            .expect("a finite latent");
        for x in 0..200 {
            for y in 0..200 {
                if wanted[x / 4 * 50 + y / 4] {
                    assert_eq!(some.column(x, y), all.column(x, y), "column ({x}, {y})");
                } else {
                    assert_eq!(some.column(x, y), &[17; 16], "column ({x}, {y})");
                }
            }
        }
    }
    assert_eq!(
        models
            .vae
            .decode_cells(&latent, &[false; CELLS])
            .expect("nothing to do")
            .count_set(),
        0
    );
}

/// Renewing the cells around an edit gives what encoding everything gives, bit for bit.
#[test]
fn encode_cells_is_a_part_of_encode() {
    let models = models();
    let mut grid = scene(&Golden::open("parity_vae.safetensors"));
    let before = models.vae.encode(&grid).expect("labels");
    let reach = models.vae.encoder_reach();
    for (x, y) in [(120, 101), (0, 0), (199, 120)] {
        (0..5).for_each(|z| grid.set(x, y, z, 4));
        let near = |c: usize| (c / 50).abs_diff(x / 4) <= reach && (c % 50).abs_diff(y / 4) <= reach;
        let cells: Vec<bool> = (0..CELLS).map(near).collect();
        let mut renewed = models.vae.encode(&grid).expect("labels");
        let all = renewed.clone();
        // Spoil what is to be renewed.
        for (c, values) in renewed.chunks_exact_mut(CHANNELS).enumerate() {
            if cells[c] {
                values.fill(9.0);
            }
        }
        models
            .vae
            .encode_cells(&grid, &cells, &mut renewed)
            .expect("labels");
        assert!(renewed == all && all != before);
    }
    let mut same = before.clone();
    models
        .vae
        .encode_cells(&grid, &[false; CELLS], &mut same)
        .expect("nothing to do");
    assert_eq!(same, before);
}

/// An edit changes latents only within the encoder's reach, bit for bit.
#[test]
fn encoding_is_local() {
    let models = models();
    let mut grid = scene(&Golden::open("parity_vae.safetensors"));
    let before = models.vae.encode(&grid).expect("labels");
    for z in 0..5 {
        grid.set(120, 101, z, 4);
    }
    let after = models.vae.encode(&grid).expect("labels");
    let reach = models.vae.encoder_reach();
    let mut changed = 0;
    for i in 0..LATENT {
        let (x, y) = (i / CHANNELS / 50, i / CHANNELS % 50);
        if before[i] != after[i] {
            assert!(
                x.abs_diff(30) <= reach && y.abs_diff(25) <= reach,
                "cell ({x}, {y}) changed"
            );
            changed += 1;
        }
    }
    assert!(changed > 0);
}

/// Row 17: the number of threads changes no bit.
#[test]
fn row_17_same_bits_on_any_number_of_threads() {
    let models = models();
    let grid = scene(&Golden::open("parity_vae.safetensors"));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let latent = models.vae.encode(&grid).expect("labels");
            let prepared = models.dit.prepare(&condition()).expect("a condition");
            let v = models
                .dit
                .forward(&uniform(LATENT, 1), 321.0, &prepared)
                .expect("a finite state");
            let bits = |values: Vec<f32>| values.into_iter().map(f32::to_bits).collect::<Vec<u32>>();
            let labels = models.vae.decode(&latent).expect("a finite latent").to_dense();
            (bits(latent), bits(v), labels)
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(5));
}
