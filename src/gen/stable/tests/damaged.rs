//! Row 62 of the extremes table: files that are cut, foreign or nonsense are refused in one line, before anything is computed.

use std::collections::HashMap;
use std::path::Path;

use super::folder;
use crate::config::{ControlConfig, SchedulerConfig, TextConfig, UnetConfig, VaeConfig};
use crate::{Folders, Machine, Pipeline, StableError, Unet, Vae, Weights, Words};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};

const FILE: &str = "diffusion_pytorch_model.safetensors";

fn line<T>(result: Result<T, StableError>) -> String {
    let error = result.map(|_| ()).expect_err("refused").to_string();
    assert!(!error.contains('\n') && error.len() < 900, "{error}");
    error
}

/// The UNet of `sd15` with its arrays changed.
fn changed(change: impl Fn(&mut HashMap<String, (Dtype, Vec<usize>, Vec<u8>)>)) -> String {
    let at = folder("sd15/unet");
    let bytes = std::fs::read(at.join(FILE)).expect("weights");
    let file = SafeTensors::deserialize(&bytes).expect("weights");
    let mut arrays = HashMap::new();
    for (name, view) in file.tensors() {
        arrays.insert(name, (view.dtype(), view.shape().to_vec(), view.data().to_vec()));
    }
    change(&mut arrays);
    let views = arrays.iter().map(|(name, (dtype, shape, data))| {
        (
            name,
            TensorView::new(*dtype, shape.clone(), data).expect("data of that shape"),
        )
    });
    let bytes = safetensors::serialize(views, None).expect("serializable");
    let other = tempfile::tempdir().expect("a folder");
    let path = other.path().join(FILE);
    std::fs::write(&path, bytes).expect("written");
    let config = UnetConfig::read(&at.join("config.json")).expect("a configuration");
    let weights = Weights::of_folder(other.path()).expect("a file");
    let told = line(Unet::load(config, &weights, &Machine::cpu()));
    told.split_once(": ").expect("a path and a reason").1.to_owned()
}

#[test]
fn row_62_names_and_shapes() {
    let told = changed(|a| a.retain(|name, _| !name.starts_with("mid_block.attentions")));
    let begins = "tensors: 26 missing: mid_block.attentions.0.norm.bias of shape [32], mid_block.attentions.0.norm.weight of shape [32], \
                  mid_block.attentions.0.proj_in.bias of shape [32] and 23 more";
    assert_eq!(told, begins);
    let told = changed(|a| {
        a.insert("foreign.weight".into(), (Dtype::F16, vec![2], vec![0; 4]));
        a.insert("conv_in.bias".into(), (Dtype::F16, vec![2, 8], vec![0; 32]));
    });
    assert_eq!(
        told,
        "tensors: 1 misshapen, 1 not part of this network: conv_in.bias is [2, 8], expected [16]; foreign.weight"
    );
    let told = changed(|a| {
        a.insert("conv_in.bias".into(), (Dtype::I64, vec![16], vec![0; 128]));
    });
    assert_eq!(
        told,
        "tensors: 1 neither f16 nor bf16 nor f32: conv_in.bias is I64"
    );
    for (dtype, size, infinity) in [
        (Dtype::F16, 2, &[0, 0x7c][..]),
        (Dtype::BF16, 2, &[0xc0, 0xff]),
        (Dtype::F32, 4, &[0, 0, 0x80, 0x7f]),
    ] {
        let told = changed(|a| {
            let mut data = vec![0; 16 * size];
            data[3 * size..4 * size].copy_from_slice(infinity);
            a.insert("conv_in.bias".into(), (dtype, vec![16], data));
        });
        assert_eq!(told, "conv_in.bias: value 3 is not finite");
    }
}

#[test]
fn row_62_cut_and_damaged_files() {
    let whole = std::fs::read(folder("sd15/vae").join(FILE)).expect("weights");
    let at = tempfile::tempdir().expect("a folder");
    let path = at.path().join(FILE);
    let header = 8 + u64::from_le_bytes(*whole.first_chunk().expect("a length")) as usize;
    let lengths = (0..200).chain([header - 1, header, header + 1, whole.len() - 1]);
    for length in lengths {
        std::fs::write(&path, &whole[..length]).expect("written");
        line(Weights::of_folder(at.path()));
    }
    std::fs::write(&path, [&whole[..], &[0]].concat()).expect("written");
    let (all, more) = (whole.len(), whole.len() + 1);
    assert!(
        line(Weights::of_folder(at.path()))
            .ends_with(&format!("expected {all} bytes, as its header says, found {more}"))
    );
    // A byte of the header changed, wherever it is: an error, or weights that do not fit, or no change that matters.
    let config = || VaeConfig::read(&folder("sd15/vae/config.json")).expect("a configuration");
    for i in (0..header).step_by(97) {
        let mut bytes = whole.clone();
        bytes[i] ^= 0x15;
        std::fs::write(&path, &bytes).expect("written");
        if let Err(error) =
            Weights::of_folder(at.path()).and_then(|w| Vae::load(config(), &w, &Machine::cpu()))
        {
            assert!(!error.to_string().contains('\n'), "{error}");
        }
    }
    // A header that promises more than there is allocates nothing.
    for length in [u64::MAX, 1 << 40, 100_000_001] {
        std::fs::write(&path, length.to_le_bytes()).expect("written");
        line(Weights::of_folder(at.path()));
    }
}

#[test]
fn row_62_shards() {
    let at = tempfile::tempdir().expect("a folder");
    let source = folder("sd21/unet");
    for entry in std::fs::read_dir(&source).expect("a folder") {
        let path = entry.expect("an entry").path();
        std::fs::copy(&path, at.path().join(path.file_name().expect("a name"))).expect("copied");
    }
    let index = at.path().join(format!("{FILE}.index.json"));
    let text = std::fs::read_to_string(&index).expect("an index");
    Weights::of_folder(at.path()).expect("all shards");
    for (of, to, told) in [
        (
            "conv_in.weight",
            "conv_in.heavy",
            "tensors: 1 not in the shards it names: conv_in.heavy",
        ),
        (
            "diffusion_pytorch_model-00001-of",
            "../../sd15",
            "expected names of files beside it",
        ),
        ("diffusion_pytorch_model-00002-of", "nowhere", "No such file"),
        ("weight_map", "weights", "missing field `weight_map`"),
    ] {
        std::fs::write(&index, text.replace(of, to)).expect("written");
        let found = line(Weights::of_folder(at.path()));
        assert!(found.contains(told), "{found}");
    }
    std::fs::write(&index, text).expect("written");
    let shard = at
        .path()
        .join("diffusion_pytorch_model-00002-of-00003.safetensors");
    let bytes = std::fs::read(&shard).expect("a shard");
    std::fs::write(&shard, &bytes[..bytes.len() - 2]).expect("written");
    assert!(line(Weights::of_folder(at.path())).contains("00002-of-00003.safetensors: not a usable"));
}

/// A configuration with one field changed.
fn field(file: &str, name: &str, value: &str) -> tempfile::NamedTempFile {
    let bytes = std::fs::read(folder(file)).expect("a configuration");
    let mut all: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    all[name] = serde_json::from_str(value).expect("JSON");
    let other = tempfile::NamedTempFile::new().expect("a file");
    std::fs::write(other.path(), all.to_string()).expect("written");
    other
}

#[test]
fn row_62_configurations() {
    let unet = |name: &str, value: &str| {
        line(UnetConfig::read(
            field("sd15/unet/config.json", name, value).path(),
        ))
    };
    for (name, value, told) in [
        (
            "act_fn",
            "\"mish\"",
            "act_fn is \"mish\", expected \"silu\" or \"swish\"",
        ),
        (
            "down_block_types",
            "[\"AttnDownBlock2D\"]",
            "unknown variant `AttnDownBlock2D`",
        ),
        ("block_out_channels", "[]", "number of block_out_channels is 0"),
        (
            "block_out_channels",
            "[16, 18446744073709551615]",
            "block_out_channels is 18446744073709551615",
        ),
        ("block_out_channels", "[16, -1]", "invalid value"),
        (
            "block_out_channels",
            "[16, 33]",
            "norm_num_groups is 8, expected a divisor of 33",
        ),
        ("norm_num_groups", "0", "norm_num_groups is 0"),
        (
            "layers_per_block",
            "1000000000000",
            "layers_per_block is 1000000000000",
        ),
        ("attention_head_dim", "0", "attention_head_dim is 0"),
        ("attention_head_dim", "[4]", "expected one number per level"),
        ("attention_head_dim", "\"x\"", "a whole number, or a list of them"),
        (
            "transformer_layers_per_block",
            "99999999",
            "transformer_layers_per_block is 99999999",
        ),
        (
            "up_block_types",
            "[\"UpBlock2D\"]",
            "up_block_types has 1 entries, expected 2",
        ),
        (
            "class_embed_type",
            "\"timestep\"",
            "class_embed_type is \"timestep\", expected null",
        ),
        (
            "neighboring_view_pair",
            "{\"0\": [7]}",
            "view 0 has [7], expected views below 1",
        ),
        ("neighboring_view_pair", "{\"a\": [0]}", "view 0 of 1 is missing"),
        ("neighboring_attn_type", "\"self\"", "unknown variant `self`"),
        ("freq_shift", "8", "freq_shift is 8"),
        ("norm_eps", "-1", "norm_eps is -1"),
    ] {
        let found = unet(name, value);
        assert!(found.contains(told), "{found}");
    }
    let scheduler = |name: &str, value: &str| {
        line(SchedulerConfig::read(
            field("sd15/scheduler/scheduler_config.json", name, value).path(),
        ))
    };
    for (name, value, told) in [
        (
            "_class_name",
            "\"LMSDiscreteScheduler\"",
            "unknown variant `LMSDiscreteScheduler`",
        ),
        ("beta_schedule", "\"sigmoid\"", "unknown variant `sigmoid`"),
        ("prediction_type", "\"sample\"", "unknown variant `sample`"),
        (
            "use_karras_sigmas",
            "true",
            "use_karras_sigmas is true, expected false",
        ),
        (
            "skip_prk_steps",
            "false",
            "skip_prk_steps is false, expected true",
        ),
        ("num_train_timesteps", "1", "num_train_timesteps is 1"),
        ("steps_offset", "1000", "steps_offset is 1000"),
    ] {
        let found = scheduler(name, value);
        assert!(found.contains(told), "{found}");
    }
    let found = line(VaeConfig::read(
        field("sd15/vae/config.json", "up_block_types", "[]").path(),
    ));
    assert!(
        found.contains("up_block_types: expected 2 times UpDecoderBlock2D"),
        "{found}"
    );
    let found = line(TextConfig::read(
        field("sd15/text_encoder/config.json", "hidden_act", "\"relu\"").path(),
    ));
    assert!(found.contains("unknown variant `relu`"), "{found}");
    let order = field(
        "sd15/controlnet/config.json",
        "controlnet_conditioning_channel_order",
        "\"xyz\"",
    );
    assert!(line(ControlConfig::read(order.path())).contains("\"xyz\", expected"));
}

#[test]
fn row_62_folders() {
    let at = tempfile::tempdir().expect("a folder");
    let open = |at: &Path| line(Pipeline::open(&Folders::from_base(at), &Machine::cpu()));
    assert!(open(at.path()).contains("model_index.json: No such file"));
    let index = at.path().join("model_index.json");
    for (text, told) in [
        (
            "{\"_class_name\": \"StableDiffusionXLPipeline\"}",
            "expected a pipeline of Stable Diffusion 1 or 2",
        ),
        ("{}", "missing field `_class_name`"),
        ("[", "EOF"),
        ("\u{feff}", "expected value"),
    ] {
        std::fs::write(&index, text).expect("written");
        assert!(open(at.path()).contains(told), "{text}");
    }
    std::fs::write(at.path().join("pytorch_model.bin"), "x").expect("written");
    assert!(line(Weights::of_folder(at.path())).ends_with("found weights of another format"));
    assert!(line(Weights::of_folder(Path::new("/nowhere"))).ends_with("found no folder"));
    assert!(line(Weights::of_file(Path::new("/dev/zero"))).contains("a device or a pipe"));
    assert!(line(Words::open(at.path())).contains("vocab.json"));
    std::fs::write(at.path().join("vocab.json"), "{\"a\": 0}").expect("written");
    std::fs::write(at.path().join("merges.txt"), "a b c\nx").expect("written");
    line(Words::open(at.path()));
}

#[test]
fn parts_that_do_not_fit_each_other_are_refused() {
    // The UNet of one model with the rest of another.
    let folders = Folders {
        unet: folder("ring/unet"),
        ..Folders::from_base(&folder("sd15"))
    };
    let told = line(Pipeline::open(&folders, &Machine::cpu()));
    assert_eq!(
        told,
        "block_out_channels of a ControlNet is [16, 32] x 1, expected [8, 16] x 1"
    );
}
