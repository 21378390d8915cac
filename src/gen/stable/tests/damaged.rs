//! Files that are cut, foreign or nonsense.
