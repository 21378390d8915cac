//! `sceneloom serve` as simulators use it: the built program, asked over the network.

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use ::serve::wire::{
    AvailableCamerasRequest, AvailableCamerasReturn, AvailableTrajectoriesRequest,
    AvailableTrajectoriesReturn, Empty, ImageFormat, LidarRenderRequest, LidarRenderReturn, PosePair,
    RgbRenderRequest, RgbRenderReturn, SERVICE, VersionId,
};
use editor::{Apply, Edit};
use glam::{DQuat, DVec3};
use scene::{Pose, Template};
use tonic::transport::{Channel, Endpoint};
use tonic::{Code, Status};
use tonic_prost::ProstCodec;

use crate::crowd::{crowd, open_files};

fn program(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sceneloom"));
    command
        .args(args)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY");
    command
}

struct Server {
    child: Child,
    address: String,
}

impl Server {
    fn start(args: &[&str]) -> Self {
        let mut command = program(&["serve", "--listen", "127.0.0.1:0"]);
        let mut child = command
            .args(args)
            .stdout(Stdio::piped())
            .spawn()
            .expect("the built program runs");
        let mut said = String::new();
        BufReader::new(child.stdout.take().expect("a pipe"))
            .read_line(&mut said)
            .expect("a line");
        let address = said
            .trim()
            .rsplit_once(" on ")
            .map(|(_, address)| address.to_owned());
        let address = address.unwrap_or_else(|| panic!("{said}"));
        Self { child, address }
    }

    fn channel(&self) -> Channel {
        let endpoint = Endpoint::from_shared(format!("http://{}", self.address));
        endpoint.expect("an address").connect_lazy()
    }

    /// Memory that it holds, MiB; 0 where the system does not tell.
    fn resident_mib(&self) -> u64 {
        let text = std::fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap_or_default();
        let line = text.lines().find_map(|l| l.strip_prefix("VmRSS:"));
        let kib = line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok());
        kib.unwrap_or(0) / 1024
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

async fn ask<Q, A>(channel: &Channel, method: &str, request: Q) -> Result<A, Status>
where
    Q: prost::Message + 'static,
    A: prost::Message + Default + 'static,
{
    let mut grpc = tonic::client::Grpc::new(channel.clone()).max_decoding_message_size(64 << 20);
    grpc.ready()
        .await
        .map_err(|e| Status::unavailable(e.to_string()))?;
    let path = format!("/{SERVICE}/{method}").parse().expect("a path");
    let codec = ProstCodec::<Q, A>::default();
    let answer = grpc.unary(tonic::Request::new(request), path, codec).await;
    answer.map(tonic::Response::into_inner)
}

fn block_on<T>(future: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.expect("a runtime").block_on(future)
}

/// A junction where the own vehicle drives for two seconds.
fn write_scene(path: &Path) {
    let made = program(&["new", "--template", "t-junction", "--seed", "4", "-o"])
        .arg(path)
        .output();
    assert!(made.expect("it runs").status.success());
    let mut scene = formats::loom::load(path).expect("a scene");
    let length = Edit::SetLength {
        length_s: 2.0,
        rate_hz: None,
    };
    let drive = Edit::LetMove {
        id: None,
        template: Template::Drive,
        mps: Some(6.0),
        from_s: None,
        gap_m: None,
    };
    for edit in [length, drive] {
        edit.apply(&mut scene).expect("an edit");
    }
    formats::loom::save(path, &scene).expect("saved");
}

fn pose_of(pose: &::serve::wire::WirePose) -> Pose {
    let (at, q) = (pose.vec.expect("a place"), pose.quat.expect("a rotation"));
    Pose {
        rotation: DQuat::from_xyzw(q.x.into(), q.y.into(), q.z.into(), q.w.into()).normalize(),
        translation_m: DVec3::new(at.x.into(), at.y.into(), at.z.into()),
    }
}

fn wire_of(pose: &Pose) -> ::serve::wire::WirePose {
    let (at, q) = (pose.translation_m.as_vec3(), pose.rotation.as_quat());
    ::serve::wire::WirePose {
        vec: Some(::serve::wire::Vec3 {
            x: at.x,
            y: at.y,
            z: at.z,
        }),
        quat: Some(::serve::wire::Quat {
            w: q.w,
            x: q.x,
            y: q.y,
            z: q.z,
        }),
    }
}

/// Pictures of all cameras along the way, from what the server offers alone.
async fn pictures(channel: &Channel, scene_id: &str, every: usize) -> Vec<RgbRenderRequest> {
    let of = AvailableCamerasRequest {
        scene_id: scene_id.into(),
    };
    let cameras: AvailableCamerasReturn = ask(channel, "get_available_cameras", of).await.expect("cameras");
    let of = AvailableTrajectoriesRequest {
        scene_id: scene_id.into(),
    };
    let ways: AvailableTrajectoriesReturn = ask(channel, "get_available_trajectories", of)
        .await
        .expect("ways");
    let way = ways.available_trajectories[0]
        .trajectory
        .clone()
        .expect("poses")
        .poses;
    let mut out = Vec::new();
    for at in way.iter().step_by(every) {
        for camera in &cameras.available_cameras {
            let ego = pose_of(&at.pose.expect("a pose"));
            let mount = pose_of(&camera.rig_to_camera.expect("a pose"));
            let pose = wire_of(&(ego * mount));
            out.push(RgbRenderRequest {
                scene_id: scene_id.into(),
                resolution_w: 160,
                resolution_h: 90,
                camera_intrinsics: camera.intrinsics.clone(),
                frame_start_us: at.timestamp_us,
                frame_end_us: at.timestamp_us + 1,
                sensor_pose: Some(PosePair {
                    start_pose: Some(pose),
                    end_pose: Some(pose),
                }),
                image_format: ImageFormat::Png.into(),
                ..RgbRenderRequest::default()
            });
        }
    }
    out
}

fn rgba(png: &[u8]) -> Vec<u8> {
    image::load_from_memory(png)
        .expect("a picture")
        .to_rgba8()
        .into_raw()
}

#[test]
fn a_simulator_sees_what_render_draws_in_many_sessions() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("junction.loom");
    write_scene(&path);
    let server = Server::start(&[&folder.path().display().to_string()]);
    let (requests, serial) = block_on(async {
        let channel = server.channel();
        let requests = pictures(&channel, "junction", 10).await;
        let mut serial = Vec::new();
        for request in &requests {
            let made: RgbRenderReturn = ask(&channel, "render_rgb", request.clone())
                .await
                .expect("a picture");
            serial.push(made.image_bytes);
        }
        (requests, serial)
    });
    assert_eq!(requests.len(), 18);
    let drawn = folder.path().join("drawn");
    let (path, out) = (path.display().to_string(), drawn.display().to_string());
    let args = [
        "render",
        &path,
        "--what",
        "appearance",
        "--size",
        "160x90",
        "--at",
        "0",
        "-o",
        &out,
    ];
    assert!(program(&args).output().expect("it runs").status.success());
    for (i, request) in requests[..6].iter().enumerate() {
        let name = request
            .camera_intrinsics
            .as_ref()
            .expect("a lens")
            .logical_id
            .clone();
        let file = std::fs::read(drawn.join(format!("{name}_appearance.png"))).expect("a file");
        assert!(rgba(&file) == rgba(&serial[i]), "{name}");
    }

    let round = || {
        block_on(async {
            let mut all = Vec::new();
            for session in 0..16 {
                let (channel, requests) = (server.channel(), requests.clone());
                all.push(tokio::spawn(async move {
                    let mut made = Vec::new();
                    for i in 0..4 {
                        let at = (session + 5 * i) % requests.len();
                        let one =
                            ask::<_, RgbRenderReturn>(&channel, "render_rgb", requests[at].clone()).await;
                        made.push((at, one.expect("a picture").image_bytes));
                    }
                    made
                }));
            }
            for one in all {
                for (at, bytes) in one.await.expect("no panic") {
                    assert!(bytes == serial[at], "request {at}");
                }
            }
        });
        server.resident_mib()
    };
    let rounds = [round(), round(), round()];
    println!("resident after rounds of 64 pictures: {rounds:?} MiB");
    assert!(rounds[2] <= rounds[0] + 64 && rounds[2] < 1500, "{rounds:?} MiB");
}

#[test]
fn sweeps_are_answered_and_errors_are_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("junction.loom");
    write_scene(&path);
    let mut server = Server::start(&[&path.display().to_string(), "--jobs", "1"]);
    block_on(async {
        let channel = server.channel();
        let at = wire_of(&Pose::from_wxyz([1.0, 0.0, 0.0, 0.0], [0.94, 0.0, 1.84]));
        let request = LidarRenderRequest {
            scene_id: "junction".into(),
            frame_end_us: 100_000,
            sensor_pose: Some(PosePair {
                start_pose: Some(at),
                end_pose: Some(at),
            }),
            ..LidarRenderRequest::default()
        };
        let sweep: LidarRenderReturn = ask(&channel, "render_lidar", request.clone())
            .await
            .expect("a sweep");
        assert!(sweep.num_points > 20_000, "{}", sweep.num_points);
        assert!(sweep.point_intensities.iter().all(|i| (0.0..=1.0).contains(i)));
        let unknown = LidarRenderRequest {
            scene_id: "nowhere".into(),
            ..request
        };
        let error = ask::<_, LidarRenderReturn>(&channel, "render_lidar", unknown).await;
        let error = error.expect_err("no such scene");
        assert_eq!(error.code(), Code::NotFound);
        assert!(!error.message().contains('\n'), "{error}");
    });
    // Told to end, it ends well.
    let pid = server.child.id().to_string();
    if cfg!(unix) {
        let told = Command::new("kill")
            .args(["-TERM", &pid])
            .status()
            .expect("kill runs");
        assert!(told.success());
        let start = Instant::now();
        let ended = loop {
            if let Some(ended) = server.child.try_wait().expect("a child") {
                break ended;
            }
            assert!(start.elapsed() < Duration::from_secs(30), "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        };
        assert!(ended.success(), "{ended}");
    }
}

/// A frame of HTTP/2.
fn frame(kind: u8, flags: u8, stream: u32, payload: &[u8]) -> Vec<u8> {
    let mut out = (payload.len() as u32).to_be_bytes()[1..].to_vec();
    out.extend([kind, flags]);
    out.extend(stream.to_be_bytes());
    out.extend(payload);
    out
}

/// The head of a request: POST, http, the path, and what gRPC wants, as literals of HPACK (RFC 7541).
fn head_of(method: &str) -> Vec<u8> {
    let path = format!("/{SERVICE}/{method}");
    let mut head = vec![0x83, 0x86];
    for (name, value) in [
        (vec![0x04], path.as_str()),
        (vec![0x0f, 0x10], "application/grpc"),
    ] {
        head.extend(name);
        head.push(value.len() as u8);
        head.extend(value.as_bytes());
    }
    head.extend(b"\x00\x02te\x08trailers");
    frame(1, 0x4, 1, &head)
}

/// What a hostile client says before it falls silent, by its number.
fn hostile(i: usize) -> Vec<u8> {
    let preface = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
    let mut out = preface.to_vec();
    match i % 6 {
        0 => return Vec::new(),
        1 => out.truncate(9),
        2 => out.extend(frame(4, 0, 0, &[])),
        // Half a head.
        3 => {
            out.extend(frame(4, 0, 0, &[]));
            let head = head_of("render_rgb");
            out.extend(&head[..head.len() / 2]);
        }
        // A body that never ends.
        4 => {
            out.extend(frame(4, 0, 0, &[]));
            out.extend(head_of("render_rgb"));
            out.extend(frame(0, 0, 1, &[0, 0, 0, 9, 0, 1, 2, 3]));
        }
        // An answer that is never taken: SETTINGS_INITIAL_WINDOW_SIZE is 0.
        _ => {
            out.extend(frame(4, 0, 0, &[0, 4, 0, 0, 0, 0]));
            out.extend(head_of("get_version"));
            out.extend(frame(0, 1, 1, &[0; 5]));
        }
    }
    out
}

#[test]
fn silent_slow_and_half_connections_keep_no_honest_client_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("junction.loom");
    write_scene(&path);
    let server = Server::start(&[&path.display().to_string(), "--jobs", "1"]);
    let honest = |channel: Channel| async move {
        let asked = ask::<_, VersionId>(&channel, "get_version", Empty {});
        let answer = tokio::time::timeout(Duration::from_secs(60), asked).await;
        answer.expect("an answer at all").expect("a version");
        let requests = tokio::time::timeout(Duration::from_secs(60), pictures(&channel, "junction", 100));
        assert!(!requests.await.expect("an answer at all").is_empty());
    };
    block_on(async {
        let before = server.channel();
        honest(before.clone()).await;
        let crowd = crowd(&server.address, hostile);
        let start = Instant::now();
        honest(server.channel()).await;
        println!("a new client was answered after {:?}", start.elapsed());
        honest(before).await;
        if let Some(files) = open_files(server.child.id()) {
            assert!(
                files < 800,
                "{files} files are open for {} connections",
                crowd.len()
            );
        }
    });
}

#[test]
fn what_cannot_be_served_is_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path().display().to_string();
    let refused = |args: &[&str]| -> String {
        let Output { status, stderr, .. } = program(args).output().expect("it runs");
        let said = String::from_utf8_lossy(&stderr).into_owned();
        assert_eq!(
            (status.code(), said.trim_end().lines().count()),
            (Some(2), 1),
            "{said}"
        );
        said
    };
    assert!(refused(&["serve", &folder]).contains("no scene to serve"));
    assert!(refused(&["serve", "/no/such/scene.loom"]).contains("no such file"));
    let path = format!("{folder}/a.loom");
    write_scene(Path::new(&path));
    let taken = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = taken.local_addr().expect("an address").to_string();
    assert!(refused(&["serve", &path, "--listen", &address]).contains("listen on"));
}
