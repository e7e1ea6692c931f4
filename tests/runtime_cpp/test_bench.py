# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The bench measures what it says; its numbers are recorded, not asserted (a second's bound apart)."""

import pytest

from palpate.runtime import RuntimeFailure, bench


def test_bench_reports_every_kind_of_tick(tmp_path, plane):
    path = tmp_path / "plane.rfield"
    path.write_bytes(plane.data)
    found = bench(path)
    kinds = {"stick_ns", "slide_ns", "free_ns", "first_contact_ns", "cold_ns", "adversarial_ns"}
    assert set(found) == kinds | {"load_ms", "bytes", "machine"}
    for name in kinds:
        t = found[name]
        assert 0 <= t["p50"] <= t["p99"] <= t["p999"] <= t["max"] < 1e9 and t["count"] > 100
    assert found["bytes"] == len(plane.data) and found["load_ms"] > 0 and found["machine"]


def test_bench_refuses_what_open_refuses(tmp_path):
    path = tmp_path / "not.rfield"
    path.write_bytes(b"nothing")
    with pytest.raises(RuntimeFailure, match=r"not\.rfield"):
        bench(path)
