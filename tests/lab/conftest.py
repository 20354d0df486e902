"""Shared parts of the tests of the laboratory."""
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "lab"), str(ROOT / "tests/accuracy")]


@pytest.fixture
def result():
    """result(sequence, ...) makes a result of a replay, as `lab --json` prints it."""
    def make(sequence="campus 1", kind="rendered", translation=0.1, **changed):
        segments = {"count": 10, "translation_percent": translation, "rotation_deg_per_m": 0.01}
        nees = {"mean": 1.0, "samples": 100, "band_95_percent": [0.9, 1.1], "unusable": 0}
        return {"sequence": sequence, "kind": kind, "set": "tuning" if kind == "rendered" else None, "bitrate_mbps": None,
                "estimator": "reprojection", "features": 1000, "pairs": 101, "invalid": 0, "lost": 0, "resets": 0, "standing_end_m": None,
                "standing_end_deg": None, "standing_highest_speed_m_s": None, "nees_motion": nees, "nees_pose": nees, "nees_velocity": nees,
                "evaluation": {"poses": 101, "path_length_m": 50.0, "rpe_rmse_m": 0.001, "rpe_rmse_deg": 0.01, "final_drift_m": 0.2,
                               "final_drift_percent": 0.4, "final_rotation_deg": 0.1, "segments_5_to_40_m": segments,
                               "segments_100_to_800_m": {"count": 0, "translation_percent": None, "rotation_deg_per_m": None}},
                "messages": 101, "valid_messages": 100, "judged_messages": 100, "above_limit": 0, "above_bound": 0, "available_percent": 99.0,
                "longest_gap_s": 0.1, "largest_velocity_error_m_s": 0.1, "largest_rate_error_deg_s": 1.0, "alert_limits": [0.7, 12, 0.2, 1.5],
                "time_ms": {"median": 3.0, "p99": 5.0, "max": 6.0}, "stages_ms": {"detect": 1.0}, **changed}
    return make
