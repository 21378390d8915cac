#!/bin/sh
# From nothing to the weights of occupancy and scenery: training/recipe.sh FOLDER [HOURS [WEIGHTS]] (of training; 12 if not given).
# What is done is not done again, and what was stopped goes on. With WEIGHTS, a folder such as assets/weights, the networks begin
# with those there. On a graphics card the same command uses it.
set -eu
folder=$1 hours=${2:-12} weights=${3:-}
here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-python3}
worlds="sceneloom-worlds --frames 5120 --seed 1 -o DIR/train; sceneloom-worlds --frames 96 --seed 2 -o DIR/val"
of() { awk "BEGIN { m = int(60 * $hours * $1); print m < 1 ? 1 : m }"; } # minutes of a share of the hours
train() { # SCRIPT WEIGHTS SHARE ARGUMENTS...
    script=$1 out=$2 minutes=$(of "$3")
    shift 3
    echo "== $out: $minutes minutes"
    "$python" "$here/$script" --data "$folder" --minutes "$minutes" -o "$folder/$out.safetensors" --resume "$@"
}
begin_with() { # FILE: the argument that begins with it
    if [ -n "$weights" ]; then echo "--init $weights/$1.safetensors"; fi
}

cargo build --release -p sceneloom-worlds --manifest-path "$here/../Cargo.toml"
"$here/../target/release/sceneloom-worlds" --frames 5120 --seed 1 -o "$folder/train"
"$here/../target/release/sceneloom-worlds" --frames 96 --seed 2 -o "$folder/val"

kernels='[[[1],[3,1,1,1],[3,1,1,1,1,1,1]],[[3,3,1,1,1,1,1,1],[3,1,1,1],[1,1,1]]]'
mix='.30 .58 .12' # complete worlds, labels, drafts
train train_vae.py vae .3 $(begin_with occ_vae) --kernels "$kernels" --mix $mix --anywhere .45 --leaned .35
train train_dit.py occ_dit .41 $(begin_with occ_dit) --vae "$folder/vae.safetensors"
train train_vae.py occ_vae .1 --decoder-of "$folder/vae.safetensors" --hears --latent-noise .1 --kernels "$kernels" --mix .40 .55 .05 --anywhere .45 --leaned .2
train train_vae.py occ_vae_fine .11 $(begin_with occ_vae_fine) --fine --mix .42 .48 .1 --anywhere .45

train train_scenery.py scenery .04 --vae "$folder/vae.safetensors"

"$python" "$here/calibrate.py" --vae "$folder/occ_vae.safetensors" --data "$folder" -o "$folder/calibrated.safetensors"
train train_refiner.py refiner .04 --vae "$folder/calibrated.safetensors" --fine "$folder/occ_vae_fine.safetensors"

"$python" "$here/export.py" --vae "$folder/calibrated.safetensors" --fine "$folder/occ_vae_fine.safetensors" \
    --dit "$folder/occ_dit.safetensors" --data "$folder" --data-command "$worlds"
"$python" "$here/export_scenery.py" --weights "$folder/scenery.safetensors" --data-command "$worlds"
"$python" "$here/export_refiner.py" --weights "$folder/refiner.safetensors" --data-command "$worlds"
