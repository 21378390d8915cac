"""Drives Sceneloom, an editor for driving scenes, by typed calls.

>>> from sceneloom import Session, edits
>>> with Session(folder="scenes") as s:
...     s.new(template="t-junction", seed=3)
...     s.apply(edits=[edits.add_box(class_="pedestrian", center_m=[12, 3, 0.9], size_m=[0.7, 0.7, 1.8], yaw_deg=0)])
...     labels = s.voxels()  # an array of u8 [200, 200, 16]
...     s.save(file="a.loom", replace=True)

Lengths are in m, angles in degrees counter-clockwise from x, times in s; x is ahead, y left, z up. Arrays are numpy's where
numpy is installed, else memoryviews of the same shape. A file that is there is written over only with replace=True.
"""

from . import arrays, edits
from .session import CallError, Session, SessionEnded

__all__ = ["CallError", "Session", "SessionEnded", "arrays", "edits"]
