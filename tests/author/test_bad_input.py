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
NEO_HOOKEAN = 'model = "neo_hookean"\nyoungs_modulus = "5.4 kPa"'
CAPSULE = """[organ.capsule]
thickness = "2 mm"
material = { model = "yeoh", c10 = "0.2 MPa", c20 = 0.0 }

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
    "a material that softens": (
        [(NEO_HOOKEAN, 'model = "yeoh"\nc10 = "0.9 kPa"\nc20 = "-1 kPa"')],
        ["organ.material", "softens", "c20 below zero"],
    ),
    "Ogden terms that do not match": (
        [(NEO_HOOKEAN, 'model = "ogden"\nmu = ["1 kPa", "0.5 kPa"]\nalpha = [6.0]')],
        ["organ.material.alpha", "one exponent for each mu"],
    ),
    "a material that compresses to nothing": (
        [("poissons_ratio = 0.48", "poissons_ratio = 0.5")],
        ["organ.material.poissons_ratio", "below 0.5"],
    ),
    "a capsule as thick as the tool": (
        [("[reach]", CAPSULE)],
        ["organ.capsule.thickness", '"2 mm"', "at most 0.001 m"],
    ),
    "a capsule that softens": (
        [("[reach]", CAPSULE.replace("2 mm", "50 um").replace("c20 = 0.0", 'c20 = "-1 MPa"'))],
        ["organ.capsule.material", "softens"],
    ),
    "an elastic support without stiffness": (
        [('kind = "fixed"', 'kind = "elastic"')],
        ["organ.support[0].stiffness", "is missing", "kPa/mm"],
    ),
    "no support at all": (
        [(f'[[organ.support]]                       # glued to the table\n{SUPPORT}\nkind = "fixed"', "")],
        ["organ.support", "is missing"],
    ),
    "a depth through the organ": (
        [('depth_max = "4 mm"', 'depth_max = "31 mm"'), ('radius = "5 mm"', 'radius = "31 mm"')],
        ["reach.depth_max", '"31 mm"', "0.03 m thick"],
    ),
    "a depth beyond what the thickness allows": (
        [('depth_max = "4 mm"', 'depth_max = "14 mm"'), ('radius = "5 mm"', 'radius = "14 mm"')],
        ["reach", "no place that ball_5mm can press", "thinner than 35.0 mm"],
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
    (tmp_path / "t.csv").write_text("dt,x,y,z\n0.001,0,0,0\n")
    for command in (
        ["inspect"],
        ["certify", "--damping", "1", "--rate", "1000"],
        ["replay", str(tmp_path / "t.csv")],
    ):
        assert main([command[0], str(path), *command[1:]]) == 2
        err = capfd.readouterr().err
        assert err.count("short.rfield") == 1 and "Traceback" not in err
