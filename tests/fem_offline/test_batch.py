# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""Many systems in one launch, many presses in one process: nobody's answer depends on who asks beside it."""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
import warp as wp

from palpate.fem_offline import assembly, membrane
from palpate.fem_offline.assembly import ElementSystem
from palpate.fem_offline.batch import Batch, current_device, together
from palpate.fem_offline.block import block
from palpate.fem_offline.hessian_pattern import hessian_pattern
from palpate.fem_offline.linear_solver import Factor
from palpate.fem_offline.material import NeoHookean, Ogden
from palpate.fem_offline.membrane import Capsule, Membrane
from palpate.fem_offline.organ import boundary_faces
from palpate.fem_offline.patch import PatchSize, carve, refine
from palpate.fem_offline.press import press
from palpate.fem_offline.quadratic_space import quadratic_space
from palpate.fem_offline.side_by_side import batches
from palpate.fem_offline.site import open_site, patch_size
from palpate.fem_offline.tool import Sphere
from palpate.fem_offline.verification.blocks import block_organ

SOFT, STIFF = NeoHookean(5400.0, 0.48), Ogden((900.0, 300.0), (4.0, -2.0), 0.48)
LOCKSTEP = 20.0  # s; a launch then waits for every member
STEP = 2.0  # s; long enough for a Newton step of every member
TOOL = Sphere(5e-3)
DEPTHS = np.array([1.6e-3])
PLACES = np.array([[0.0, 0.0, 0.0], [3e-3, 1e-3, 0.0]])


def space_of(divisions):
    mesh = block((0.02, 0.02, 0.01), divisions)
    return quadratic_space(mesh.points, mesh.tets)


def pattern_of(space):
    return hessian_pattern(space.elements, np.zeros(3 * space.node_count, bool), [])


def moved(space, seed):
    return 5e-5 * np.random.default_rng(seed).standard_normal(space.nodes.shape)


def in_lockstep(batch, tasks):
    """Results of functions, each run by a member of the batch."""
    begin = threading.Barrier(len(tasks))

    def run(task):
        with batch.member():
            begin.wait()
            return task()

    with ThreadPoolExecutor(len(tasks)) as threads:
        return list(threads.map(run, tasks))


def skin_of(space):
    faces = space.face_nodes(boundary_faces(space.elements[:, :4]))
    return Membrane(space.nodes, faces, Capsule(1e-4, STIFF))


def evaluated(make, space, seed):
    system, pattern = make(space), pattern_of(space)
    state, u = system.state(moved(space, seed)), moved(space, seed)
    return state.energy, state.force, system.hessian(u, pattern)


MAKERS = {
    "one material": lambda space: ElementSystem(space, [SOFT], np.ones((len(space.elements), 1))),
    "two materials": lambda space: ElementSystem(
        space, [SOFT, STIFF], np.tile([0.25, 0.75], (len(space.elements), 1))
    ),
    "capsule": skin_of,
}


@pytest.mark.parametrize("name", MAKERS)
def test_systems_of_other_sizes_beside_one_change_no_bit_of_it(name):
    spaces = [space_of(n) for n in ((2, 2, 1), (4, 3, 2), (3, 3, 3))]
    make = MAKERS[name]
    alone = [evaluated(make, space, k) for k, space in enumerate(spaces)]
    tasks = [lambda k=k, space=space: evaluated(make, space, k) for k, space in enumerate(spaces)]
    with Batch(gather=LOCKSTEP) as batch:
        beside = in_lockstep(batch, tasks)
    for one, other in zip(alone, beside, strict=True):
        assert one[0] == other[0] > 0.0
        assert np.array_equal(one[1], other[1]) and np.array_equal(one[2], other[2])
    assert (batch.launches, batch.requests) == (
        3,
        9,
    )  # arrays placed, states, Hessians: of three systems each


def test_materials_may_differ_within_a_launch():
    space = space_of((3, 3, 2))
    with Batch(gather=LOCKSTEP) as batch:
        names = ("one material", "two materials")
        beside = in_lockstep(batch, [lambda n=n: evaluated(MAKERS[n], space, 0) for n in names])
    assert batch.launches == 3
    for name, found in zip(names, beside, strict=True):
        assert np.array_equal(found[2], evaluated(MAKERS[name], space, 0)[2])


def test_an_inverted_system_does_not_spoil_its_neighbours():
    space = space_of((2, 2, 1))

    def energy(u):
        return MAKERS["one material"](space).state(u).energy

    turned_inside_out = -2.0 * space.nodes
    with Batch(gather=LOCKSTEP) as batch:
        inverted, sound = in_lockstep(
            batch, [lambda: energy(turned_inside_out), lambda: energy(moved(space, 1))]
        )
    assert inverted == np.inf and sound == energy(moved(space, 1))


def test_who_asks_for_nonsense_hears_of_it_alone():
    space = space_of((2, 2, 1))

    def force(u):
        try:
            return MAKERS["one material"](space).state(u).force
        except ValueError as error:
            return str(error)

    with Batch(gather=LOCKSTEP) as batch:
        refused, answered = in_lockstep(
            batch, [lambda: force(np.zeros((3, 3))), lambda: force(moved(space, 1))]
        )
    assert refused == f"u has shape (3, 3); expected {(space.node_count, 3)}"
    assert np.array_equal(answered, force(moved(space, 1)))


def test_what_waits_while_a_launch_runs_goes_into_the_next():
    running, go_on = threading.Event(), threading.Event()
    sizes = []

    def launch(arguments):
        sizes.append(len(arguments))
        running.set()
        assert go_on.wait(LOCKSTEP)
        return [2 * x for x in arguments]

    def asked(batch, x):
        with batch.member():
            return together(launch, x)

    with Batch() as batch, ThreadPoolExecutor(4) as threads:
        first = threads.submit(asked, batch, 1)
        assert running.wait(LOCKSTEP)
        rest = [threads.submit(asked, batch, x) for x in (2, 3, 4)]
        while len(batch._waiting) < len(rest):
            threading.Event().wait(1e-3)
        go_on.set()
        assert [f.result() for f in (first, *rest)] == [2, 4, 6, 8]
    assert sizes == [1, 3]


def test_a_member_that_leaves_keeps_nobody_waiting():
    left = threading.Event()

    def asks(batch):
        with batch.member():
            return together(lambda arguments: arguments, 7)

    def leaves(batch):
        with batch.member():
            left.wait(LOCKSTEP)

    with Batch(gather=1e6) as batch, ThreadPoolExecutor(2) as threads:
        leaving = threads.submit(leaves, batch)
        asking = threads.submit(asks, batch)
        left.set()
        assert asking.result(timeout=LOCKSTEP) == 7
        leaving.result()


def test_outside_a_batch_things_run_here_and_a_closed_one_says_so():
    assert current_device() == "cpu"
    assert together(lambda arguments: [threading.get_ident()], None) == threading.get_ident()
    batch = Batch()
    batch.close()
    with batch.member(), pytest.raises(RuntimeError, match="the batch is closed"):
        together(lambda arguments: arguments, None)


def test_a_device_that_is_not_there_is_named():
    with pytest.raises(ValueError, match="no device 'cuda:99'; it has cpu"):
        Batch("cuda:99")


def test_launches_hold_no_more_than_places_can_count():
    assert [range(5)[part] for part in batches([4, 5, 3, 20, 1], largest=10)] == [
        range(0, 2),
        range(2, 3),
        range(3, 4),
        range(4, 5),
    ]
    assert list(batches([])) == []


@pytest.fixture(scope="module")
def organ():
    return replace(block_organ((0.05, 0.05, 0.02), (5, 5, 2), {0: SOFT}), capsule=Capsule(1e-4, STIFF))


def pressed(organ, place):
    site = open_site(organ, place, TOOL, patch_size(TOOL, DEPTHS[-1], radius=8e-3, refinement=0.5))
    return press(site, TOOL, DEPTHS)


def test_presses_side_by_side_find_what_they_find_alone(organ):
    """Carving, mmg, condensing, contact, factors, in threads of one process; as far as the residual (1e-9) says."""
    with Batch(gather=STEP) as batch:
        beside = in_lockstep(batch, [lambda place=place: pressed(organ, place) for place in PLACES])
    asked = []
    for place, found in zip(PLACES, beside, strict=True):
        with Batch() as own, own.member():
            alone = pressed(organ, place)
        asked.append(own.requests)
        assert alone.converged and found.converged
        assert found.newton_steps == alone.newton_steps and found.unknowns == alone.unknowns
        for name in ("force_vector", "energy", "area", "sticking_stiffness"):
            scale = np.abs(getattr(alone, name)).max()
            assert getattr(found, name) == pytest.approx(getattr(alone, name), rel=0.0, abs=1e-8 * scale), (
                name
            )
    # they ask for different things at times (a state, a Hessian), which then wait for one another
    assert max(asked) <= batch.launches < 0.75 * sum(asked)


def test_patches_refined_in_threads_are_those_refined_alone(organ):
    """mmg keeps which metric it works with in global variables, the same for every patch."""

    def refined(place):
        size = PatchSize(9e-3, 1.5e-3, 2e-3, 0.5, 8e-3, extent=3e-3)
        return refine(organ, carve(organ, place, size.radius), place, size, passes=2)

    with ThreadPoolExecutor(len(PLACES)) as threads:
        beside = list(threads.map(refined, PLACES))
    for place, patch in zip(PLACES, beside, strict=True):
        alone = refined(place)
        assert np.array_equal(patch.points, alone.points) and np.array_equal(patch.tets, alone.tets)


def test_factors_in_threads_share_nothing():
    rng = np.random.default_rng(5)
    problems = []
    for n in (200, 300, 400, 500):
        i, j = np.triu_indices(n)
        near = j - i < 12
        i, j = i[near], j[near]
        values = np.where(i == j, 30.0, rng.uniform(-1.0, 1.0, len(i)))
        row_start = np.searchsorted(i, np.arange(n + 1)).astype(np.int32)
        problems.append((row_start, j.astype(np.int32), values, rng.standard_normal(n)))

    def solved(problem):
        row_start, column, values, b = problem
        factor = Factor(row_start, column)
        found = []
        for scale in (1.0, 2.0, 3.0):
            factor.factorise(scale * values)
            found.append(factor.solve(b))
        return np.array(found)

    with ThreadPoolExecutor(len(problems)) as threads:
        beside = list(threads.map(solved, problems))
    for problem, found in zip(problems, beside, strict=True):
        assert np.array_equal(found, solved(problem))


@pytest.mark.slow
def test_kernels_compile_for_a_gpu_where_there_is_none(tmp_path):
    """To PTX, which every later card takes."""
    for module in (assembly, membrane):
        wp.compile_aot_module(module, arch=[80], module_dir=tmp_path, use_ptx=True)
    kernels = "".join(path.read_text() for path in tmp_path.glob("*.ptx"))
    assert kernels.count(".entry energy_and_force") == 2 and kernels.count(".entry hessian") == 2
