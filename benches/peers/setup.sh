#!/usr/bin/env bash
# The Python environment of the peers: a venv beside this script (needs the network once). PYTHON names another interpreter.
set -euo pipefail
cd "$(dirname "$0")"
"${PYTHON:-python3}" -m venv .venv
.venv/bin/pip install --quiet --upgrade pip
while read -r package; do
  .venv/bin/pip install --quiet "$package" || echo "could not install $package: its comparisons will say that they lack it" >&2
done < requirements.txt
# Open3D loads libusb and libGL.
if [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then apt-get install -y -qq libusb-1.0-0 libgl1 libgomp1 > /dev/null || true; fi
.venv/bin/python - <<'PY'
import importlib.util
for name in ("numpy", "torch", "safetensors", "diffusers", "open3d"):
    print(name, "found" if importlib.util.find_spec(name) else "MISSING")
PY
