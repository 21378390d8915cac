#!/usr/bin/env bash
# Times a cold release build, then a rebuild after one changed line in each file named.
# Usage: benches/build_times.sh FILE...   (CARGO_TARGET_DIR must name an empty or new folder)
set -euo pipefail
cd "$(dirname "$0")/.."
: "${CARGO_TARGET_DIR:?name an empty folder: the first build is timed cold}"

seconds() {
  local start end
  start=$(date +%s.%N)
  cargo build --release --quiet
  end=$(date +%s.%N)
  awk "BEGIN { printf \"%6.1f s\", $end - $start }"
}

echo "$(seconds)  cold build"
for file in "$@"; do
  original=$(mktemp)
  cp -p "$file" "$original"
  times=()
  for turn in 1 2 3; do
    printf '\n#[doc(hidden)]\npub fn build_times_line() -> u32 {\n    %d\n}\n' "$turn" >> "$file"
    times+=("$(seconds)")
    cp "$original" "$file"
  done
  rm "$original"
  echo "$(printf '%s\n' "${times[@]}" | sort | sed -n 2p)  after one line in $file (median of 3)"
done
