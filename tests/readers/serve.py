# packages: grpcio==1.76.0 grpcio-tools==1.76.0 numpy==2.4.6 pillow==13.0.0
"""Asks a started `sceneloom serve` as a simulator does, with a client made from docs/sensorsim.proto by grpcio-tools.

python serve.py ADDRESS:PORT [--pid PID] [--measure]; the first scene is used. Prints one line of JSON. `--pid` watches the memory of the
server while 16 sessions ask at once; `--measure` tells how long pictures of two sizes and a sweep take, alone and one after another.
"""

import argparse
import concurrent.futures
import importlib.metadata
import importlib.util
import io
import json
import statistics
import sys
import tempfile
import time
from pathlib import Path

import grpc
import grpc_tools.protoc
import numpy as np
from PIL import Image

PROTO = Path(__file__).resolve().parents[2] / "docs" / "sensorsim.proto"
LARGEST = [("grpc.max_receive_message_length", 64 << 20)]


class Wrong(Exception):
    """Something is not as it should be."""


def expect(holds, what):
    if not holds:
        raise Wrong(what)


def client():
    """The modules that protoc makes: messages, and the stub."""
    folder = tempfile.mkdtemp()
    args = ["protoc", f"-I{PROTO.parent}", f"--python_out={folder}", f"--grpc_python_out={folder}", str(PROTO)]
    expect(grpc_tools.protoc.main(args) == 0, "protoc does not take docs/sensorsim.proto")
    sys.path.insert(0, folder)
    import sensorsim_pb2
    import sensorsim_pb2_grpc

    return sensorsim_pb2, sensorsim_pb2_grpc


def matrix(pose):
    w, x, y, z = (getattr(pose.quat, k) for k in "wxyz")
    m = np.eye(4)
    m[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    m[:3, 3] = [pose.vec.x, pose.vec.y, pose.vec.z]
    return m


def times(a, b):
    """a * b of two poses, in 32 bits as simulators do."""
    aw, ax, ay, az = (np.float32(getattr(a.quat, k)) for k in "wxyz")
    bw, bx, by, bz = (np.float32(getattr(b.quat, k)) for k in "wxyz")
    quat = [
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    ]
    at = matrix(a).astype(np.float32) @ np.float32([b.vec.x, b.vec.y, b.vec.z, 1])
    return type(a)(vec=dict(zip("xyz", map(float, at))), quat=dict(zip("wxyz", map(float, quat))))


def resident_mb(pid):
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1024
    return 0.0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("address")
    parser.add_argument("--pid", type=int)
    parser.add_argument("--measure", action="store_true")
    args = parser.parse_args()
    pb, stubs = client()
    stub = stubs.SensorsimServiceStub(grpc.insecure_channel(args.address, options=LARGEST))
    version = stub.get_version(pb.Empty(), wait_for_ready=True, timeout=30)
    scene = stub.get_available_scenes(pb.Empty()).scene_ids[0]
    cameras = stub.get_available_cameras(pb.AvailableCamerasRequest(scene_id=scene)).available_cameras
    ways = stub.get_available_trajectories(pb.AvailableTrajectoriesRequest(scene_id=scene))
    way = ways.available_trajectories[0].trajectory.poses
    expect(len(stub.get_available_ego_masks(pb.Empty()).ego_mask_metadata) == 0, "there are ego masks")
    expect(cameras and way, f"{len(cameras)} cameras and {len(way)} poses")

    def picture(camera, at, size, packing=pb.PNG):
        pose = times(at.pose, camera.rig_to_camera)
        return pb.RGBRenderRequest(
            scene_id=scene,
            resolution_w=size[0],
            resolution_h=size[1],
            camera_intrinsics=camera.intrinsics,
            frame_start_us=at.timestamp_us,
            frame_end_us=at.timestamp_us + 1,
            sensor_pose=pb.PosePair(start_pose=pose, end_pose=pose),
            ego_pose=pb.PosePair(start_pose=at.pose, end_pose=at.pose),
            image_format=packing,
            image_quality=95,
        )

    def sweep(at, device):
        mount = pb.Pose(vec=pb.Vec3(x=0.94, z=1.84), quat=pb.Quat(w=1))
        pose = times(at.pose, mount)
        return pb.LidarRenderRequest(
            scene_id=scene,
            lidar_config=pb.LidarSpec(lidar_type=device),
            frame_start_us=at.timestamp_us,
            frame_end_us=at.timestamp_us + 100_000,
            sensor_pose=pb.PosePair(start_pose=pose, end_pose=pose),
        )

    # Pictures in the three packings show the same.
    size = (160, 90)
    png = np.asarray(Image.open(io.BytesIO(stub.render_rgb(picture(cameras[0], way[0], size)).image_bytes)))
    expect(png.shape == (90, 160, 3), f"a picture of {png.shape}")
    planar = stub.render_rgb(picture(cameras[0], way[0], size, pb.RGB_UINT8_PLANAR)).image_bytes
    planar = np.frombuffer(planar, np.uint8).reshape(3, 90, 160).transpose(1, 2, 0)
    expect((planar == png).all(), "PNG and planes differ")
    jpeg = stub.render_rgb(picture(cameras[0], way[0], size, pb.JPEG)).image_bytes
    off = np.abs(np.asarray(Image.open(io.BytesIO(jpeg))).astype(int) - png).mean()
    expect(off < 4, f"JPEG and PNG differ by {off}")

    # A batch has a picture of every camera, an aggregate what was asked for one by one.
    items = [pb.BatchRGBRenderRequestItem(camera_name=c.logical_id, request=picture(c, way[0], size)) for c in cameras]
    batch = stub.batch_render_rgb(pb.BatchRGBRenderRequest(items=items)).items
    expect([b.camera_name for b in batch] == [c.logical_id for c in cameras], "names of a batch")
    expect(all(b.success for b in batch), [b.error_message for b in batch])
    clouds = {}
    for name, device in pb.LidarDeviceType.items():
        both = stub.render_aggregated(
            pb.AggregatedRenderRequest(rgb_requests=[picture(cameras[0], way[0], size)], lidar_requests=[sweep(way[0], device)])
        )
        expect(both.rgb_returns[0] == batch[0].result, "one by one and together differ")
        cloud = both.lidar_returns[0]
        xyz = np.frombuffer(cloud.point_xyzs_buffer, "<f4").reshape(-1, 3)
        intensity = np.frombuffer(cloud.point_intensities_buffer, "<f4")
        expect(len(xyz) == cloud.num_points == len(intensity) > 1000, f"{len(xyz)} points")
        expect(np.array_equal(xyz.ravel(), np.float32(cloud.point_xyzs)), "points and buffer differ")
        expect(np.isfinite(xyz).all() and 0 <= intensity.min() and intensity.max() <= 1, "bad points")
        clouds[name] = int(cloud.num_points)

    # What is wrong is told in one line.
    refused = {}
    for code, change in {
        "NOT_FOUND": {"scene_id": "no such scene"},
        "INVALID_ARGUMENT": {"resolution_w": 1 << 20},
        "UNIMPLEMENTED": {"image_format": pb.AV1},
    }.items():
        bad = picture(cameras[0], way[0], size)
        for field, value in change.items():
            setattr(bad, field, value)
        try:
            stub.render_rgb(bad)
            raise Wrong(f"{change} is served")
        except grpc.RpcError as error:
            expect(error.code().name == code and "\n" not in error.details(), f"{change}: {error.code()}")
            refused[code] = error.details()

    # 16 sessions at once, each on a connection of its own, see what one sees.
    moments = [way[0], way[len(way) // 2], way[-1]]
    requests = [picture(c, at, (96, 54), pb.JPEG) for c in cameras[:2] for at in moments]
    serial = [stub.render_rgb(r).image_bytes for r in requests]
    memory = [resident_mb(args.pid)] if args.pid else []

    def session(number):
        own = stubs.SensorsimServiceStub(
            grpc.insecure_channel(args.address, options=[*LARGEST, ("grpc.use_local_subchannel_pool", 1)])
        )
        for i in range(3):
            at = (number + i) % len(requests)
            expect(own.render_rgb(requests[at]).image_bytes == serial[at], f"session {number} sees something else")

    for _ in range(3 if args.pid else 1):
        with concurrent.futures.ThreadPoolExecutor(16) as pool:
            list(pool.map(session, range(16)))
        if args.pid:
            memory.append(resident_mb(args.pid))

    report = {
        "reader": "grpcio",
        "version": importlib.metadata.version("grpcio"),
        "accepted": True,
        "read": {
            "server": version.version_id,
            "scene": scene,
            "cameras": len(cameras),
            "poses": len(way),
            "points": clouds,
            "refused": sorted(refused),
            "sessions": 16,
        },
    }
    if memory:
        report["read"]["resident_mb"] = [round(m) for m in memory]
    if args.measure:
        report["read"]["ms"] = measured(stub, picture, sweep, cameras, way, pb, args.pid)
    print(json.dumps(report))


def processor_s(pid):
    """Processor time of the server so far, all its threads."""
    if not pid:
        return 0.0
    fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / 100


def measured(stub, picture, sweep, cameras, way, pb, pid):
    """Median time, and mean processor time of the server, ms: moments one after another, so that nothing is kept from the last."""
    out = {}

    def time_of(name, count, ask):
        took, before = [], processor_s(pid)
        for i in range(count):
            start = time.perf_counter()
            ask(i)
            took.append(time.perf_counter() - start)
        spent = (processor_s(pid) - before) / count
        out[name] = [round(1000 * statistics.median(took)), round(1000 * spent)]

    for w, h in [(400, 225), (1600, 900)]:
        for name, packing in [("JPEG", pb.JPEG), ("PNG", pb.PNG)]:
            time_of(
                f"{w}x{h} {name}",
                5,
                lambda i: stub.render_rgb(picture(cameras[i % len(cameras)], way[i % len(way)], (w, h), packing)),
            )
    for name, device in pb.LidarDeviceType.items():
        time_of(name, 2, lambda i: stub.render_lidar(sweep(way[i % len(way)], device)))
    return out


if __name__ == "__main__":
    try:
        main()
    except (Wrong, grpc.RpcError, OSError) as wrong:
        print(f"serve.py: {wrong}", file=sys.stderr)
        sys.exit(1)
