# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The shipped schema is what the table says, registers before first use, and documents every attribute."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from palpate.fields.usd_schema import schema_path
from palpate.fields.usd_schema.attributes import APIS
from palpate.fields.usd_schema.generate import generated_schema, plug_info


def python(program: str, **environment: str) -> subprocess.CompletedProcess:
    import os

    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, env={**os.environ, **environment}
    )


def test_the_shipped_files_are_those_that_the_table_makes():
    assert (schema_path() / "generatedSchema.usda").read_text(encoding="utf-8") == generated_schema()
    assert (schema_path() / "plugInfo.json").read_text(encoding="utf-8") == plug_info()


@pytest.mark.parametrize("api", APIS)
def test_every_attribute_is_documented_with_range_and_unit(api):
    assert APIS[api].doc.endswith(".")
    for row in APIS[api].attributes.values():
        assert re.fullmatch(r"\S.*\. Range: .+\. Unit: [^.]+\.", row.documentation), row


SEEN = """
from pxr import Usd
from palpate.fields.usd_schema.attributes import APIS
stage = Usd.Stage.CreateInMemory()
prim = stage.DefinePrim("/prim", "Points")
for api in APIS.values():
    assert prim.ApplyAPI(api.name), api.name
    definition = prim.GetPrimDefinition()
    for row in api.attributes.values():
        assert definition.GetPropertyDocumentation(row.name) == row.documentation, row.name
        attribute = prim.GetAttribute(row.name)
        assert str(attribute.GetTypeName()) == row.usd_type and not attribute.IsCustom(), row.name
print("seen")
"""
REGISTER = "from palpate.fields.usd_schema import register; register(); register()"


@pytest.mark.parametrize("before", ["", "from pxr import Usd, UsdGeom", "import palpate.fields.usd_write"])
def test_registering_before_first_use_is_seen(before):
    """Importing pxr is not yet use: the registry is built by the first prim definition that is asked for."""
    run = python(f"{before}\n{REGISTER}\n{SEEN}")
    assert run.stdout == "seen\n" and run.stderr == ""


def test_the_environment_variable_does_it_without_a_line_of_code():
    assert python(SEEN, PXR_PLUGINPATH_NAME=str(schema_path())).stdout == "seen\n"
    assert python(SEEN).returncode != 0


def test_registering_after_first_use_says_so():
    run = python(f"from pxr import Usd; Usd.SchemaRegistry()\n{REGISTER}")
    assert run.returncode != 0
    assert "call register() before the first stage, or set PXR_PLUGINPATH_NAME=" in run.stderr


def test_a_registered_process_reads_and_validates_the_same(asset):
    program = f"""
{REGISTER}
from palpate.fields.usd_read import read_field
from palpate.fields.usd_validators import asset_errors
field = read_field({str(asset)!r}, "ball_5mm")
assert asset_errors({str(asset)!r}) == []
from pxr import Usd
stage = Usd.Stage.Open({str(asset)!r})
nodes = stage.GetPrimAtPath("/block/Response/Nodes")
assert "Unit: J." in nodes.GetAttribute("primvars:palpate:storedEnergy").GetDocumentation()
print(field.nodes.stored_energy.tobytes().hex())
"""
    from palpate.fields.usd_read import read_field

    run = python(program)
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == read_field(asset, "ball_5mm").nodes.stored_energy.tobytes().hex()
