#!/usr/bin/env bash
# The Python environment of the peers: a venv beside this script (needs the network once). PYTHON names another interpreter.
set -euo pipefail
cd "$(dirname "$0")"
"${PYTHON:-python3}" -m venv .venv
.venv/bin/pip install --quiet --upgrade pip
while read -r package; do
  .venv/bin/pip install --quiet "$package" || echo "could not install $package: its comparisons will say that they lack it" >&2
done < requirements.txt
.venv/bin/python - <<'PY'
import importlib.util
for name in ("numpy", "torch", "safetensors", "diffusers", "open3d"):
    print(name, "found" if importlib.util.find_spec(name) else "MISSING")
PY
