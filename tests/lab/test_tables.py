"""Tables, results of several drives together, and the limits of CI."""
import math

import check_accuracy
import pytest

from laboratory import accuracy, measure, offset, robustness, sensitivity, shutter
from laboratory.table import NONE, Table, fixed, significant


def test_a_table_has_aligned_columns_and_a_markdown_form():
    table = Table(["name", "±"])
    table.add("a", 10)
    table.add("longer", 2)
    assert table.text().splitlines() == ["name     ±", "a       10", "longer   2"]
    assert table.markdown().splitlines()[1:3] == ["|---|---:|", "| a | 10 |"]
    with pytest.raises(ValueError, match="3 cells"):
        table.add(1, 2, 3)


def test_numbers_have_three_significant_digits():
    assert [significant(value) for value in (1167.2, 12.34, 0.01234, 0, None, math.nan)] == ["1167", "12.3", "0.0123", "0.00", NONE, NONE]
    assert fixed(0.0123, 2, 100.0) == "1.23"


def test_accuracy_has_a_row_for_each_result_and_one_for_each_set(result):
    results = [result("kitti_06", "real"), result("campus 1", translation=0.1), result("turns 1", translation=0.4),
               result("garage 11", set="reporting")]
    tables, notes = accuracy.report(results)
    assert [row[0] for row in tables[0].rows] == ["kitti_06", "campus 1", "turns 1", "garage 11", "all 2 drives", "all 1 drives"]
    assert "tuning set, reprojection, 2 drives: 5–40 m: geometric mean 0.200 %, worst 0.400 % (turns 1)" in notes
    assert "0 of 200 VALID messages above their alert limit" in notes


def test_a_result_without_pairs_is_a_row(result):
    empty = {key: value for key, value in result("kitti_06", "real").items() if key in ("sequence", "kind", "set", "bitrate_mbps",
                                                                                        "estimator", "features")}
    rows = accuracy.report([{**empty, "pairs": 0, "lost": 51}])[0][0].rows
    assert rows[0][3] == "0" and rows[0][12] == "51"


def test_h264_is_compared_with_lossless_pictures(result):
    tables, _ = accuracy.report([result(), result(translation=0.15, bitrate_mbps=2.0)])
    assert tables[0].rows[1][0] == "campus 1, 2 Mbit/s"
    assert tables[1].rows[0][3] == "0.15 / 0.0100 (+50 %)"


def test_results_are_pooled(result):
    one = result(standing_end_m=0.01)
    other = result(standing_end_m=0.004, invalid=2, nees_motion={"mean": 2.0, "samples": 300, "band_95_percent": [0, 0]})
    other["evaluation"] = {**other["evaluation"], "rpe_rmse_m": 0.003, "poses": 301}
    both = measure.pooled("both", [one, other])
    assert both["pairs"] == 202 and both["invalid"] == 2 and both["standing_end_m"] == 0.01
    assert both["nees_motion"]["mean"] == pytest.approx(1.75)
    assert both["evaluation"]["rpe_rmse_m"] == pytest.approx(math.sqrt((100 * 1e-6 + 300 * 9e-6) / 400))


def test_the_band_is_that_of_chi_square():
    low, high = measure.band(100)  # chi-square with 600 degrees of freedom: 534.0 and 669.8
    assert (low, high) == (pytest.approx(534.0 / 600, abs=1e-3), pytest.approx(669.8 / 600, abs=1e-3))


def labelled(result, **labels):
    return {**result, "scenario": "turns", "features": 1000, **labels}


def test_offsets_are_multiples_of_synchronised_cameras(result):
    results = [labelled(result(translation=0.1), offset_ms=0.0, drift_ppm=0.0, model="two-instants"),
               labelled(result(translation=0.3), offset_ms=25.0, drift_ppm=0.0, model="simultaneous")]
    rows = offset.report(results)[0][0].rows
    assert rows[0][5] == "1.00 / 1.00" and rows[1][5] == "3.00 / 1.00" and rows[1][1] == "25 ms"
    assert offset.report(results[1:])[0][0].rows[0][5] == NONE


def test_shutters_are_multiples_of_a_global_one(result):
    common = {"offset_ms": 0.0, "drift_ppm": 0.0, "shake_hz": 0.0, "rate_error_deg_s": 0.5, "true_rate_deg_s": 10.0}
    results = [labelled(result(), readout_ms="0", model="known", **common),
               labelled(result(translation=0.2), readout_ms="32,38", model="ignored", **common)]
    rows = shutter.report(results)[0][0].rows
    assert rows[1][1] == "32 / 38" and rows[1][6] == "2.00 / 1.00" and rows[1][11] == "5.0"
    assert not shutter.is_measured("0", "ignored") and not shutter.is_measured("-32", "estimated") and shutter.is_measured("-32", "known")


def test_the_default_is_worse_than_the_thesis_by_more_than_chance(result):
    def errors(*values, **changed):
        return result(errors_per_second_m=list(values), **changed)

    good = errors(*[0.01] * 9, 0.011)
    assert robustness.is_worse(errors(*[0.02] * 9, 0.021), good, "picture")
    assert not robustness.is_worse(errors(*[0.02] * 9, 0.021), good, "rig")
    assert not robustness.is_worse(good, good, "picture")
    assert robustness.is_worse(errors(0.01, above_limit=1), good, "rig")
    assert robustness.is_worse(errors(0.01, invalid=30), good, "pairs")
    labels = [{"disturbance": "none"}, {"disturbance": "text"}]
    rows = robustness.report([errors(0.01, 0.02, estimator=estimator, **label) for label in labels
                              for estimator in ("reprojection", "thesis")])[0][0].rows
    assert rows[1][1] == "text" and rows[1][8] == "1.00"


def test_sensitivity_is_in_multiples_of_chance(result):
    def run(constant, side, translation, change=None):
        return {**result(translation=translation), "constant": constant, "side": side, "change": change}

    results = [run("default", 0, 0.1), run("chance", 0, 0.101, ("seed", 2)), run("stereo.rows", -1, 0.11, ("stereo.rows", 0)),
               run("stereo.rows", 1, 0.1, ("stereo.rows", 2)), {"sequence": "campus 1", "constant": "window.pairs", "side": 1,
                                                               "change": ("window.pairs", 8)}]
    rows = sensitivity.report(results)[0][0].rows
    assert rows[0][0] == "stereo.rows" and rows[0][1] == "0 / 2" and float(rows[0][-1]) > 5
    assert rows[1] == ["window.pairs", f"{NONE} / {NONE}", *[f"{NONE} / {NONE}"] * 4, "0.0"]


def test_limits_hold_medians_of_errors_and_largest_counts(result, capsys):
    runs = [result(translation=value, invalid=count) for value, count in ((0.1, 0), (0.2, 3), (0.9, 0))]
    path = "evaluation/segments_5_to_40_m/translation_percent"
    assert check_accuracy.exceeded({"campus 1": {path: 0.2}}, {"campus 1": runs}) == []
    assert check_accuracy.exceeded({"campus 1": {path: 0.19, "invalid": 2}}, {"campus 1": runs}) == [
        f"campus 1: {path} is 0.2: at most 0.19 is expected", "campus 1: invalid is 3: at most 2 is expected"]
    assert check_accuracy.exceeded({"turns 1": {}}, {"campus 1": runs}) == ["turns 1: not in the report, which has campus 1"]
    assert check_accuracy.exceeded({"campus 1": {"evaluation/none": 1}}, {"campus 1": runs})
    assert "EXCEEDED" in capsys.readouterr().out
