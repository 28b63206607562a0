#!/bin/sh
# Draws the pictures of how_it_works.md anew: synthetic people, a small model, one frame. And that
# of README.md: what the live node answers in the demonstration.
# Takes a few minutes; needs lsc_pose on the PATH, or its name in LSC_POSE, and a Python that has
# the package and ROS 2, python3 or its name in PYTHON.
set -eu

pictures=$(cd "$(dirname "$0")" && pwd)/images
lsc_pose=${LSC_POSE:-lsc_pose}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

$lsc_pose synth "$work/train.mcap" --frames 2400 --clip-length 3 --seed 1
$lsc_pose synth "$work/people.mcap" --frames 300 --clip-length 6 --seed 2
$lsc_pose train "$work/train.mcap" -o "$work/model.npz"

$lsc_pose view "$work/people.mcap" -o "$work/stages" --stages 167 --model "$work/model.npz"
rm "$work/stages/stages.png"
mkdir -p "$pictures"
cp "$work/stages/"*.png "$pictures"
$lsc_pose view "$work/people.mcap" -o "$pictures/sheet.png" --model "$work/model.npz" \
    --at 16 64 118 167 224 272

${PYTHON:-python3} -m lsc_pose_ros.demo --directory "$work/demo"
$lsc_pose view "$work/demo/live.mcap" -o "$pictures/live.png" --at 10 50 90 120 150 190
