#!/usr/bin/env python3
"""Computes the fixed numbers of reference_errors_test.cpp, by the published definitions alone.

KITTI: devkit/cpp/evaluate_odometry.cpp (calcSequenceErrors): segments of 100 to 800 m that start at each tenth pose and
end at the first pose farther than the length along the true path; error = inverse(estimated motion) * true motion;
translation: norm over the length, rotation: acos of the trace over the length; mean over all segments.
evo (M. Grupp): APE, translation part, after Umeyama's alignment without scale (evo_ape --align), RMSE;
RPE, delta of one frame, translation part and rotation angle (evo_rpe -r trans_part, -r angle_deg), RMSE.

Needs numpy. Run it to see that the numbers in the test are its output.
"""
import math

import numpy as np

POSES = 1500


def motion(forward, yaw, pitch):
    """Pose of the left camera (x right, y down, z forward) after `forward` metres, turned about y, then x."""
    cy, sy, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    pose = np.eye(4)
    pose[:3, :3] = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]) @ np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    pose[:3, 3] = [0, 0, forward]
    return pose


def trajectories():
    truth, estimate = [np.eye(4)], [np.eye(4)]
    for i in range(1, POSES):
        forward, yaw, pitch = 0.7 + 0.2 * math.sin(0.05 * i), 0.02 * math.sin(0.011 * i), 0.003 * math.cos(0.07 * i)
        truth.append(truth[-1] @ motion(forward, yaw, pitch))
        estimate.append(estimate[-1] @ motion(1.01 * forward + 0.004 * math.cos(0.3 * i),
                                              yaw + 0.0004 * math.sin(0.9 * i) + 0.0001, pitch + 0.0001 * math.cos(i)))
    return truth, estimate


def angle(rotation):
    return math.acos(max(-1.0, min(1.0, 0.5 * (np.trace(rotation) - 1.0))))


def kitti(truth, estimate):
    distances = [0.0]
    for before, after in zip(truth, truth[1:]):
        distances.append(distances[-1] + np.linalg.norm(after[:3, 3] - before[:3, 3]))
    errors = []
    for first in range(0, len(truth), 10):
        for length in range(100, 900, 100):
            last = next((i for i in range(first, len(truth)) if distances[i] > distances[first] + length), None)
            if last is None:
                continue
            error = np.linalg.inv(np.linalg.inv(estimate[first]) @ estimate[last]) @ \
                (np.linalg.inv(truth[first]) @ truth[last])
            errors.append((length, np.linalg.norm(error[:3, 3]) / length, angle(error[:3, :3]) / length))
    return errors


def ape(truth, estimate):
    x, y = (np.array([pose[:3, 3] for pose in poses]).T for poses in (estimate, truth))
    mean_x, mean_y = x.mean(1, keepdims=True), y.mean(1, keepdims=True)
    u, _, vt = np.linalg.svd((y - mean_y) @ (x - mean_x).T)
    rotation = u @ np.diag([1, 1, np.linalg.det(u) * np.linalg.det(vt)]) @ vt
    return math.sqrt(((rotation @ (x - mean_x) + mean_y - y) ** 2).sum(0).mean())


def rpe(truth, estimate):
    translation, rotation = [], []
    for i in range(len(truth) - 1):
        error = np.linalg.inv(np.linalg.inv(truth[i]) @ truth[i + 1]) @ (np.linalg.inv(estimate[i]) @ estimate[i + 1])
        translation.append(np.linalg.norm(error[:3, 3]))
        # atan2: acos of the trace has no digits left at these angles
        skew = error[:3, :3] - error[:3, :3].T
        rotation.append(math.degrees(math.atan2(0.5 * math.hypot(skew[2, 1], skew[0, 2], skew[1, 0]),
                                                0.5 * (np.trace(error[:3, :3]) - 1))))
    return [math.sqrt(np.mean(np.square(values))) for values in (translation, rotation)]


def main():
    truth, estimate = trajectories()
    errors = kitti(truth, estimate)
    for length in [*range(100, 900, 100), None]:
        chosen = [error for error in errors if length in (None, error[0])]
        print(f"{{{length or 0}, {len(chosen)}, {np.mean([e[1] for e in chosen]):.12g}, "
              f"{np.mean([e[2] for e in chosen]):.12g}}},")
    print(f"APE {ape(truth, estimate):.12g} m, RPE {rpe(truth, estimate)[0]:.12g} m, {rpe(truth, estimate)[1]:.12g} deg")


if __name__ == "__main__":
    main()
