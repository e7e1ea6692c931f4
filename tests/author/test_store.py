# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.author.errors import PalpateError
from palpate.author.store import Store

KEY = "a" * 64


def test_what_is_kept_comes_back_bit_for_bit(tmp_path):
    store = Store(tmp_path)
    x = np.random.default_rng(0).normal(size=(7, 3))
    store.write("press", KEY, {"x": x}, {"reason": "", "n": 3})
    arrays, values = store.read("press", KEY)
    assert np.array_equal(arrays["x"], x)
    assert values == {"reason": "", "n": 3}


def test_nothing_is_made_twice(tmp_path):
    store, made = Store(tmp_path), []

    def make():
        made.append(1)
        return {"x": np.arange(3)}, {}

    store.kept("mesh", KEY, make)
    store.kept("mesh", KEY, make)
    assert len(made) == 1


@pytest.mark.parametrize("length", [0, 1, 100, -1])
def test_a_truncated_record_is_set_aside_and_made_again(tmp_path, length):
    store = Store(tmp_path)
    store.write("press", KEY, {"x": np.arange(1000.0)}, {})
    path = store.path("press", KEY)
    path.write_bytes(path.read_bytes()[:length])
    assert store.read("press", KEY) is None
    assert store.damaged == [str(path)]
    arrays, _ = store.kept("press", KEY, lambda: ({"x": np.arange(4)}, {}))
    assert len(arrays["x"]) == 4


def test_a_record_of_another_key_is_not_taken(tmp_path):
    store = Store(tmp_path)
    store.write("press", KEY, {"x": np.arange(3)}, {})
    other = KEY[:32] + "b" * 32  # the same file name
    assert store.read("press", other) is None


def test_no_half_written_file_is_left_when_writing_fails(tmp_path, monkeypatch):
    store = Store(tmp_path)

    def full(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(np, "savez", full)
    with pytest.raises(PalpateError, match="No space left"):
        store.write("press", KEY, {"x": np.arange(3)}, {})
    assert list((tmp_path / "press").iterdir()) == []
