# packages: av==18.1.0 numpy==2.4.6
"""Decodes the control videos of a folder with PyAV (FFmpeg): pictures, rate, size, and the colours that are drawn."""

import json
import sys
from pathlib import Path

import av
import numpy as np

# Colours of lines, and of the cuboids in front and behind, as the models know them.
BOUNDARY = (253, 1, 232)


def main(folder):
    found = {}
    for path in sorted(Path(folder).glob("*.mp4")):
        with av.open(str(path)) as movie:
            (stream,) = movie.streams.video
            assert stream.codec_context.name == "h264" and round(float(stream.average_rate)) == 30, stream
            pictures = [frame.to_ndarray(format="rgb24") for frame in movie.decode(stream)]
        shape = pictures[0].shape
        assert all(p.shape == shape for p in pictures) and shape[0] <= 720 and shape[1] <= 1280, shape
        assert len(pictures) > 1, path
        first = pictures[0].astype(int)
        black = (first.max(axis=2) < 24).mean()
        assert 0.2 < black <= 1, f"{path}: {black} of the picture is black"
        # Colours go to black with distance: their hue stays.
        lit = first[first.max(axis=2) > 100]
        hue = lit / np.maximum(lit.max(axis=1, keepdims=True), 1)
        boundary = np.array(BOUNDARY) / max(BOUNDARY)
        found[path.name] = {
            "pictures": len(pictures),
            "size": [shape[1], shape[0]],
            "black": round(float(black), 3),
            "boundary_px": int((np.abs(hue - boundary).max(axis=1) < 0.15).sum()) if len(lit) else 0,
        }
    assert found, "no videos"
    return found


if __name__ == "__main__":
    try:
        found = main(sys.argv[1])
    except Exception as error:  # one line for whoever runs all readers
        sys.exit(f"{type(error).__name__}: {error}".replace("\n", " ")[:300])
    print(json.dumps({"reader": "PyAV", "version": av.__version__, "accepted": True, "read": found}))
