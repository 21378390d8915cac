# packages: foxglove-schemas-protobuf==0.4.0
"""Writes foxglove.desc: the descriptors of the messages that the exporter uses, from Foxglove's own package (MIT licence).

python make_descriptors.py foxglove.desc
"""
import importlib
import sys

from google.protobuf.descriptor_pb2 import FileDescriptorProto, FileDescriptorSet

MESSAGES = [
    "CameraCalibration",
    "CompressedImage",
    "FrameTransforms",
    "Grid",
    "PointCloud",
    "PoseInFrame",
    "SceneUpdate",
    "VoxelGrid",
]


def add(found, file):
    for dependency in file.dependencies:
        add(found, dependency)
    if all(known.name != file.name for known in found.file):
        descriptor = FileDescriptorProto()
        file.CopyToProto(descriptor)
        found.file.append(descriptor)


found = FileDescriptorSet()
for name in MESSAGES:
    add(found, importlib.import_module(f"foxglove_schemas_protobuf.{name}_pb2").DESCRIPTOR)
with open(sys.argv[1], "wb") as out:
    out.write(found.SerializeToString(deterministic=True))
