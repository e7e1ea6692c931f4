# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What a user gets wrong ends with exit code 2 and a sentence that names file, key, value and what would be right."""

import numpy as np
import pytest
import trimesh

from palpate.assets import PHANTOM_FOLDER, scene_path
from palpate.author.command_line import main

BLOCK = PHANTOM_FOLDER / "palpation_block.ply"
REGION = """[[organ.region]]
name = "n"
sphere = { center = [1.0, 0.0, 0.0], radius = "5 mm" }
material = { model = "neo_hookean", youngs_modulus = "40 kPa", poissons_ratio = 0.48 }

[reach]"""
SUPPORT = "box = { min = [-0.1, -0.1, -0.01], max = [0.1, 0.1, 0.001] }"
CASES = {
    "an open surface that may not be repaired": (
        [('units = "m"', 'units = "m"\nrepair = "none"')],
        ["organ.repair", '"none"', "closed"],
    ),
    "millimetres taken for metres": ([], ["organ.surface", "200 m", 'units = "mm"']),
    "a tool larger than the organ": (
        [('radius = "5 mm"', 'radius = "200 mm"')],
        ["tool[0].radius", "larger"],
    ),
    "a support that holds nothing": (
        [(SUPPORT, "box = { min = [1.0, 1.0, 1.0], max = [2.0, 2.0, 2.0] }")],
        ["organ.support[0]", "holds nothing"],
    ),
    "a region outside the organ": ([("[reach]", REGION)], ["organ.region[0]", "outside the organ"]),
    "a material that is not positive": (
        [('youngs_modulus = "5.4 kPa"', 'youngs_modulus = "-5.4 kPa"')],
        ["organ.material.youngs_modulus", '"-5.4 kPa"', "above 0"],
    ),
    "an unknown effect": ([('"friction"]', '"smell"]')], ["scene.effects[1]", '"smell"', "texture"]),
    "a reach without surface": (
        [("center = [0.014, 0.004, 0.03]", "center = [0.5, 0.004, 0.03]")],
        ["reach", "none of the organ's surface"],
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_sentence_names_file_key_value_and_what_would_be_right(case, tmp_path, capfd):
    mesh = trimesh.load(BLOCK)
    if case == "millimetres taken for metres":
        mesh.apply_scale(2500.0)
    if case == "an open surface that may not be repaired":
        mesh.update_faces(np.arange(len(mesh.faces)) > 30)
    mesh.export(tmp_path / "organ.ply")
    text = scene_path("palpation_block").read_text().replace("../phantoms/palpation_block.ply", "organ.ply")
    changes, told = CASES[case]
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    scene = tmp_path / "scene.toml"
    scene.write_text(text)
    assert main(["author", str(scene), "--out", str(tmp_path / "out")]) == 2
    err = capfd.readouterr().err
    assert "scene.toml" in err and "expected" in err and "Traceback" not in err
    for words in told:
        assert words in err
    assert not list((tmp_path / "out").glob("**/press/*"))


@pytest.mark.parametrize("length", [0, 100, 5000])
def test_a_truncated_field_is_refused(length, tmp_path, capfd):
    from known_organ import KnownOrgan, field_of

    from palpate.fields.cook import cook

    path = tmp_path / "short.rfield"
    path.write_bytes(cook(field_of(KnownOrgan(), 12))[:length])
    assert main(["inspect", str(path)]) == 2
    err = capfd.readouterr().err
    assert "short.rfield" in err and "Traceback" not in err
