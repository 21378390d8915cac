"""The networks: one file each, with the same names and order of blocks as their Rust twins in src/gen/model/."""
