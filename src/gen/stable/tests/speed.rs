//! How long things take at the size of the real models; run by hand:
//! `cargo test --release -p sceneloom-stable --lib speed -- --ignored --nocapture --test-threads 1`.

use std::time::Instant;

use candle_core::{Device, Tensor};

use super::shapes;
use crate::config::UnetConfig;
use crate::layers::convolution::by_products;
use crate::{Extra, Machine, Unet, Weights};

#[test]
#[ignore = "takes minutes and 4 GB"]
fn speed_of_a_call() {
    let (at, config) = shapes::hollow_folder("sd15.unet");
    let config = UnetConfig::read(&config).expect("a configuration");
    let weights = Weights::of_folder(at.path()).expect("weights");
    let start = Instant::now();
    let unet = Unet::load(config, &weights, &Machine::cpu()).expect("a network");
    println!("loading: {:.1} s", start.elapsed().as_secs_f64());
    // The second is that of SyntheOcc, which cannot be halved three times.
    for size in [(1, 4, 32, 32), (1, 4, 56, 100)] {
        let x = Tensor::randn(0f32, 1.0, size, &Device::Cpu).expect("noise");
        let context = Tensor::randn(0f32, 1.0, (1, 77, 768), &Device::Cpu).expect("noise");
        let start = Instant::now();
        let y = unet
            .forward(&x, 500.0, &context, &Extra::default(), 1)
            .expect("computed");
        assert_eq!(y.dims(), x.dims());
        println!("latents of {size:?}: {:.1} s", start.elapsed().as_secs_f64());
    }
}

#[test]
#[ignore = "takes seconds, alone"]
fn speed_of_convolutions() {
    for (inputs, outputs, rows, columns) in [
        (320, 320, 64, 64),
        (640, 640, 32, 32),
        (1280, 1280, 16, 16),
        (128, 128, 256, 256),
    ] {
        let x = Tensor::randn(0f32, 1.0, (1, inputs, rows, columns), &Device::Cpu).expect("a map");
        let w = Tensor::randn(0f32, 1.0, (outputs, inputs, 3, 3), &Device::Cpu).expect("a kernel");
        let work = 18.0 * (inputs * outputs * rows * columns) as f64 / 1e9;
        let timed = |what: &str, run: &dyn Fn() -> Tensor| {
            let y = run();
            let start = Instant::now();
            (0..3).for_each(|_| drop(run()));
            let each = start.elapsed().as_secs_f64() / 3.0;
            println!(
                "{what} {inputs} > {outputs}, {rows} x {columns}: {:.1} ms, {:.0} GFLOP/s",
                1e3 * each,
                work / each
            );
            y
        };
        let a = timed("candle", &|| x.conv2d(&w, 1, 1, 1, 1).expect("computed"));
        let b = timed("gemm", &|| by_products(&x, &w, 1, 1 << 22).expect("computed"));
        let off = (a - b)
            .and_then(|d| d.abs()?.flatten_all()?.max(0)?.to_scalar::<f32>())
            .expect("a number");
        println!("off {off}");
    }
}
