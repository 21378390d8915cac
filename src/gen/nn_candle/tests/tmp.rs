use nets::picture::{self, Condition, Motion, PictureDit, PictureVae, RingSize};
use nn::weights::WeightFile;
use nn_candle::Candle;

/// Numbers in -1..1 from a hash of their index.
fn numbers(count: usize, stream: u32) -> Vec<f32> {
    let hash = |i: u32| (i ^ stream.wrapping_mul(0x9e37_79b9)).wrapping_mul(2_654_435_761);
    (0..count as u32)
        .map(|i| (hash(i) >> 8) as f32 / (1 << 23) as f32 - 1.0)
        .collect()
}


fn candle() -> Candle {
    Candle::best().expect("a device")
}

/// Within 1e-4 of the largest value: two f32 programs that add in different orders.
fn agree(ours: &[f32], theirs: &[f32], what: &str) {
    assert_eq!(ours.len(), theirs.len());
    let largest = theirs.iter().fold(0f32, |m, v| m.max(v.abs()));
    let pairs = ours.iter().zip(theirs);
    let worst = pairs.fold(0f32, |m, (a, b)| m.max((a - b).abs()));
    println!("{what}: {worst:.1e} of {largest:.2}");
    assert!(
        largest > 0.1 && worst <= 1e-4 * largest,
        "{what}: {worst} of {largest}"
    );
}


/// A frame of three cameras that also hears the frame before, and its pictures.
#[test]
fn pictures_agree() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../training/weights/pictures");
    let [vae, dit] = picture::FILES.map(|name| std::fs::read(folder.join(name)).expect("weights"));
    let parse = |bytes| WeightFile::parse("pictures", bytes).expect("a sound file");
    let size = RingSize::new(3, [32, 48]).expect("a size");
    let pixels = 3 * 32 * 48;
    let condition = Condition {
        size,
        classes: (0..pixels).map(|i| (i / 7 % 20) as u8).collect(),
        depth_m: (0..pixels).map(|i| (i % 97) as f32 * 0.5).collect(),
        facings: (0..pixels).map(|i| (i / 5 % 17) as u8 | 0x80).collect(),
        time: Some(1),
        weather: None,
        cameras: numbers(21, 7).as_chunks().0.to_vec(),
    };
    let motion = Motion {
        focal_px: [30.0, 30.0],
        center_px: [24.0, 16.0],
        then_from_now: [[1.0, 0.0, 0.0, 0.1], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.5]],
    };
    let x = numbers(3 * 24 * 8, 8);
    let depths = [&condition.depth_m[..]; 2];
    let before = picture::warp(size, &numbers(3 * 24 * 8, 9), depths, &[motion; 3]).expect("finite");

    let (ours, theirs) = (
        PictureDit::new(parse(&dit)).expect("weights"),
        PictureDit::on(candle(), parse(&dit)).expect("weights"),
    );
    let (told, told_too) = (
        ours.tell(&condition).expect("a condition"),
        theirs.tell(&condition).expect("a condition"),
    );
    agree(
        &ours.v(&x, 500.0, &told, Some(&before)).expect("finite"),
        &theirs.v(&x, 500.0, &told_too, Some(&before)).expect("finite"),
        "v of pictures",
    );
    let (ours, theirs) = (
        PictureVae::new(parse(&vae)).expect("weights"),
        PictureVae::on(candle(), parse(&vae)).expect("weights"),
    );
    let drawn = ours.decode(&x, size.cells()).expect("finite");
    agree(&drawn, &theirs.decode(&x, size.cells()).expect("finite"), "pictures");
    let latents = ours.encode(&drawn, size.pixels()).expect("finite");
    agree(
        &latents,
        &theirs.encode(&drawn, size.pixels()).expect("finite"),
        "latents of pictures",
    );
}
