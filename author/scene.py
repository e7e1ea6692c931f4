# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""The scene file: what a simulation needs, read once, checked as a whole, immutable afterwards.

    scene = load_scene(Path("liver.toml"))     every problem at once, as one InputError
    require_capabilities(scene)                everything this version cannot do, as one InputError
    check_against_organ(scene, organ)          everything that only the mesh can tell

Numbers in a Scene are SI floats, angles in rad, shares as fractions; files are absolute paths.
"""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any, TypeVar

from pydantic import Field, PrivateAttr, ValidationError

from palpate.author.errors import InputError, InputProblem
from palpate.author.scene_problems import Location, did_you_mean, table_problems, written
from palpate.author.scene_rules import broken_rules
from palpate.author.scene_tables import Accuracy, Device, Organ, Reach, SceneHead, Tool
from palpate.author.scene_types import Table, canonical
from palpate.author.texture.texture_table import Texture

__all__ = ["Scene", "load_scene", "scene_schema"]

T = TypeVar("T", bound=Table)

DEPTH_WITHOUT_RADIUS = 5e-3
"""m; deepest press of a tool without a radius in a scene that states no depth."""


_TABLES = ("accuracy", "device", "organ", "reach", "scene", "texture", "tool")


class Scene(Table):
    """A whole scene file.

    Attributes: the tables of the file by their names; `file` is where it came from.
    """

    scene: SceneHead
    organ: Organ
    reach: Reach = Field(
        default=Reach(), description="the surface that a tool can touch, everything when absent"
    )
    tool: tuple[Tool, ...] = Field(min_length=1, description="at least one tool")
    accuracy: Accuracy = Field(default=Accuracy(), description="how true the field has to be")
    device: Device | None = Field(default=None, description="the haptic device, for certify")
    texture: tuple[Texture, ...] = Field(default=(), description="heights on the organ's surface")
    file: Path = Field(default=Path("."), exclude=True)
    _written: dict[str, Any] = PrivateAttr(default_factory=dict)

    @property
    def name(self) -> str:
        return self.scene.name

    @property
    def effects(self) -> tuple[str, ...]:
        return self.scene.effects

    def tool_named(self, name: str) -> Tool:
        """Raises InputError when the scene has no such tool."""
        names = [tool.name for tool in self.tool]
        if name in names:
            return self.tool[names.index(name)]
        what = f"is no tool of this scene{did_you_mean(name, names)}"
        raise InputError(InputProblem(str(self.file), "tool", name, what, "one of " + ", ".join(names)))

    def depth_max(self, tool: Tool) -> float:
        """Depth that presses with `tool` are asked to reach, m; of a family, its largest radius (tool_members.py)."""
        if self.reach.depth_max is not None:
            return self.reach.depth_max
        return max(tool.radius) if tool.radius else DEPTH_WITHOUT_RADIUS

    def problem(
        self, key: str, value: Any, what: str, expected: str, introduced_by: str = "expected"
    ) -> InputProblem:
        """A problem at `key` of this scene, told with the value as the file writes it."""
        value = written(self._written, key, value)
        return InputProblem(str(self.file), key, value, what, expected, introduced_by)

    def hash_inputs(self) -> dict[str, Any]:
        return {key: canonical(getattr(self, key)) for key in _TABLES if getattr(self, key) not in (None, ())}


def load_scene(path: Path | str) -> Scene:
    """The scene in the TOML file at `path`.

    Raises InputError with all that is wrong in it: syntax, unknown keys, units, ranges, contradictions.
    """
    path = Path(path)
    raw = _read(path)
    models = {"scene": SceneHead, "organ": Organ, "reach": Reach, "accuracy": Accuracy, "device": Device}
    problems: list[InputProblem] = []
    tables: dict[str, Any] = {}
    for key in raw:
        if key not in models and key not in ("texture", "tool"):
            known = [*models, "texture", "tool"]
            what = f"is no known table{did_you_mean(key, known)}"
            problems.append(InputProblem(str(path), key, None, what, "one of " + ", ".join(known)))
    for key, model in models.items():
        if key in raw:
            tables[key] = _table(model, raw[key], (key,), path, problems)
        elif key in ("scene", "organ"):
            problems.append(InputProblem(str(path), key, None, "is missing", f"a table [{key}]"))
    tables["tool"] = _tools(raw, path, problems)
    tables["texture"] = _textures(raw, path, problems)

    told = [problem.key for problem in problems]
    for key, value, what, expected in broken_rules({k: v for k, v in tables.items() if v is not None}):
        if not any(_same_place(key, other) for other in told):
            problems.append(InputProblem(str(path), key, written(raw, key, value), what, expected))
    if problems:
        raise InputError(problems)
    tools, textures = (tuple(tables.pop(key).values()) for key in ("tool", "texture"))
    scene = Scene(**tables, tool=tools, texture=textures, file=path)
    scene._written = raw
    return scene


def scene_schema() -> dict[str, Any]:
    """JSON schema of a scene file."""
    schema = Scene.model_json_schema(mode="validation")
    del schema["properties"]["file"]
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "palpate scene",
        "description": "A scene file. Numbers are SI; strings carry their unit.",
    }


def _read(path: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        what, expected = "does not exist", "a scene file"
    except (OSError, UnicodeDecodeError) as error:
        what, expected = f"cannot be read ({error})", "a text file in UTF-8"
    except tomllib.TOMLDecodeError as error:
        what, expected = f"is not TOML: {error}", "a scene file in TOML"
    raise InputError(InputProblem(str(path), "", None, what, expected))


def _tools(raw: dict[str, Any], path: Path, problems: list[InputProblem]) -> dict[int, Tool]:
    entries = raw.get("tool", [])
    if not isinstance(entries, list) or not entries:
        problems.append(InputProblem(str(path), "tool", None, "is missing", "at least one table [[tool]]"))
        return {}
    read = {i: _table(Tool, entry, ("tool", i), path, problems) for i, entry in enumerate(entries)}
    return {i: tool for i, tool in read.items() if tool is not None}


def _textures(raw: dict[str, Any], path: Path, problems: list[InputProblem]) -> dict[int, Texture]:
    entries = raw.get("texture", [])
    if not isinstance(entries, list):
        problems.append(InputProblem(str(path), "texture", None, "is no list", "tables [[texture]]"))
        return {}
    read = {i: _table(Texture, entry, ("texture", i), path, problems) for i, entry in enumerate(entries)}
    return {i: texture for i, texture in read.items() if texture is not None}


def _table(model: type[T], raw: Any, prefix: Location, path: Path, problems: list[InputProblem]) -> T | None:
    """The table, its problems noted.

    Wrong keys are left out where it can be read without them, so that rules between keys are checked too.
    """
    context = {"folder": path.resolve().parent}
    try:
        return model.model_validate(raw, context=context)
    except ValidationError as error:
        found = list(table_problems(error, model, raw, str(path), prefix))
    problems += [problem for _, problem in found]
    try:
        return model.model_validate(_without(raw, [place for place, _ in found]), context=context)
    except ValidationError:
        return None


def _without(raw: Any, places: list[Location], here: Location = ()) -> Any:
    if isinstance(raw, dict):
        kept = {k: v for k, v in raw.items() if not _is_wrong((*here, k), places)}
        return {k: _without(v, places, (*here, k)) for k, v in kept.items()}
    if isinstance(raw, list):
        return [_without(v, places, (*here, i)) for i, v in enumerate(raw)]
    return raw


def _is_wrong(key: Location, places: list[Location]) -> bool:
    """Whether a problem stands at this key or in the list of plain values that it holds."""
    return any(
        p[: len(key)] == key and not any(isinstance(part, str) for part in p[len(key) :]) for p in places
    )


def _same_place(key: str, other: str) -> bool:
    """Whether one key is the other or lies inside it."""
    return any(a == b or a.startswith((b + ".", b + "[")) for a, b in ((key, other), (other, key)))
