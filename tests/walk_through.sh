#!/bin/bash
# The animated walk-through of README: open, paint, generate, compare. tests/walk_through.sh OUT.gif
out=$(realpath -m "${1:?the file to write}")
scene=$(realpath assets/scenes/first_light.loom)
source "$(dirname "$0")/window.sh"
number=0 x=0 y=0 frames=()
at() { x=$1 y=$2; xdotool mousemove "$x" "$y"; sleep 0.3; }
# shot CENTISECONDS: a frame with a pointer drawn where it is.
shot() {
    number=$((number + 1))
    local file=$work/$(printf %03d $number).png
    import -window root -crop 1600x950+0+0 +repage "$file"
    convert "$file" -fill white -stroke black -strokewidth 1.5 \
        -draw "path 'M $x,$y l 0,24 l 6,-5 l 4,9 l 5,-2 l -4,-9 l 8,0 z'" -resize 960x570 "$file"
    frames+=(-delay "$1" "$file")
}
open_window dark 1600x950 "$scene"
at 700 800
sleep "${READY_S:-30}" # the networks get ready
shot 120
# A crossing in front of the ego vehicle.
at 600 500
xdotool key u
sleep 1
at 119 301
shot 40
xdotool click 1
sleep 1
shot 50
at 452 372
shot 30
xdotool mousedown 1
for i in 1 2 3 4 5; do
    at $((452 + i * 22)) $((372 + i * 4))
    shot 14
done
xdotool mouseup 1
sleep 0.5
shot 60
# Two cars go.
xdotool key v
for car in "505 329" "528 348"; do
    # shellcheck disable=SC2086
    at $car
    shot 25
    xdotool click 1
    sleep 1
    shot 40
    xdotool key Delete
    sleep 1
    shot 40
done
at 640 620
for _ in 1 2 3; do
    sleep "${STEP_S:-6}"
    shot 35
done
sleep "${SETTLED_S:-60}"
shot 130
# Before and after, in every view at once.
at 1429 793
xdotool click 1 # versions lie behind history
sleep 1
at 1440 870
xdotool click --repeat 12 --delay 60 5 # to the first version: as opened
sleep 1
at 1440 882
shot 30
xdotool click 1
sleep 6
shot 60
at 509 560
xdotool mousedown 1
for to in 450 390 330 400 470 540 610 680; do
    at $to 560
    sleep 0.4
    shot 22
done
xdotool mouseup 1
sleep 1
shot 150
convert -loop 0 "${frames[@]}" +dither -colors "${COLORS:-96}" -layers optimize "$out"
if command -v gifsicle >/dev/null; then
    gifsicle --batch -O3 --lossy=80 --colors 64 "$out" # an eighth of the bytes
fi
ls -l "$out"
