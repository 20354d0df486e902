#!/usr/bin/env bash
# make_still_sequence.sh FOLDER [SHIFT]: eight pairs of pictures at 18 Hz of a plane with texture, in KITTI's layout, in which
# nothing moves. SHIFT: disparity in px (default: 16).
set -euo pipefail
folder=$1 shift_px=${2-16}
mkdir -p "$folder/image_0" "$folder/image_1"
ffmpeg -v error -y -f lavfi -i "nullsrc=size=320x208,geq=lum='random(1)*255':cb=128:cr=128,gblur=2" -frames:v 1 "$folder/view.png"
ffmpeg -v error -y -i "$folder/view.png" -vf crop=288:208:0:0 "$folder/image_0/000000.png"
ffmpeg -v error -y -i "$folder/view.png" -vf "crop=288:208:$shift_px:0" "$folder/image_1/000000.png"
rm "$folder/view.png"
for pair in 1 2 3 4 5 6 7; do
  cp "$folder/image_0/000000.png" "$folder/image_0/00000$pair.png"
  cp "$folder/image_1/000000.png" "$folder/image_1/00000$pair.png"
done
printf '%s\n' 0 0.0556 0.1111 0.1667 0.2222 0.2778 0.3333 0.3889 >"$folder/times.txt"
printf 'P0: 240 0 144 0 0 240 104 0 0 0 1 0\nP1: 240 0 144 -48 0 240 104 0 0 0 1 0\n' >"$folder/calib.txt"
