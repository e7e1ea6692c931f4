# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What `palpate plan` says before a run against what the run took.

    python tests/benchmarks/plan_against_run.py SCENE ANSWER [SCENE ANSWER ...] [--tool NAME] [--workers N]

ANSWER is what `palpate author SCENE [--tool NAME] --json` printed, or the asset's summary.json; of a fresh folder,
for what is kept from an earlier run costs nothing.  CPU seconds do not depend on what else the machine does, wall
seconds do.  Exit code 1 where the CPU estimate is off by more than FACTOR either way.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from palpate.author.plan import plan
from palpate.author.scene import load_scene

FACTOR = 1.5


def compared(scene: Path, answer: Path, tool: str = "", workers: int | None = None) -> dict[str, Any]:
    """Plan and run of one scene: seconds, nodes, presses and bytes, each (planned, taken)."""
    said, ran = plan(load_scene(scene), workers, tool).result, json.loads(answer.read_text())
    rows = {row["name"]: row for row in ran["tools"]}
    tools = [row for row in said["tools"] if row["name"] in rows]
    pairs = {
        name: (sum(row[key] for row in tools), sum(rows[row["name"]][name] for row in tools))
        for name, key in (("nodes", "pressed"), ("presses", "presses"), ("bytes", "bytes"))
    }
    return {
        "scene": said["scene"],
        "cpu_seconds": (said["cpu_seconds"], ran["cpu_seconds"]),
        "seconds": (said["seconds"], ran["seconds"]),
        **pairs,
        "met": 1.0 / FACTOR <= said["cpu_seconds"] / ran["cpu_seconds"] <= FACTOR,
    }


def main() -> int:
    asked = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    asked.add_argument("pairs", nargs="+", type=Path, metavar="SCENE ANSWER")
    asked.add_argument("--tool", default="")
    asked.add_argument("--workers", type=int)
    given = asked.parse_args()
    if len(given.pairs) % 2:
        asked.error("an ANSWER for each SCENE is right")
    met = True
    for scene, answer in zip(given.pairs[::2], given.pairs[1::2], strict=True):
        found = compared(scene, answer, given.tool, given.workers)
        met &= found.pop("met")
        print(found.pop("scene"))
        for name, (planned, taken) in found.items():
            print(f"  {name:12}  planned {planned:9.0f}  taken {taken:9.0f}  ratio {planned / taken:.2f}")
    print(f"CPU within a factor of {FACTOR}: {'yes' if met else 'NO'}")
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
