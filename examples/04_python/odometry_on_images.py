#!/usr/bin/env python3
"""odometry_on_images.py FOLDER: prints the path of the left camera from a recording or a folder of images."""
import sys

import cartvo


def main() -> None:
    if len(sys.argv) != 2:
        sys.exit("usage: odometry_on_images.py FOLDER")
    recording = cartvo.Recording(sys.argv[1])
    rectifier = cartvo.Rectifier(recording.rig)
    odometry = cartvo.Odometry(rectifier, cartvo.Settings(features=1000), unknown_readout=recording.is_recording)
    for pair in recording:
        left, right = rectifier.rectify(pair.left, pair.right)
        estimate = odometry.process(left, right, pair.t_left, pair.t_right, pair.offset_stddev, pair.key_frames)
        print(f"{1e-9 * pair.left_exposure_ns:.3f} s", estimate.status.name, estimate.pose[:3, 3], "m",
              ", ".join(estimate.reasons))


if __name__ == "__main__":
    main()
