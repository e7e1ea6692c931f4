# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The asset in other people's software, where it is installed: Newton simulates the organ, NVIDIA's validator passes.

    pip install "newton[importers]" usd-validation-nvidia

Each runs in a process of its own: Newton registers schemas with USD for as long as a process lives.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys

import numpy as np
import pytest

from palpate.fields.usd_read import read_organ
from palpate.fields.usd_write import add_tool


def needs(*modules: str) -> pytest.MarkDecorator:
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    return pytest.mark.skipif(bool(missing), reason=f"{', '.join(missing)} not installed here")


NEWTON = """
import json, sys
import newton
builder = newton.ModelBuilder()
builder.add_usd(sys.argv[1])
model = builder.finalize(device="cpu")
print(json.dumps({
    "tets": model.tet_indices.numpy().tolist(), "points": model.particle_q.numpy().tolist(),
    "materials": model.tet_materials.numpy()[:, :2].tolist(), "mass": float(model.particle_mass.numpy().sum()),
    "bodies": model.body_count,
}))
"""


@needs("newton", "newton_usd_schemas")
def test_newton_makes_a_soft_body_of_the_organ(asset):
    run = subprocess.run(
        [sys.executable, "-c", NEWTON, str(asset)], capture_output=True, text=True, timeout=300
    )
    assert run.returncode == 0, run.stderr
    told = json.loads(run.stdout.splitlines()[-1])
    organ = read_organ(asset)
    np.testing.assert_allclose(told["points"], organ.tet_points, atol=1e-8)
    tets = np.array(told["tets"]).reshape(-1, 4)
    assert np.array_equal(np.sort(tets, axis=1), np.sort(organ.tet_indices, axis=1)) and told["bodies"] == 0
    mu, nu = 1800.0, 0.49  # of the organ's tissue: Newton takes one material, and says so
    np.testing.assert_allclose(
        told["materials"], np.tile([mu, 2 * mu * nu / (1 - 2 * nu)], (len(tets), 1)), rtol=1e-5
    )
    volume = 2 * 0.02**3
    assert told["mass"] == pytest.approx(1060.0 * volume, rel=1e-4)


NVIDIA = """
import sys
from usd_validation_nvidia import cli_main
sys.argv[0] = "validate"
sys.exit(cli_main())
"""


@needs("usd_validation_nvidia")
def test_nvidia_s_validator_finds_nothing_to_say(asset, make_field, tmp_path):
    add_tool(asset.parent, make_field("probe", seed=5), per_vertex=True)
    found = tmp_path / "found.json"
    run = subprocess.run(
        [sys.executable, "-c", NVIDIA, str(asset), "--json-output", str(found)],
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert run.returncode == 0, run.stdout + run.stderr
    assert json.loads(found.read_text()) == {"status": "PASS", "rules": []}
