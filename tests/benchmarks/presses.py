# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What presses cost on this machine, by fidelity, organ, workers, tool, patch and depths, and beside CalculiX.

    python tests/benchmarks/presses.py SCENE --out FOLDER [--parts fidelity,workers] [--json FILE]

Finished measurements are kept in FOLDER, so that the same command goes on where it was stopped; a changed mechanics is
measured anew.  Nothing is asserted: what is asked stands beside what was measured.  Leave the machine alone meanwhile.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import one_press  # noqa: E402
import organs  # noqa: E402
import rates  # noqa: E402
import second_code  # noqa: E402
from measured import HEAD, Measured, lines, machine, record  # noqa: E402
from setting import Setting  # noqa: E402

from palpate.author.errors import PalpateError  # noqa: E402
from palpate.author.scene import load_scene  # noqa: E402
from palpate.author.store import Store  # noqa: E402

PARTS = {
    "fidelity": one_press.fidelity,
    "calculix": second_code.calculix,
    "organ_size": organs.organ_size,
    "workers": rates.workers,
    "tool": rates.tool,
    "patch": one_press.patch,
    "depths": one_press.depths,
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path)
    parser.add_argument("--out", type=Path, required=True, help="folder for meshes and finished measurements")
    parser.add_argument("--parts", default=",".join(PARTS), help="some of: %(default)s")
    parser.add_argument("--contacts", type=int, help="of the parts fidelity, workers and tool")
    parser.add_argument("--json", type=Path, help="rows with all that they come from")
    given = parser.parse_args()
    parts = given.parts.split(",")
    unknown = [part for part in parts if part not in PARTS]
    if unknown:
        parser.error(f"--parts: {', '.join(unknown)} is none of {', '.join(PARTS)}")
    begun = time.time()

    def say(sentence: str) -> None:
        print(f"{time.time() - begun:5.0f} s  {sentence}", file=sys.stderr, flush=True)

    setting = Setting(load_scene(given.scene), Store(given.out), say)
    about = machine()
    print(f"{about['processor']}, {about['cores']} cores, {about['system']}; Python {about['python']}, "
          f"palpate {about['palpate']} ({about['mechanics']}); {setting.scene.name}\n")  # fmt: skip
    print(HEAD, flush=True)
    rows: list[Measured] = []
    for part in parts:
        counted = part in ("fidelity", "workers", "tool") and given.contacts
        found = PARTS[part](setting, given.contacts) if counted else PARTS[part](setting)
        print(lines(found), flush=True)
        rows += found
        if given.json:  # after each part: the last may take an hour
            given.json.write_text(json.dumps(record(rows, scene=setting.scene.name), indent=1))


if __name__ == "__main__":
    try:
        main()
    except PalpateError as error:
        sys.exit(str(error))
