//! Files that ship inside the program. A crate of its own, so that weights are compiled into it once.

/// Files of `assets/keys`.
pub mod keys {
    /// `blender.json`.
    pub static BLENDER: &str = include_str!("keys/blender.json");
    /// `labeler.json`.
    pub static LABELER: &str = include_str!("keys/labeler.json");
    /// `magicavoxel.json`.
    pub static MAGICAVOXEL: &str = include_str!("keys/magicavoxel.json");
}

/// Files of `assets/licences`.
pub mod licences {
    /// `notices.txt`, made by `make.py` beside it: licences of libraries and data inside the program.
    pub static NOTICES: &str = include_str!("licences/notices.txt");
}

/// Files of `assets/memory`.
pub mod memory {
    /// `bank.json`.
    pub static BANK: &str = include_str!("memory/bank.json");
}

/// Files of `assets/rigs`.
pub mod rigs {
    /// `nuscenes.json`.
    pub static NUSCENES: &str = include_str!("rigs/nuscenes.json");
}

/// Files of `assets/roads`.
pub mod roads {
    /// `every_geometry.xodr`.
    pub static EVERY_GEOMETRY: &[u8] = include_bytes!("roads/every_geometry.xodr");
    /// `four_arm_junction.xodr`.
    pub static FOUR_ARM_JUNCTION: &[u8] = include_bytes!("roads/four_arm_junction.xodr");
    /// `left_hand_bend.xodr`.
    pub static LEFT_HAND_BEND: &[u8] = include_bytes!("roads/left_hand_bend.xodr");
    /// `motorway_exit.xodr`.
    pub static MOTORWAY_EXIT: &[u8] = include_bytes!("roads/motorway_exit.xodr");
    /// `parking_street.xodr`.
    pub static PARKING_STREET: &[u8] = include_bytes!("roads/parking_street.xodr");
    /// `straight_two_way.xodr`.
    pub static STRAIGHT_TWO_WAY: &[u8] = include_bytes!("roads/straight_two_way.xodr");
}

/// Files of `assets/scenes`.
pub mod scenes {
    /// `first_light.loom`.
    pub static FIRST_LIGHT: &[u8] = include_bytes!("scenes/first_light.loom");
}

/// Files of `assets/statistics`.
pub mod statistics {
    /// `layout.json`.
    pub static LAYOUT: &str = include_str!("statistics/layout.json");
    /// `lidar.json`.
    pub static LIDAR: &str = include_str!("statistics/lidar.json");
    /// `occ3d.json`.
    pub static OCC3D: &str = include_str!("statistics/occ3d.json");
}

/// Files of `assets/trade`.
pub mod trade {
    /// `presets.json`.
    pub static PRESETS: &str = include_str!("trade/presets.json");
}

/// Files of `assets/thumbnails`.
pub mod thumbnails {
    /// `curve.png`.
    pub static CURVE: &[u8] = include_bytes!("thumbnails/curve.png");
    /// `highway.png`.
    pub static HIGHWAY: &[u8] = include_bytes!("thumbnails/highway.png");
    /// `intersection.png`.
    pub static INTERSECTION: &[u8] = include_bytes!("thumbnails/intersection.png");
    /// `parking.png`.
    pub static PARKING: &[u8] = include_bytes!("thumbnails/parking.png");
    /// `roundabout.png`.
    pub static ROUNDABOUT: &[u8] = include_bytes!("thumbnails/roundabout.png");
    /// `straight.png`.
    pub static STRAIGHT: &[u8] = include_bytes!("thumbnails/straight.png");
    /// `suburb.png`.
    pub static SUBURB: &[u8] = include_bytes!("thumbnails/suburb.png");
    /// `t_junction.png`.
    pub static T_JUNCTION: &[u8] = include_bytes!("thumbnails/t_junction.png");
}

/// Files of `assets/weights`.
pub mod weights {
    /// `f3d.safetensors`.
    pub static F3D: &[u8] = include_bytes!("weights/f3d.safetensors");
    /// `layout.safetensors`.
    pub static LAYOUT: &[u8] = include_bytes!("weights/layout.safetensors");
    /// `lidar.safetensors`.
    pub static LIDAR: &[u8] = include_bytes!("weights/lidar.safetensors");
    /// `lidar_flat.safetensors`.
    pub static LIDAR_FLAT: &[u8] = include_bytes!("weights/lidar_flat.safetensors");
    /// `lidar_perceiver.safetensors`.
    pub static LIDAR_PERCEIVER: &[u8] = include_bytes!("weights/lidar_perceiver.safetensors");
    /// `occ_dit.safetensors`.
    pub static OCC_DIT: &[u8] = include_bytes!("weights/occ_dit.safetensors");
    /// `occ_dit_time.safetensors`.
    pub static OCC_DIT_TIME: &[u8] = include_bytes!("weights/occ_dit_time.safetensors");
    /// `occ_vae.safetensors`.
    pub static OCC_VAE: &[u8] = include_bytes!("weights/occ_vae.safetensors");
    /// `occ_vae_fine.safetensors`.
    pub static OCC_VAE_FINE: &[u8] = include_bytes!("weights/occ_vae_fine.safetensors");
    /// `pictures_dit.safetensors`.
    pub static PICTURES_DIT: &[u8] = include_bytes!("weights/pictures_dit.safetensors");
    /// `pictures_segmenter.safetensors`.
    pub static PICTURES_SEGMENTER: &[u8] = include_bytes!("weights/pictures_segmenter.safetensors");
    /// `pictures_vae.safetensors`.
    pub static PICTURES_VAE: &[u8] = include_bytes!("weights/pictures_vae.safetensors");
    /// `reader.safetensors`.
    pub static READER: &[u8] = include_bytes!("weights/reader.safetensors");
    /// `refiner.safetensors`.
    pub static REFINER: &[u8] = include_bytes!("weights/refiner.safetensors");
    /// `scenery.safetensors`.
    pub static SCENERY: &[u8] = include_bytes!("weights/scenery.safetensors");
    /// `sensor_occupancy.safetensors`.
    pub static SENSOR_OCCUPANCY: &[u8] = include_bytes!("weights/sensor_occupancy.safetensors");
    /// `text.safetensors`.
    pub static TEXT: &[u8] = include_bytes!("weights/text.safetensors");
    /// `time_decoder.safetensors`.
    pub static TIME_DECODER: &[u8] = include_bytes!("weights/time_decoder.safetensors");
}

/// Files of `assets/words`.
pub mod words {
    /// `english.txt`.
    pub static ENGLISH: &str = include_str!("words/english.txt");
    /// `grammar.txt`.
    pub static GRAMMAR: &str = include_str!("words/grammar.txt");
    /// `lexicon.txt`.
    pub static LEXICON: &str = include_str!("words/lexicon.txt");
    /// `things.txt`.
    pub static THINGS: &str = include_str!("words/things.txt");
}
