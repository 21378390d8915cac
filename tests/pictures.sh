#!/bin/bash
# Pictures of every workspace, dark and light, at two sizes, into a folder: tests/pictures.sh FOLDER [SCENE].
# Needs Xvfb, xdotool and ImageMagick, and `cargo build --release`.
set -euo pipefail
folder=$(realpath -m "${1:?a folder for the pictures}")
scene=$(realpath "${2:-assets/scenes/first_light.loom}")
binary=${SCENELOOM:-$(realpath target/release/sceneloom)}
mkdir -p "$folder"
work=$(mktemp -d)
export XDG_RUNTIME_DIR=$work SCENELOOM_CONFIG_DIR=$work/config SCENELOOM_STATE_DIR=$work/state DISPLAY=${PICTURES_DISPLAY:-:97}
chmod 700 "$work"
trap 'kill $app $server 2>/dev/null; rm -rf "$work"' EXIT
app= server=
if ! xdotool getmouselocation >/dev/null 2>&1; then
    Xvfb "$DISPLAY" -screen 0 2560x1440x24 >/dev/null 2>&1 &
    server=$!
    sleep 2
fi
for look in dark light; do
    mkdir -p "$SCENELOOM_CONFIG_DIR"
    printf '{"look": "%s", "start_screen": false}' "$look" >"$SCENELOOM_CONFIG_DIR/settings.json"
    "$binary" "$scene" &
    app=$!
    window=
    for _ in $(seq 120); do
        window=$(xdotool search --onlyvisible --name Sceneloom 2>/dev/null | tail -1 || true)
        [ -n "$window" ] && break
        sleep 0.5
    done
    sleep 2
    for size in 1280x800 2560x1440; do
        xdotool windowmove "$window" 0 0 windowsize "$window" ${size/x/ }
        sleep 1
        number=0
        for workspace in edit paint voxels sensors label; do
            number=$((number + 1))
            xdotool windowfocus "$window" mousemove $((${size%x*} * 6 / 10)) 22 key "alt+$number"
            # The box of which the label workspace shows three sides.
            [ $workspace$size = edit1280x800 ] && xdotool key j
            sleep "${PICTURES_WAIT_S:-8}" # pictures of the sensors
            import -window root -crop "$size+0+0" "$folder/${workspace}_${look}_$size.png"
        done
    done
    kill "$app"
    wait "$app" 2>/dev/null || true
    app=
    rm -rf "$SCENELOOM_STATE_DIR" "$SCENELOOM_CONFIG_DIR"
done
