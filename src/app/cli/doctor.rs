//! `sceneloom doctor`: the capabilities of this machine.

use serde_json::json;

use super::{CommandResult, Common, Weights, output};
use nets::OccModels;
use viewport::headless_device;

/// Arguments.
#[derive(clap::Args)]
pub struct Doctor {
    #[command(flatten)]
    weights: Weights,
    #[command(flatten)]
    common: Common,
}

/// True if a window could open: a display server is named, or the system always has one.
pub fn has_display() -> bool {
    let named = |variable: &str| std::env::var_os(variable).is_some_and(|v| !v.is_empty());
    cfg!(any(target_os = "windows", target_os = "macos")) || named("DISPLAY") || named("WAYLAND_DISPLAY")
}

#[cfg(target_arch = "x86_64")]
fn simd() -> Vec<&'static str> {
    let mut found = Vec::new();
    for (name, here) in [
        ("avx2", is_x86_feature_detected!("avx2")),
        ("fma", is_x86_feature_detected!("fma")),
        ("avx512f", is_x86_feature_detected!("avx512f")),
    ] {
        if here {
            found.push(name);
        }
    }
    found
}

#[cfg(not(target_arch = "x86_64"))]
fn simd() -> Vec<&'static str> {
    Vec::new()
}

impl Doctor {
    pub(super) fn run(self, version: &str) -> CommandResult {
        let adapter = match headless_device() {
            Ok((info, ..)) => {
                json!({ "name": info.name, "kind": format!("{:?}", info.device_type), "backend": format!("{:?}", info.backend) })
            }
            Err(error) => json!({ "error": error.to_string() }),
        };
        let weights = match OccModels::open(self.weights.folder.as_deref()) {
            Ok(models) => json!({ "name": models.card.name, "ok": true }),
            Err(error) => json!({ "ok": false, "error": output::one_line(&error.into()) }),
        };
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let report = json!({
            "version": version,
            "display": has_display(),
            "adapter": adapter,
            "threads": threads,
            "simd": simd(),
            "log": app::shell::logging::file(),
            "weights": weights,
        });
        output::report(&self.common, &report, || {
            let rows = [
                ("version", report["version"].to_string()),
                (
                    "display",
                    if has_display() {
                        "yes".into()
                    } else {
                        "none: the editor will run the demo instead".into()
                    },
                ),
                ("adapter", adapter.to_string()),
                ("threads", threads.to_string()),
                ("simd", simd().join(" ")),
                ("log", report["log"].as_str().unwrap_or("nowhere").to_owned()),
                ("weights", weights.to_string()),
            ];
            rows.map(|(name, value)| format!("{name:<8} {value}")).join("\n")
        });
        Ok(())
    }
}
