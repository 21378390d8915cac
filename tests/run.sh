#!/usr/bin/env bash
# Installs the few system packages the tests need where it may, then runs fmt, clippy, docs and all tests.
set -euo pipefail
cd "$(dirname "$0")/.."

# A software Vulkan driver, a virtual display and what a window needs. Without them the tests that
# draw fail, they do not pass silently.
need=()
have() { dpkg -s "$1" >/dev/null 2>&1; }
if command -v dpkg >/dev/null; then
  for package in mesa-vulkan-drivers xvfb xauth libxkbcommon-x11-0 libx11-xcb1 libxcursor1 libxi6 libxrandr2; do
    have "$package" || need+=("$package")
  done
  # The MP4 encoder is C++.
  command -v c++ >/dev/null || need+=(g++)
fi
if [ "${#need[@]}" -gt 0 ]; then
  echo "system packages missing: ${need[*]}"
  if [ "$(id -u)" = 0 ]; then as_root=(); else as_root=(sudo -n); fi
  if "${as_root[@]}" apt-get update -qq && "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
      apt-get install -y -qq --no-install-recommends "${need[@]}" >/dev/null; then
    echo "installed"
  else
    echo "could not install them; tests that draw may fail" >&2
  fi
fi

# One profile throughout, so that libraries build once: optimised as a release, with the overflow and debug assertions of the rooms.
cargo fmt --all --check
cargo clippy --profile checked --workspace --all-targets --quiet -- -D warnings
# The plain program, without the parts that are features, compiles too.
cargo check --profile checked --quiet
RUSTDOCFLAGS="-D warnings" cargo doc --profile checked --workspace --no-deps --document-private-items --quiet
# No comment holds an example to run, so doc tests, which would read every room again, are left out.
cargo test --profile checked --workspace --tests
# The room of public weights as the plain program has it, without its networks.
cargo test --profile checked -p sceneloom-stable --no-default-features --lib

# The Python package, with the program that was just built.
if python3 -c 'import sys; sys.exit(sys.version_info < (3, 10))' 2>/dev/null; then
  SCENELOOM="$(realpath "${CARGO_TARGET_DIR:-target}")/checked/sceneloom" python3 -m unittest discover -s python/tests
else
  echo "tests of the Python package: not run, no Python 3.10 here"
fi

# The PyTorch twins of the networks, where PyTorch is there (pip install -r training/requirements.txt).
if python3 -c 'import torch, numpy, safetensors' 2>/dev/null; then
  (cd training && python3 test_training.py ../tests/reference && python3 test_lidar.py ../tests/reference && python3 test_perception.py && python3 test_sensors.py && python3 test_pictures.py)
else
  echo "training tests: not run, no PyTorch here"
fi
