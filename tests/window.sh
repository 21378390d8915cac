# Sourced by scripts that drive the real window: an X server of its own (Xvfb unless one answers on $DISPLAY), settings and
# state in a folder that goes away, and `open_window`. Needs Xvfb, xdotool and ImageMagick, and `cargo build --release`.
set -euo pipefail
binary=${SCENELOOM:-$(realpath target/release/sceneloom)}
work=$(mktemp -d)
export XDG_RUNTIME_DIR=$work SCENELOOM_CONFIG_DIR=$work/config SCENELOOM_STATE_DIR=$work/state DISPLAY=${PICTURES_DISPLAY:-:97}
chmod 700 "$work"
app= server= window=
trap 'kill $app $server 2>/dev/null; rm -rf "$work"' EXIT
if ! xdotool getmouselocation >/dev/null 2>&1; then
    Xvfb "$DISPLAY" -screen 0 2560x1440x24 -noreset >/dev/null 2>&1 &
    server=$!
    # A busy machine takes its time.
    for _ in $(seq 100); do
        xdotool getmouselocation >/dev/null 2>&1 && break
        sleep 0.2
    done
fi

# open_window LOOK WxH ARGUMENTS...: starts the editor, waits for its window, sets `app` and `window`.
open_window() {
    local look=$1 size=$2
    shift 2
    mkdir -p "$SCENELOOM_CONFIG_DIR"
    printf '{"look": "%s", "start_screen": false}' "$look" >"$SCENELOOM_CONFIG_DIR/settings.json"
    "$binary" "$@" &
    app=$!
    window=
    for _ in $(seq 120); do
        window=$(xdotool search --onlyvisible --name Sceneloom 2>/dev/null | tail -1 || true)
        [ -n "$window" ] && break
        sleep 0.5
    done
    sleep 2
    size_window "$size"
    xdotool windowfocus "$window"
}

size_window() {
    xdotool windowmove "$window" 0 0 windowsize "$window" ${1/x/ }
    sleep 1
}

close_window() {
    kill "$app"
    wait "$app" 2>/dev/null || true
    app=
    rm -rf "$SCENELOOM_STATE_DIR" "$SCENELOOM_CONFIG_DIR"
}
