#!/usr/bin/env bash
# Every comparison, one after another: builds our side, then each script. PYTHON=... takes another interpreter than the venv's.
set -euo pipefail
cd "$(dirname "$0")"
python=${PYTHON:-.venv/bin/python}
[ -x "$(command -v "$python")" ] || { echo "no $python: run benches/peers/setup.sh first, or set PYTHON" >&2; exit 2; }
if [ -z "${SCENELOOM_PEERS:-}" ]; then
  (cd ../.. && cargo bench --bench peers --no-run)
fi
for script in raycast networks sampling splats npz; do
  "$python" "$script.py" "$@" || true
done
