# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import errno
import os
import resource
import tempfile
from pathlib import Path

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


def test_a_file_that_does_not_fit_is_told_and_what_was_kept_stays(tmp_path):
    store, other = Store(tmp_path), "b" * 64
    store.write("press", KEY, {"x": np.arange(3)}, {})
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, before[1]))
    try:
        with pytest.raises(PalpateError, match=r"cannot keep results \(File too large\); .* still there"):
            store.write("press", other, {"x": np.zeros(10_000)}, {})
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert store.read("press", KEY) is not None and store.read("press", other) is None
    assert len(list((tmp_path / "press").iterdir())) == 1


@pytest.mark.parametrize("what", ["write", "set aside"])
def test_a_folder_that_takes_nothing_is_told_in_a_sentence(what, tmp_path, monkeypatch):
    store = Store(tmp_path)
    store.write("press", KEY, {"x": np.arange(3)}, {})
    store.path("press", KEY).write_bytes(b"garbage")
    if os.geteuid() == 0:  # nothing is read-only to root

        def refuse(*args, **kwargs):
            raise OSError(errno.EROFS, "Read-only file system")

        monkeypatch.setattr(tempfile, "mkstemp", refuse)
        monkeypatch.setattr(Path, "replace", refuse)
    else:
        (tmp_path / "press").chmod(0o555)
    try:
        with pytest.raises(PalpateError, match=r"\((Read-only file system|Permission denied)\)"):
            store.write("press", KEY, {}, {}) if what == "write" else store.read("press", KEY)
    finally:
        (tmp_path / "press").chmod(0o755)


def test_a_changed_byte_is_noticed_or_changes_nothing(tmp_path):
    store, x = Store(tmp_path), np.arange(40.0)
    store.write("press", KEY, {"x": x}, {"n": 3})
    path = store.path("press", KEY)
    whole = path.read_bytes()
    for at in range(0, len(whole), 3):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 0x55]) + whole[at + 1 :])
        found = store.read("press", KEY)
        assert found is None or (np.array_equal(found[0]["x"], x) and found[1] == {"n": 3})
    assert len(store.damaged) > len(whole) // 6


def test_what_killed_writers_left_is_swept_and_what_living_ones_write_is_not(tmp_path):
    store = Store(tmp_path)
    store.write("press", KEY, {"x": np.arange(3)}, {})
    old, new = tmp_path / "press" / "a.part", tmp_path / "press" / "b.part"
    for path in (old, new):
        path.write_bytes(b"half")
    os.utime(old, (0.0, 0.0))
    store.sweep()
    assert not old.exists() and new.exists() and store.read("press", KEY) is not None
