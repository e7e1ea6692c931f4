# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""A cooked file of any version says for ever what it said when it was made, to the Python reader and to C++."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from palpate.fields.interpolation import evaluate
from palpate.fields.rfield_layout import HEADER_DTYPE, LAYOUT_HASH, OLDER_VERSIONS, VERSION
from palpate.fields.rfield_read import read_header, read_rfield
from palpate.runtime import Config, Field, Session

HERE = Path(__file__).parent
VERSIONS = sorted(int(path.stem[1:]) for path in HERE.glob("v*.rfield"))
RELATIVE = 1e-11
"""Of the largest value; sums of 27 terms in another order."""


@pytest.fixture(params=VERSIONS, ids=lambda version: f"v{version}")
def golden(request):
    return HERE / f"v{request.param}.rfield", json.loads((HERE / f"v{request.param}.json").read_text())


def close(value, truth) -> None:
    np.testing.assert_allclose(value, truth, rtol=0.0, atol=RELATIVE * np.abs(truth).max())


def test_every_version_that_is_read_has_a_golden_file():
    assert VERSIONS == sorted([*OLDER_VERSIONS, VERSION]), "run tests/golden/regenerate.py"


def test_a_changed_layout_has_a_new_version_and_the_old_one_stays_readable():
    known = {**OLDER_VERSIONS, VERSION: (LAYOUT_HASH, HEADER_DTYPE.itemsize)}
    for version in VERSIONS:
        said = json.loads((HERE / f"v{version}.json").read_text())
        stored = (int(said["layout_hash"], 16), said["header_size"])
        assert known[version] == stored, (
            f"the layout of version {version} is no longer that of its golden file: give the new layout a new VERSION, "
            f"move {version} to OLDER_VERSIONS, and run tests/golden/regenerate.py"
        )


def test_the_file_is_the_one_that_was_written(golden):
    path, said = golden
    data = path.read_bytes()
    assert len(data) < 40_000
    assert hashlib.sha256(data).hexdigest() == said["sha256"]
    header = read_header(data)
    assert (int(header["version"]), header["field_hash"].decode()) == (said["version"], said["field_hash"])


def test_what_an_old_header_lacks_is_zero(golden):
    path, said = golden
    end = said["header_size"]
    header = read_header(path)
    for name, (kind, offset) in ((name, HEADER_DTYPE.fields[name][:2]) for name in HEADER_DTYPE.names):
        if offset >= end and name not in ("way_count", "way_cosine", "way_offset"):  # given to version 1
            assert not np.any(header[name]), (name, kind)


def test_python_reads_what_it_said_at_first(golden):
    path, said = golden
    for way, truth in enumerate(said["ways"]):
        found = evaluate(read_rfield(path, way), np.array(said["places"]))
        for name, value in truth.items():
            close(getattr(found, name), np.array(value))


def test_cpp_reads_what_it_said_at_first(golden):
    path, said = golden
    field = Field.open(path)
    assert field.info.field_hash == said["field_hash"]
    assert field.info.way_cosine.tolist() == said["way_cosine"]
    first = field.sample(said["places"])
    names = {"depth": "depth", "energy": "stored_energy", "friction_stiffness": "friction_stiffness",
             "friction_coefficient": "friction_coefficient"}  # fmt: skip
    for name, member in names.items():
        close(first[member], np.array(said["ways"][0][name]))
    close(first["force"], -np.array(said["ways"][0]["gradient"]))


def test_cpp_feels_each_way_as_it_said_at_first(golden):
    path, said = golden
    field = Field.open(path)
    for cosine, truth in zip(said["way_cosine"], said["ways"], strict=True):
        held = Rotation.from_rotvec([0.0, np.arccos(cosine), 0.0]).as_quat()
        for place, gradient in zip(said["places"], truth["gradient"], strict=True):
            session = Session(field, Config(friction_coefficient=0.0, speed_max=0.0))
            way_in = np.linspace([place[0], place[1], 7e-3], place, 50)
            felt = session.tick_batch(way_in, orientations=np.tile(held, (50, 1)))[-1]["force"]
            np.testing.assert_allclose(felt, -np.array(gradient), rtol=1e-9, atol=1e-9)
