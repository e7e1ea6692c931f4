# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest
import warp as wp

from palpate.fem_offline.principal_frame import principal_frame
from palpate.fem_offline.warp_session import start_warp

wp.set_module_options({"enable_backward": False, "max_unroll": 1})


@wp.kernel
def _frames(G: wp.array(dtype=wp.mat33d), values: wp.array(dtype=wp.vec3d), axes: wp.array(dtype=wp.mat33d)):
    i = wp.tid()
    frame = principal_frame(G[i])
    values[i] = frame.values
    axes[i] = frame.axes


def frames(G):
    start_warp()
    out = [wp.zeros(len(G), dtype=kind, device="cpu") for kind in (wp.vec3d, wp.mat33d)]
    wp.launch(
        _frames, dim=len(G), inputs=[wp.array(G, dtype=wp.mat33d, device="cpu")], outputs=out, device="cpu"
    )
    return [array.numpy() for array in out]


@pytest.fixture(scope="module")
def matrices():
    """Random ones, gaps from none to 1, sizes from 1e-12 to 1e8, diagonal ones, and zero."""
    random = np.random.default_rng(0)
    Q, _ = np.linalg.qr(random.standard_normal((400, 3, 3)))
    gap = 10.0 ** random.uniform(-18.0, 0.0, (400, 2))
    gap[:100] = 0.0
    values = np.stack([np.ones(400), 1.0 + gap[:, 0], 1.0 + gap[:, 0] + gap[:, 1]], axis=1)
    values[::2] -= 1.0  # strains: differences of their own size
    size = 10.0 ** random.uniform(-12.0, 8.0, 400)
    G = np.einsum("nij,nj,nkj->nik", Q, values * size[:, None], Q)
    G = np.concatenate([0.5 * (G + G.swapaxes(1, 2)), np.zeros((1, 3, 3)), np.diag([3.0, -1.0, 2.0])[None]])
    return G


def test_eigenvalues_are_lapacks(matrices):
    values, _ = frames(matrices)
    expected = np.linalg.eigvalsh(matrices)
    norm = np.linalg.norm(matrices, axis=(1, 2))[:, None] + 1e-300
    assert np.abs((np.sort(values, axis=1) - expected) / norm).max() < 3e-15


def test_axes_are_orthonormal_and_rebuild_the_matrix(matrices):
    values, axes = frames(matrices)
    assert np.abs(axes.swapaxes(1, 2) @ axes - np.eye(3)).max() < 3e-15
    norm = np.linalg.norm(matrices, axis=(1, 2))[:, None, None] + 1e-300
    rebuilt = np.einsum("nij,nj,nkj->nik", axes, values, axes)
    assert np.abs((rebuilt - matrices) / norm).max() < 3e-15
