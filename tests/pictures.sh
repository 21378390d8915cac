#!/bin/bash
# Pictures of every workspace, dark and light, at two sizes, into a folder: tests/pictures.sh FOLDER [SCENE].
folder=$(realpath -m "${1:?a folder for the pictures}")
scene=$(realpath "${2:-assets/scenes/first_light.loom}")
mkdir -p "$folder"
source "$(dirname "$0")/window.sh"
for look in dark light; do
    open_window $look 1280x800 "$scene"
    for size in 1280x800 2560x1440; do
        size_window $size
        number=0
        for workspace in edit paint voxels sensors label trade; do
            number=$((number + 1))
            xdotool windowfocus "$window" mousemove $((${size%x*} * 77 / 100)) 22 key "alt+$number"
            # The box of which the label workspace shows three sides.
            [ $workspace$size = edit1280x800 ] && xdotool key j
            sleep "${PICTURES_WAIT_S:-8}" # pictures of the sensors
            import -window root -crop "$size+0+0" "$folder/${workspace}_${look}_$size.png"
        done
    done
    close_window
done
