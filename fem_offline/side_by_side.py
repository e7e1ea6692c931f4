# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Several systems in one launch: a row of pointers each, displacements and results end to end.

A kernel runs over the items (tetrahedra, faces) of all systems.  Item i belongs to system k, the first whose `end`
lies above i; the system's row holds its arrays, and where its part of the common displacements and results begins.
What a system keeps on the device stays where it is: systems come and go without a copy and without a new kernel.
"""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
import warp as wp

from palpate.fem_offline.batch import together

__all__ = ["LARGEST", "Resident", "SideBySide", "batches"]

LARGEST = 2**30
"""Numbers in one array of results: places are 32-bit integers."""


class Pattern(Protocol):
    """Of a sparse matrix; its values are as many as its columns' indices."""

    column: np.ndarray


class Resident(ABC):
    """A system with arrays on a Warp device, evaluated beside others of its class."""

    kind: ClassVar[Any]
    """Warp struct that kernels read: arrays, among them `entry`, and the integers first_node and first_value."""
    hessian_kernel: ClassVar[wp.Kernel]
    device: str

    @property
    @abstractmethod
    def item_count(self) -> int:
        """Elements that a kernel runs over."""

    @property
    @abstractmethod
    def node_count(self) -> int:
        """Rows of a displacement."""

    @abstractmethod
    def entry(self, pattern: Any) -> np.ndarray:
        """(items, entries) places of element entries in the values of a pattern, in the order of the kernel."""

    def place(self, arrays: dict[str, tuple[np.ndarray, Any]], rule: np.ndarray) -> None:
        """Keep arrays, each with its Warp type, and the shape functions' gradients on the device."""
        together(_place, (self, arrays, rule))

    def hessian(self, u: np.ndarray, pattern: Any) -> np.ndarray:
        """Values of the Hessian's upper triangle, N/m, on the pattern."""
        return together(type(self).hessians, (self, u, pattern))

    @classmethod
    def hessians(cls, asked: Sequence[tuple[Resident, np.ndarray, Pattern]]) -> list[np.ndarray]:
        """Of systems on one device, each at its displacement (N, 3) m, in as few launches as can hold the values."""
        found = []
        for part in batches([len(pattern.column) for _, _, pattern in asked]):
            systems, displacements, patterns = zip(*asked[part], strict=True)
            rows = [system._row_on(pattern) for system, pattern in zip(systems, patterns, strict=True)]
            counts = [len(pattern.column) for pattern in patterns]
            together_here = SideBySide.of(systems, displacements, rows, counts)
            values = wp.zeros(sum(counts), dtype=wp.float64, device=together_here.device)
            together_here.launch(cls.hessian_kernel, [values])
            found += _host(values, np.cumsum(counts))
        return found

    def _row_on(self, pattern: Pattern) -> np.ndarray:
        if id(pattern) not in self._rows:
            entry = wp.array(self.entry(pattern), dtype=wp.int32, device=self.device)
            self._resident.entry = entry
            self._rows = {id(pattern): (pattern, entry, _row_of(self._resident))}
        return self._rows[id(pattern)][2]

    def _alone(self, row: np.ndarray) -> tuple[wp.array, wp.array]:
        """What a launch of this system alone reads, kept: making a table of structs takes as long as its forces."""
        if id(row) not in self._tables:
            end = wp.array([self.item_count], dtype=wp.int32, device=self.device)
            without_pattern = {key: kept for key, kept in self._tables.items() if kept[0] is self._row}
            self._tables = {**without_pattern, id(row): (row, _table(self, [row]), end)}
        return self._tables[id(row)][1:]


def _table(
    system: Resident,
    rows: Sequence[np.ndarray],
    nodes: np.ndarray | None = None,
    values: np.ndarray | None = None,
) -> wp.array:
    """Structs of systems like `system` on its device, with where each one's nodes and values begin."""
    table = np.zeros(len(rows), dtype=rows[0].dtype)  # concatenated, its layout would not be Warp's
    for k, row in enumerate(rows):
        table[k] = row[0]
    if nodes is not None:
        table["first_node"] = nodes
    if values is not None:
        table["first_value"] = values
    return wp.array(table, dtype=system.kind, device=system.device)


def _place(asked: Sequence[tuple[Resident, dict[str, tuple[np.ndarray, Any]], np.ndarray]]) -> list[None]:
    for system, arrays, rule in asked:
        resident = system.kind()
        for name, (array, dtype) in arrays.items():
            setattr(resident, name, wp.array(array, dtype=dtype, device=system.device))
        system._resident, system._row = resident, _row_of(resident)
        system._rule = wp.array(rule, dtype=wp.float64, device=system.device)
        system._rows, system._tables = {}, {}
    return [None] * len(asked)


@dataclass(frozen=True)
class SideBySide:
    """Systems of one class on one device, in the order of a launch.

    Attributes:
        rows: (K,) Warp array of their struct, with `first_node` and `first_value` set.
        end: (K,) Warp array; item counts, added up.
        rule: the shape functions' gradients.
        u: (sum N,) Warp array of displacements, m.
        item_ends, node_ends: (K,) int; sums of item and node counts.
        device: Warp device.
    """

    rows: wp.array
    end: wp.array
    rule: wp.array
    u: wp.array
    item_ends: np.ndarray
    node_ends: np.ndarray
    device: str

    @classmethod
    def of(
        cls,
        systems: Sequence[Resident],
        displacements: Sequence[np.ndarray],
        rows: Sequence[np.ndarray] | None = None,
        value_counts: Sequence[int] | None = None,
    ) -> SideBySide:
        """Args:
        displacements: (N_k, 3) m each.
        rows: (1,) of each system's struct; those without a pattern where none are given.
        value_counts: how many values each system's pattern has.

        Raises:
            ValueError: a displacement of another shape.
        """
        device = systems[0].device
        for system, u in zip(systems, displacements, strict=True):
            if np.shape(u) != (system.node_count, 3):
                raise ValueError(f"u has shape {np.shape(u)}; expected {(system.node_count, 3)}")
        item_ends = np.cumsum([system.item_count for system in systems])
        node_ends = np.cumsum([system.node_count for system in systems])
        rows = [system._row for system in systems] if rows is None else rows
        if len(rows) == 1:
            table, end = systems[0]._alone(rows[0])
        else:
            starts = np.concatenate([[0], node_ends[:-1]])
            values = None if value_counts is None else np.concatenate([[0], np.cumsum(value_counts)[:-1]])
            table = _table(systems[0], rows, starts, values)
            end = wp.array(item_ends, dtype=wp.int32, device=device)
        u = displacements[0] if len(displacements) == 1 else np.concatenate(displacements)
        return cls(
            table,
            end,
            systems[0]._rule,
            wp.array(u, dtype=wp.vec3d, device=device),
            item_ends,
            node_ends,
            device,
        )

    @property
    def item_count(self) -> int:
        return int(self.item_ends[-1])

    def launch(self, kernel: wp.Kernel, outputs: list[wp.array]) -> None:
        """Run a kernel over every item."""
        inputs = [self.rows, self.end, self.rule, self.u]
        wp.launch(kernel, dim=self.item_count, inputs=inputs, outputs=outputs, device=self.device)

    def apart(self, kernel: wp.Kernel, width: int = 1) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Run a kernel of energies; each system's energies (items,) J, its items' (items, width), forces (N, 3) N."""
        energy = wp.empty(self.item_count, dtype=wp.float64, device=self.device)
        other = wp.empty((self.item_count, width), dtype=wp.float64, device=self.device)
        force = wp.zeros(len(self.u), dtype=wp.vec3d, device=self.device)
        self.launch(kernel, [energy, other, force])
        items, nodes = self.item_ends, self.node_ends
        return zip(_host(energy, items), _host(other, items), _host(force, nodes), strict=True)


def batches(sizes: Sequence[int], largest: int = LARGEST) -> Iterator[slice]:
    """Neighbours whose sizes add up to at most `largest`; a larger one stands alone."""
    begin, total = 0, 0
    for k, size in enumerate(sizes):
        if k > begin and total + size > largest:
            yield slice(begin, k)
            begin, total = k, 0
        total += size
    if len(sizes):
        yield slice(begin, len(sizes))


def _row_of(resident: Any) -> np.ndarray:
    """(1,) of a Warp struct's NumPy type; pointers only, so the struct has to be kept."""
    return np.array([resident.numpy_value()], dtype=resident.numpy_dtype())


def _host(array: wp.array, ends: Sequence[int]) -> list[np.ndarray]:
    """Each system's own rows of a result, in arrays that share nothing."""
    if array.device.is_cpu and len(ends) == 1:
        return [array.numpy()]  # keeps the Warp array alive
    found = array.numpy() if array.device.is_cpu else _download(array)
    return [part.copy() for part in np.split(found, list(ends[:-1]))]


_pinned = threading.local()
"""Page-locked memory of each thread that downloads: the copy into it is faster than into any other; locking is slow."""


def _download(array: wp.array) -> np.ndarray:
    """The array's numbers, in memory that this thread's next download overwrites."""
    flat = array.flatten()
    kept = vars(_pinned).setdefault("by_type", {})
    if flat.dtype not in kept or kept[flat.dtype].size < flat.size:
        kept[flat.dtype] = wp.empty(2 * flat.size, dtype=flat.dtype, device="cpu", pinned=True)
    wp.copy(kept[flat.dtype], flat, count=flat.size)
    wp.synchronize_device(array.device)
    found = kept[flat.dtype].numpy()[: flat.size]
    return found.reshape(array.shape + found.shape[1:])
