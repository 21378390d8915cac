# packages: mcap==1.6.0 mcap-protobuf-support==0.6.0 numpy
"""Opens an exported file with Foxglove's readers: decodes every message, checks grids, points, pictures, frames."""
import io
import json
import sys
from collections import Counter
from importlib.metadata import version

del sys.path[0]  # this file is called like the package

import numpy as np
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

NUMBERS = {1: "u1", 3: "<u2", 7: "<f4"}


def expect(holds, what):
    if not holds:
        sys.exit(f"mcap: {what}")


def packed(message, stride):
    """Packed data as a numpy array with the fields of the message."""
    dtype = np.dtype(
        {
            "names": [f.name for f in message.fields],
            "formats": [NUMBERS[f.type] for f in message.fields],
            "offsets": [f.offset for f in message.fields],
            "itemsize": stride,
        }
    )
    return np.frombuffer(message.data, dtype=dtype)


def main():
    with open(sys.argv[1], "rb") as file:
        data = file.read()
    reader = make_reader(io.BytesIO(data), validate_crcs=True, decoder_factories=[DecoderFactory()])
    summary = reader.get_summary()
    expect(summary is not None and summary.statistics is not None, "no summary")
    messages, read, frames = Counter(), Counter(), {"map"}
    last = {}
    for schema, channel, message, decoded in reader.iter_decoded_messages():
        topic, name = channel.topic, schema.name
        messages[topic] += 1
        last[topic] = message.log_time
        if name == "foxglove.FrameTransforms":
            for transform in decoded.transforms:
                expect(transform.parent_frame_id in frames, f"{topic}: {transform.parent_frame_id} hangs nowhere")
                frames.add(transform.child_frame_id)
                q = transform.rotation
                expect(abs(q.x**2 + q.y**2 + q.z**2 + q.w**2 - 1) < 1e-9, f"{topic}: no unit quaternion")
        elif name == "foxglove.SceneUpdate":
            read["boxes"] += sum(len(e.cubes) for e in decoded.entities)
            expect(all(e.frame_id in frames for e in decoded.entities), f"{topic}: an unknown frame")
            expect(all(min(c.size.x, c.size.y, c.size.z) > 0 for e in decoded.entities for c in e.cubes), f"{topic}: a size")
        elif name == "foxglove.PointCloud":
            points = packed(decoded, decoded.point_stride)
            expect(np.isfinite(points["x"]).all() and np.abs(points["z"]).max(initial=0) < 200, f"{topic}: points")
            expect(points["class"].max(initial=0) <= 16, f"{topic}: a class")
            read["points"] += len(points)
        elif name == "foxglove.CompressedImage":
            expect(decoded.format == "jpeg" and bytes(decoded.data[:2]) == b"\xff\xd8", f"{topic}: no JPEG")
            expect(decoded.frame_id in frames, f"{topic}: an unknown frame")
            read["pictures"] += 1
        elif name == "foxglove.CameraCalibration":
            expect(len(decoded.K) == 9 and len(decoded.P) == 12 and decoded.K[0] > 0, f"{topic}: intrinsics")
        elif name == "foxglove.Grid":
            cells = packed(decoded, decoded.cell_stride)
            expect(len(cells) % decoded.column_count == 0, f"{topic}: {len(cells)} cells")
            if topic == "/drivable_area":
                read["drivable_cells"] = int(cells["drivable_area"].sum())
        elif name == "foxglove.VoxelGrid":
            cells = packed(decoded, decoded.cell_stride)
            slices = len(decoded.data) // decoded.slice_stride
            expect(len(cells) == slices * decoded.row_count * decoded.column_count, f"{topic}: {len(cells)} voxels")
            expect(((cells["class"] == 17) == (cells["alpha"] == 0)).all(), f"{topic}: free voxels are not transparent")
            read["voxels"] = int((cells["class"] != 17).sum())
    expect(sum(messages.values()) == summary.statistics.message_count, "another number of messages than in the summary")
    read.update(messages=sum(messages.values()), topics=len(messages))
    read["last_s"] = max(last.values()) / 1e9
    print(json.dumps({"reader": "mcap", "version": version("mcap"), "accepted": True, "read": dict(read)}))


main()
