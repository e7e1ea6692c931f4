# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Results kept by the hash of all that they depend on, so that a killed run loses only what was in flight.

A result is an .npz of plain arrays plus one JSON text.  It is written beside its place and renamed, so that a
reader sees all of it or nothing; a file that cannot be read is set aside and made again.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from palpate.author.errors import PalpateError

__all__ = ["Result", "Store"]

Result = tuple[dict[str, np.ndarray], dict[str, Any]]
"""Arrays and JSON-clean values."""
ABANDONED = 3600.0
"""s; no writer takes as long."""


class Store:
    """A folder of results, one kind a subfolder.

    Args:
        folder: made when the first result is written.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = Path(folder)
        self.damaged: list[str] = []

    def path(self, kind: str, key: str) -> Path:
        return self.folder / kind / f"{key[:32]}.npz"

    def read(self, kind: str, key: str) -> Result | None:
        """The result, or None when it is not there or is damaged (then set aside as .damaged, and named).

        Raises:
            PalpateError: the file is there, but the system does not let it be read or set aside.
        """
        path = self.path(kind, key)
        try:
            with open(path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files if name != "_json"}
                values = json.loads(str(file["_json"]))
            if values.pop("_key") != key:
                raise ValueError("the result belongs to another key")
            if values.pop("_arrays", sorted(arrays)) != sorted(arrays):
                raise ValueError("arrays are missing, or have other names")
        except FileNotFoundError:
            return None
        except PermissionError as error:
            raise PalpateError(f"{path} cannot be read ({error.strerror})") from error
        except Exception:  # a damaged file breaks the reader anywhere: archive, header, array, text
            self._set_aside(path)
            return None
        return arrays, values

    def _set_aside(self, path: Path) -> None:
        try:
            path.replace(path.with_suffix(".damaged"))
        except FileNotFoundError:
            return  # another reader was faster
        except OSError as error:
            raise PalpateError(
                f"{path} is damaged and cannot be set aside ({error.strerror}); make its folder writable"
            ) from error
        self.damaged.append(str(path))

    def sweep(self) -> None:
        """Remove what killed writers left half-written: unfinished files that nobody has touched for an hour."""
        for path in self.folder.glob("*/*.part"):
            with suppress(OSError):
                if time.time() - path.stat().st_mtime > ABANDONED:
                    path.unlink()

    def write(self, kind: str, key: str, arrays: dict[str, np.ndarray], values: dict[str, Any]) -> None:
        """Keep a result.

        Raises:
            PalpateError: the folder cannot be written, or the disk is full.
        """
        path = self.path(kind, key)
        text = json.dumps({**values, "_key": key, "_arrays": sorted(arrays)})
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
            try:
                with os.fdopen(handle, "wb") as file:
                    np.savez(file, _json=np.array(text), **arrays)
                os.replace(temporary, path)
            except BaseException:
                Path(temporary).unlink(missing_ok=True)
                raise
        except OSError as error:
            raise PalpateError(
                f"{path.parent} cannot keep results ({error.strerror or error}); "
                "what was finished before is still there"
            ) from error

    def kept(self, kind: str, key: str, make: Callable[[], Result]) -> Result:
        """The kept result, or a new one, kept from now on."""
        found = self.read(kind, key)
        if found is None:
            arrays, values = make()
            self.write(kind, key, arrays, values)
            return arrays, values
        return found
