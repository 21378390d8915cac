//! Every part of the networks beside diffusers.

use super::{Golden, opened};
use crate::unet::NeighbourIndices;

#[test]
fn parity_of_text_and_autoencoder() {
    for model in ["sd15", "sd21"] {
        let golden = Golden::open(&format!("{model}/golden.safetensors"));
        let pipeline = opened(model);
        let told = "A wet road, it's dawn; two cars";
        let ids = pipeline.words.ids(told, 77).expect("ids");
        golden.compare(model, "text", &pipeline.text.encode(&ids).expect("encoded"));
        let vae = &pipeline.vae;
        let [mean, log_variance] = vae.moments(&golden.tensor("vae.picture")).expect("moments");
        golden.compare(model, "vae.mean", &mean);
        golden.compare(model, "vae.logvar", &log_variance);
        // The golden decodes latents that are not scaled.
        let scale = vae.config().scaling_factor;
        let latents = golden.tensor("vae.latent").affine(scale, 0.0).expect("scaled");
        golden.compare(model, "vae.decoded", &vae.decode(&latents).expect("decoded"));
        let middle = &vae.encoder.middle;
        let x = golden.tensor("vae.encoder.mid_block.resnets.0.in");
        let y = middle.residuals[0].forward(&x, None).expect("residual");
        golden.compare(model, "vae.encoder.mid_block.resnets.0.out", &y);
        let x = golden.tensor("vae.encoder.mid_block.attentions.0.in");
        let y = middle.everywhere.forward(&x).expect("attention");
        golden.compare(model, "vae.encoder.mid_block.attentions.0.out", &y);
    }
}

#[test]
fn parity_of_unet() {
    for model in ["sd15", "sd21"] {
        let golden = Golden::open(&format!("{model}/golden.safetensors"));
        let unet = opened(model).unet;
        let (x, context) = (golden.tensor("unet.x"), golden.tensor("unet.context"));
        let around = NeighbourIndices::default();
        let time = unet.time.forward(481.0, &crate::Machine::cpu()).expect("time");
        let both = time
            .broadcast_as((2, time.dim(1).expect("two dimensions")))
            .expect("for two");
        golden.compare(model, "unet.time_embedding.out", &both);
        let (residual, transformer, resize) = unet.down[0].parts();
        let given = |name: &str| golden.tensor(&format!("unet.{name}.in"));
        let same = |name: &str, y: candle_core::Result<candle_core::Tensor>| {
            golden.compare(model, &format!("unet.{name}.out"), &y.expect("computed"));
        };
        let name = "down_blocks.0.resnets.0";
        same(name, residual.forward(&given(name), Some(&time)));
        let name = "down_blocks.0.attentions.0";
        same(name, transformer.forward(&given(name), &context, &around));
        let name = "down_blocks.0.attentions.0.transformer_blocks.0";
        same(
            name,
            transformer.blocks[0].forward(&given(name), &context, &around),
        );
        let name = "down_blocks.0.attentions.0.transformer_blocks.0.ff";
        same(name, transformer.blocks[0].gated.forward(&given(name)));
        let name = "down_blocks.0.downsamplers.0";
        same(name, resize.expect("a coarser level").forward(&given(name)));
        same(
            "mid_block",
            unet.middle.forward(&given("mid_block"), &time, &context, &around),
        );
        let name = "up_blocks.0.upsamplers.0";
        let (_, _, rows, columns) = golden.tensor(&format!("unet.{name}.out")).dims4().expect("a map");
        let grown = given(name).interpolate2d(rows, columns).expect("grown");
        same(name, unet.up[0].resize().expect("a finer level").forward(&grown));
        let out = unet
            .forward(&x, 481.0, &context, &crate::Extra::default(), 1)
            .expect("computed");
        golden.compare(model, "unet.out", &out);
    }
}

#[test]
fn parity_of_control() {
    let golden = Golden::open("sd15/golden.safetensors");
    let pipeline = opened("sd15");
    let control = &pipeline.controls[0];
    let embedded = control.embed(&golden.tensor("control.hint")).expect("embedded");
    golden.compare("sd15", "control.embedding", &embedded);
    let first = |name: &str| golden.tensor(name).narrow(0, 0, 1).expect("the first");
    let (x, context) = (first("unet.x"), first("unet.context"));
    let extra = control
        .forward(&x, 481.0, &context, &embedded, 0.8)
        .expect("computed");
    for (i, down) in extra.down.iter().enumerate() {
        golden.compare("sd15", &format!("control.down.{i}"), down);
    }
    golden.compare("sd15", "control.mid", &extra.middle.expect("the middle"));
}
