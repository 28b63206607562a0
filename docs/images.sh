#!/bin/sh
# Draws the pictures of how_it_works.md (synthetic people that the default model has not seen, and
# one frame at each stage of a small model; stages.json has the numbers that its text names), of
# time.md (a joint of a video), of the card of the models (people in front of each sensor), and of
# README.md (estimates of the live node in the demonstration).
# This takes a few minutes and needs lsc_pose on the PATH or in LSC_POSE, and a Python with the
# package and ROS 2: python3, or the value of PYTHON.
set -eu

pictures=$(cd "$(dirname "$0")" && pwd)/images
lsc_pose=${LSC_POSE:-lsc_pose}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir -p "$pictures"
# A model with the paper's feature, for the pictures of the stages.
$lsc_pose synth "$work/train.mcap" --frames 1500 --clip-length 3 --seed 1
$lsc_pose synth "$work/front.mcap" --frames 60 --clip-length 2 --seed 2001
$lsc_pose train "$work/train.mcap" -o "$work/model.npz"
$lsc_pose view "$work/front.mcap" -o "$work/stages" --stages 29 --model "$work/model.npz"
rm "$work/stages/stages.png"
cp "$work/stages/"*.png "$work/stages/stages.json" "$pictures"

$lsc_pose synth "$work/people.mcap" --frames 60 --clip-length 2 --seed 2002 --yaw 180
$lsc_pose view "$work/people.mcap" -o "$pictures/sheet.png" --model default \
    --at 4 14 24 34 44 54

for sensor in kinect_v1 kinect_v2 azure realsense zed tof; do
    $lsc_pose synth "$work/$sensor.mcap" --frames 6 --clip-length 1 --seed 2003 --yaw 180 \
        --sensor $sensor
    $lsc_pose view "$work/$sensor.mcap" -o "$pictures/sensor_$sensor.png" --frames 6 --model default
done

$lsc_pose synth "$work/video.mcap" --frames 180 --fps 30 --clip-length 60 --yaw 180 --sensor zed --seed 2005
${PYTHON:-python3} "$pictures/../draw_time.py" "$work/video.mcap" r_wrist "$pictures/time.png"

$lsc_pose synth "$work/rooms.mcap" --frames 12 --clip-length 1 --seed 2004 --yaw 180 --people 2 \
    --furniture
$lsc_pose view "$work/rooms.mcap" -o "$pictures/rooms.png" --frames 12 --model default

${PYTHON:-python3} -m lsc_pose_ros.demo --directory "$work/demo"
$lsc_pose view "$work/demo/live.mcap" -o "$pictures/live.png" --at 10 50 90 120 150 190
