//! What lies under the pointer: rays against boxes, voxels and the ground, points against footprints.
