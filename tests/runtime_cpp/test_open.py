# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Opening from Python: from a path, from bytes, and what is refused."""

import numpy as np
import pytest

from palpate.fields.rfield_read import read_header
from palpate.runtime import Field, RuntimeFailure


def test_a_file_and_its_bytes_open_alike(tmp_path, plane):
    path = tmp_path / "plane.rfield"
    path.write_bytes(plane.data)
    q = np.random.default_rng(1).uniform(-5e-3, 5e-3, (50, 3))
    assert Field.open(path).sample(q).tobytes() == plane.field.sample(q).tobytes()


def test_info_is_what_the_header_says(plane):
    info, header = plane.field.info, read_header(plane.data)
    assert info.tool_name == "ball_5mm" and info.tool_shape == "sphere" and info.bytes == len(plane.data)
    assert info.provenance == {"mesh": "synthetic", "seed": 1}
    assert info.field_hash == header["field_hash"].decode() and len(info.field_hash) == 64
    for name in ("tool_offset", "depth_max", "stiffness_max", "geometry_spacing", "amplitude_spacing"):
        assert getattr(info, name) == header[name]
    assert np.all(info.box_max > info.box_min) and np.array_equal(info.band, header["band"])


@pytest.mark.parametrize(
    ("spoil", "sentence"),
    [
        (lambda d: b"", "fewer"),
        (lambda d: d[:300], "fewer"),
        (lambda d: d[:-1], "bytes"),
        (lambda d: d + b"x", "bytes"),
        (lambda d: b"x" + d[1:], "not an .rfield"),
        (lambda d: d[:8] + b"\x07" + d[9:], "version 7"),
        (lambda d: d[:5000] + bytes([d[5000] ^ 4]) + d[5001:], "checksum"),
    ],
)
def test_a_spoilt_file_is_refused_with_one_sentence(plane, spoil, sentence):
    with pytest.raises(RuntimeFailure, match=sentence) as refusal:
        Field.open(spoil(plane.data))
    assert str(refusal.value).endswith(".") and refusal.value.status != 0


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(RuntimeFailure, match=r"absent\.rfield"):
        Field.open(tmp_path / "absent.rfield")
