//! `sceneloom serve`: a renderer for simulators, over gRPC.

use std::net::SocketAddr;
use std::path::PathBuf;

use super::CommandResult;
#[cfg(feature = "serve")]
use ::serve::{Options, Quality, Server, ServerLidarModel};

/// Arguments.
#[derive(clap::Args)]
pub struct Serve {
    /// Scenes, and folders whose .loom files are served; a scene's id is its file's name without the ending.
    #[arg(required = true, value_name = "FOLDER|SCENE")]
    scenes: Vec<PathBuf>,
    /// Where to listen; port 0 stands for any free one. Whoever reaches the address may ask.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:50051")]
    listen: SocketAddr,
    /// Requests that are rendered at a time.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u16).range(1..=256))]
    jobs: u16,
    /// Requests that wait at most; more are refused.
    #[arg(long, value_name = "N", default_value_t = 64)]
    waiting: u16,
    /// Scenes that are kept in memory.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..))]
    keep: u16,
    /// How LiDAR sweeps come about.
    #[arg(long, value_name = "MODEL", value_parser = ["learned", "exact"], default_value = "learned")]
    lidar: String,
    /// Effort for pictures: full is what `render` makes; preview leaves edges jagged; play also computes only every second pixel
    /// where nothing changes from one to the next. Both are faster.
    #[arg(long, value_name = "EFFORT", value_parser = ["full", "preview", "play"], default_value = "full")]
    pictures: String,
}

impl Serve {
    /// Errors with how to get a program that has the server.
    #[cfg(not(feature = "serve"))]
    pub(super) fn run(self) -> CommandResult {
        let Self {
            scenes: _,
            listen: _,
            jobs: _,
            waiting: _,
            keep: _,
            lidar: _,
            pictures: _,
        } = self;
        Err(anyhow::anyhow!(
            "the renderer for simulators is not in this program; build it with cargo build --release --features serve"
        )
        .into())
    }

    #[cfg(feature = "serve")]
    pub(super) fn run(self) -> CommandResult {
        let server = Server::bind(Options {
            listen: self.listen,
            jobs: self.jobs.into(),
            waiting: self.waiting.into(),
            kept: self.keep.into(),
            lidar: match self.lidar.as_str() {
                "exact" => ServerLidarModel::Exact,
                _ => ServerLidarModel::Learned,
            },
            quality: match self.pictures.as_str() {
                "play" => Quality::Play,
                "preview" => Quality::Preview,
                _ => Quality::Full,
            },
            ..Options::new(self.scenes)
        })?;
        let (address, scenes) = (server.address()?, server.scenes());
        let noun = if scenes == 1 { "scene" } else { "scenes" };
        println!("serving {scenes} {noun} on {address}");
        server.run_until_signal()?;
        Ok(())
    }
}
