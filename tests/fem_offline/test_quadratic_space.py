# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

from palpate.fem_offline.block import block
from palpate.fem_offline.contact import SIX_POINT_RULE, SIX_POINT_WEIGHTS
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.quadratic_space import (
    CENTRE_RULE,
    EDGES,
    FOUR_POINT_RULE,
    face_shape,
    quadratic_space,
    shape_gradients_barycentric,
)

TET = np.array([[0.1, 0.0, 0.0], [1.2, 0.1, 0.0], [0.2, 0.9, 0.1], [0.0, 0.2, 1.1]])


def gradients_at(space, points):
    """(Q, 10, 3) grad N_a of the first element."""
    return shape_gradients_barycentric(points) @ space.corner_gradients[0]


def test_quadratic_functions_have_exact_gradients():
    """f = c + g.x + x.Q.x: sum_a f(x_a) grad N_a = g + (Q + Q^T) x."""
    space = quadratic_space(TET, np.array([[0, 1, 2, 3]]))
    random = np.random.default_rng(0)
    g, Q = random.standard_normal(3), random.standard_normal((3, 3))
    L = random.dirichlet(np.ones(4), 7)
    values = 0.3 + space.nodes @ g + np.einsum("ni,ij,nj->n", space.nodes, Q, space.nodes)
    at_nodes = values[space.elements[0]]
    x = L @ TET
    assert np.einsum("a,qai->qi", at_nodes, gradients_at(space, L)) == pytest.approx(
        g + x @ (Q + Q.T), abs=1e-12
    )


def test_mid_edge_nodes_follow_the_documented_order():
    space = quadratic_space(TET, np.array([[0, 1, 2, 3]]))
    assert space.nodes[space.elements[0, 4:]] == pytest.approx(TET[EDGES].mean(axis=1), abs=1e-15)
    assert space.nodes[:4] == pytest.approx(TET)


def moment(points, weights, powers):
    return float(weights @ np.prod(points ** np.asarray(powers), axis=1))


def exact_moment(powers):
    """Mean of L1^a L2^b ... over a simplex: n! a! b! ... / (n + a + b + ...)!"""
    from math import factorial, prod

    n = len(powers) - 1
    return factorial(n) * prod(factorial(p) for p in powers) / factorial(n + sum(powers))


def test_rules_are_exact_to_their_degree():
    from itertools import product

    for powers in product(range(3), repeat=4):
        exact = exact_moment(powers)
        if sum(powers) <= 2:
            assert moment(FOUR_POINT_RULE, np.full(4, 0.25), powers) == pytest.approx(exact, rel=1e-13)
        if sum(powers) <= 1:
            assert moment(CENTRE_RULE, np.ones(1), powers) == pytest.approx(exact, rel=1e-13)
    for powers in product(range(5), repeat=3):
        if sum(powers) <= 4:
            exact = exact_moment(powers)
            assert moment(SIX_POINT_RULE, SIX_POINT_WEIGHTS, powers) == pytest.approx(exact, rel=1e-12)


def test_face_functions_are_one_at_their_node():
    at = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]])
    assert face_shape(at) == pytest.approx(np.eye(6), abs=1e-15)


def test_face_nodes_lie_on_their_faces():
    mesh = block((1.0, 1.0, 1.0), (2, 2, 2))
    space = quadratic_space(mesh.points, mesh.tets)
    faces = boundary_faces(mesh.tets)
    x = space.nodes[space.face_nodes(faces)]
    assert x[:, 3:] == pytest.approx(0.5 * (x[:, [0, 1, 0]] + x[:, [1, 2, 2]]), abs=1e-15)
    with pytest.raises(KeyError):
        space.face_nodes(np.array([[0, 13, 26]]))


def test_volumes_add_up_and_inverted_tetrahedra_are_refused():
    mesh = block((0.3, 0.2, 0.1), (3, 2, 2))
    assert quadratic_space(mesh.points, mesh.tets).volumes.sum() == pytest.approx(0.3 * 0.2 * 0.1, rel=1e-12)
    with pytest.raises(ValueError, match="tetrahedron 0"):
        quadratic_space(TET, np.array([[1, 0, 2, 3]]))
