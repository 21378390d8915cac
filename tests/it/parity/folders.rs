//! Folders of weights: what they may lack, and which files belong together.

use super::*;

#[test]
fn weights_from_a_folder() {
    let shipped = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/weights");
    let read = OccModels::from_dir(&shipped).expect("the shipped weights");
    assert_eq!(read.card, models().card);
    let folder = tempfile::tempdir().expect("a folder");
    let refusal = || {
        OccModels::from_dir(folder.path())
            .map(|_| ())
            .expect_err("refused")
            .to_string()
    };
    assert!(refusal().contains("occ_vae.safetensors: "));
    let vae = std::fs::read(shipped.join("occ_vae.safetensors")).expect("the file");
    std::fs::write(folder.path().join("occ_vae.safetensors"), &vae).expect("written");
    assert!(refusal().contains("occ_dit.safetensors: "));
    std::fs::write(folder.path().join("occ_dit.safetensors"), &vae).expect("written");
    assert!(
        refusal().starts_with("occ_dit.safetensors: metadata"),
        "{}",
        refusal()
    );
    std::fs::write(folder.path().join("occ_vae.safetensors"), &vae[..vae.len() / 2]).expect("written");
    assert!(refusal().starts_with("occ_vae.safetensors: not a usable safetensors file"));
}

/// A folder may lack the fine stage, which is said; one with a refiner of another fine VAE is refused.
#[test]
fn the_fine_stage_of_a_folder() {
    let shipped = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/weights");
    let folder = tempfile::tempdir().expect("a folder");
    let copy = |name: &str| std::fs::copy(shipped.join(name), folder.path().join(name)).expect("copied");
    copy("occ_vae.safetensors");
    copy("occ_dit.safetensors");
    let models = OccModels::from_dir(folder.path()).expect("two networks");
    assert!(models.refiner.is_none() && models.card != self::models().card);
    let (latent, cells) = (uniform(LATENT, 9), [true; CELLS]);
    let refined = decode_refined(&models, &latent, &cells, DecoderInput::default(), (2, 1));
    assert_eq!(
        refined.expect("no stage"),
        models.vae.decode(&latent).expect("a finite latent")
    );
    let params = GenParams {
        steps: 1,
        region: RegionMode::Full,
        ..GenParams::default()
    };
    let scene = Arc::new(open::from_template("straight", 3).expect("a template"));
    let result = OccPipeline::new(models).run(&Job { scene, params }, &JobCtx::detached());
    let notes = result.expect("a result").report.notes;
    assert!(notes.iter().any(|n| n.contains("no fine stage")), "{notes:?}");

    copy("refiner.safetensors");
    copy("occ_vae_fine.safetensors");
    let whole = OccModels::from_dir(folder.path()).expect("all networks");
    assert_eq!(whole.card, self::models().card);
    let fine = folder.path().join("occ_vae_fine.safetensors");
    let mut bytes = std::fs::read(&fine).expect("the file");
    let name = b"09844dff0a03";
    let at = bytes
        .windows(name.len())
        .position(|w| w == name)
        .expect("its name");
    bytes[at] = b'1';
    std::fs::write(&fine, bytes).expect("written");
    let error = OccModels::from_dir(folder.path())
        .map(|_| ())
        .expect_err("another fine VAE");
    assert!(
        error
            .to_string()
            .starts_with("refiner.safetensors: metadata \"fine\""),
        "{error}"
    );
}
