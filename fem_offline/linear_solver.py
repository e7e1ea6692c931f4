# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Sparse Cholesky factors of symmetric matrices given by their upper triangle.

Pardiso (oneMKL, through the pypardiso wheel) where it is installed, SciPy's SuperLU elsewhere: the same answers,
about twenty times slower.  Pardiso also returns the Schur complement of chosen unknowns as part of one
factorisation (its `iparm(36) = 1`), which is what condenses the far field.
"""

from __future__ import annotations

import ctypes
import sys
from functools import cache

import numpy as np
from scipy import sparse
from scipy.sparse import linalg

__all__ = ["Factor", "NotPositiveDefiniteError", "pardiso_available", "schur_complement"]

SYMMETRIC_POSITIVE_DEFINITE = 2
ANALYSE, FACTORISE, SOLVE, RELEASE = 11, 22, 33, -1
NOT_POSITIVE_DEFINITE = -4


class NotPositiveDefiniteError(ArithmeticError):
    """The matrix has a pivot that is not positive."""


@cache
def _pardiso():
    try:
        import pypardiso
    except ImportError:
        return None
    try:
        return pypardiso.PyPardisoSolver().libmkl.pardiso
    except (ImportError, OSError):
        return None


def pardiso_available() -> bool:
    """Whether oneMKL's Pardiso can be loaded."""
    return _pardiso() is not None


def _integer(value: int):
    return ctypes.byref(ctypes.c_int32(value))


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return array.ctypes.data_as(ctypes.c_void_p)


class _Pardiso:
    """One Pardiso handle: a fixed pattern, analysed once, factorised as often as values change."""

    def __init__(
        self,
        row_start: np.ndarray,
        column: np.ndarray,
        schur: np.ndarray | None = None,
        dtype: type = np.float64,
    ) -> None:
        self.n = len(row_start) - 1
        self.row_start = np.ascontiguousarray(row_start, np.int32)
        self.column = np.ascontiguousarray(column, np.int32)
        self.handle = np.zeros(64, np.int64)
        self.iparm = np.zeros(64, np.int32)
        self.iparm[0] = 1  # own settings
        self.iparm[1] = 2  # nested dissection (METIS)
        self.iparm[34] = 1  # zero-based indices
        self.perm = np.zeros(self.n, np.int32)
        if schur is not None:
            self.iparm[35] = 1
            self.perm[schur] = 1
        self.iparm[27] = dtype is np.float32
        self.dtype = dtype
        self.values: np.ndarray = np.zeros(len(column), dtype)
        self._nothing = np.zeros(1, dtype)
        self._routine = _pardiso()  # kept, because __del__ may run when modules are already gone

    def call(self, phase: int, b: np.ndarray | None = None, x: np.ndarray | None = None) -> None:
        count = 1 if b is None or b.ndim == 1 else b.shape[1]
        error = ctypes.c_int32(0)
        self._routine(
            self.handle.ctypes.data_as(ctypes.POINTER(ctypes.c_int64)),
            _integer(1),
            _integer(1),
            _integer(SYMMETRIC_POSITIVE_DEFINITE),
            _integer(phase),
            _integer(self.n),
            _pointer(self.values),
            self.row_start.ctypes.data_as(ctypes.POINTER(ctypes.c_int32)),
            self.column.ctypes.data_as(ctypes.POINTER(ctypes.c_int32)),
            self.perm.ctypes.data_as(ctypes.POINTER(ctypes.c_int32)),
            _integer(count),
            self.iparm.ctypes.data_as(ctypes.POINTER(ctypes.c_int32)),
            _integer(0),
            _pointer(self._nothing if b is None else b),
            _pointer(self._nothing if x is None else x),
            ctypes.byref(error),
        )
        if error.value == NOT_POSITIVE_DEFINITE:
            raise NotPositiveDefiniteError("a pivot of the matrix is not positive")
        if error.value != 0:
            raise ArithmeticError(f"Pardiso failed in phase {phase} with error {error.value}")

    def __del__(self) -> None:
        if self.handle.any() and not sys.is_finalizing():
            self.call(RELEASE)


class Factor:
    """Cholesky factor of a matrix whose pattern stays while its values change.

    Args:
        row_start, column: upper triangle in compressed rows, diagonal present, columns rising.
        single: factor and solve in single precision, good enough to precondition (Pardiso only).
    """

    def __init__(self, row_start: np.ndarray, column: np.ndarray, single: bool = False) -> None:
        self.row_start, self.column = row_start, column
        self.n = len(row_start) - 1
        self._dtype = np.float32 if single else np.float64
        self._direct = _Pardiso(row_start, column, dtype=self._dtype) if pardiso_available() else None
        self._analysed = False
        self.ready = False  # whether the last factorisation succeeded
        self._lu: linalg.SuperLU | None = None

    def factorise(self, values: np.ndarray) -> None:
        """Factorise with new values (nnz,).

        Raises:
            NotPositiveDefiniteError: a pivot is not positive.
        """
        self.ready = False
        if self._direct is None:
            upper = sparse.csr_matrix((values, self.column, self.row_start), shape=(self.n, self.n))
            full = upper + sparse.triu(upper, 1).T
            symmetric = {"SymmetricMode": True}
            try:
                lu = linalg.splu(full.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
            except RuntimeError as error:  # an exactly singular matrix
                raise NotPositiveDefiniteError("a pivot of the matrix is not positive") from error
            if np.any(lu.U.diagonal() <= 0.0):
                raise NotPositiveDefiniteError("a pivot of the matrix is not positive")
            self._lu = lu
            self.ready = True
            return
        self._direct.values = np.ascontiguousarray(values, self._dtype)
        if not self._analysed:
            self._direct.call(ANALYSE)
            self._analysed = True
        self._direct.call(FACTORISE)
        self.ready = True

    def solve(self, b: np.ndarray) -> np.ndarray:
        """Solve for one (n,) or several (n, k) right-hand sides."""
        if self._direct is None:
            assert self._lu is not None, "factorise first"
            return self._lu.solve(np.asarray(b, float))
        b = np.asfortranarray(b, self._dtype)
        x = np.zeros_like(b, order="F")
        self._direct.call(SOLVE, b, x)
        return x.astype(float, copy=False)


def schur_complement(matrix: sparse.csr_matrix, kept: np.ndarray) -> np.ndarray:
    """S = K_kk - K_ke K_ee^-1 K_ek of a symmetric positive definite matrix, kept unknowns k, eliminated e.

    Args:
        matrix: upper triangle, diagonal present, sorted columns.
        kept: (s,) rising indices of the kept unknowns.

    Returns:
        (s, s), symmetric.
    """
    n = matrix.shape[0]
    if pardiso_available():
        solver = _Pardiso(matrix.indptr, matrix.indices, kept)
        solver.values = np.ascontiguousarray(matrix.data, float)
        schur = np.zeros((len(kept), len(kept)), order="F")
        solver.call(ANALYSE)
        solver.call(FACTORISE, np.zeros(n), schur)
        return 0.5 * (schur + schur.T)
    full = (matrix + sparse.triu(matrix, 1).T).tocsc()
    eliminated = np.setdiff1d(np.arange(n), kept)
    lu = linalg.splu(full[eliminated][:, eliminated], permc_spec="MMD_AT_PLUS_A")
    coupling = full[eliminated][:, kept].toarray()
    schur = full[kept][:, kept].toarray() - coupling.T @ lu.solve(coupling)
    return 0.5 * (schur + schur.T)
