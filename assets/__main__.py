# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""`python -m palpate.assets [FOLDER]` regenerates the phantoms (by default the ones that ship)."""

import sys
from pathlib import Path

from palpate.assets import PHANTOM_FOLDER
from palpate.assets.phantom import generate

for file in generate(Path(sys.argv[1]) if len(sys.argv) > 1 else PHANTOM_FOLDER):
    print(file)
