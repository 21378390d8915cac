//! Tests of sequences of KITTI.
