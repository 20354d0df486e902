"""Stereo visual odometry from two free-running cameras.

Images are numpy arrays of dtype uint8 and shape (height, width), which are not copied. Units are SI, instants are ns.
docs/library.md shows the use; the stubs beside this file list each class.
"""
from ._cartvo import (
    BodyEstimate,
    CameraModel,
    Estimate,
    EstimateWithStddev,
    Estimator,
    Odometry,
    Pair,
    PairProcessor,
    Recording,
    Rectifier,
    Rig,
    RigCalibrationError,
    RigObservability,
    RigRefinement,
    Settings,
    StandstillSettings,
    Status,
    StereoCamera,
    StereoSettings,
    TrackingSettings,
    ValiditySettings,
    __version__,
)

__all__ = [
    "BodyEstimate",
    "CameraModel",
    "Estimate",
    "EstimateWithStddev",
    "Estimator",
    "Odometry",
    "Pair",
    "PairProcessor",
    "Recording",
    "Rectifier",
    "Rig",
    "RigCalibrationError",
    "RigObservability",
    "RigRefinement",
    "Settings",
    "StandstillSettings",
    "Status",
    "StereoCamera",
    "StereoSettings",
    "TrackingSettings",
    "ValiditySettings",
    "__version__",
]
