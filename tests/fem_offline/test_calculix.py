# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""CalculiX as a reference: its answers are read rightly, its material and its wedge are ours."""

import shutil

import numpy as np
import pytest

from palpate.fem_offline.material import NeoHookean
from palpate.fem_offline.verification import calculix, homogeneous
from palpate.fem_offline.verification.calculix import (
    CalculixError,
    CalculixMissingError,
    run_calculix,
    total_forces,
)
from palpate.fem_offline.verification.calculix_layer import WEDGES

needs_calculix = pytest.mark.skipif(shutil.which("ccx") is None, reason="needs ccx (Debian: calculix-ccx)")

CYLINDER = """*NODE, NSET=ALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0.5, 0., 0.
6, 1., 0.5, 0.
7, 0.5, 1., 0.
8, 0., 0.5, 0.
*ELEMENT, TYPE=CAX8R, ELSET=BODY
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=BASE
1, 2, 5
*NSET, NSET=TOP
3, 4, 7
*NSET, NSET=AXIS
1, 4, 8
*MATERIAL, NAME=TISSUE
*HYPERELASTIC, NEO HOOKE
{c10:.12g}, {d1:.12g}
*SOLID SECTION, ELSET=BODY, MATERIAL=TISSUE
*BOUNDARY
BASE, 2, 2, 0.
AXIS, 1, 1, 0.
*STEP, NLGEOM
*STATIC
0.5, 1.
*BOUNDARY
TOP, 2, 2, {top:.12g}
*NODE PRINT, NSET=BASE, TOTALS=ONLY, FREQUENCY=1000
RF
*END STEP
"""


@needs_calculix
@pytest.mark.parametrize("stretch", [0.7, 1.3])
def test_its_neo_hookean_cylinder_is_the_closed_form(stretch):
    material = NeoHookean(1.0, 0.48)
    mu, kappa = material.shear_modulus, material.bulk_modulus
    dat = run_calculix(CYLINDER.format(c10=0.5 * mu, d1=2.0 / kappa, top=stretch - 1.0))
    axial = homogeneous.uniaxial(material, stretch).P[0, 0]  # over the area at rest
    # the wedge's area is that of its prism, 2 sin(1 deg) and not 2 deg in pi / 90: 5e-5 less
    assert WEDGES * total_forces(dat, "BASE")[0, 1] == pytest.approx(-np.pi * axial, rel=2e-4)


@needs_calculix
def test_a_deck_that_cannot_be_solved_is_an_error_with_calculixs_last_words():
    with pytest.raises(CalculixError, match="CalculiX ended with"):
        run_calculix("*NODE\n1, 0., 0., 0.\n*STEP\n*STATIC\n*END STEP\n*NONSENSE\n")


def test_a_machine_without_it_says_what_to_install(monkeypatch):
    monkeypatch.setattr(calculix.shutil, "which", lambda name: None)
    with pytest.raises(CalculixMissingError, match="calculix-ccx"):
        run_calculix("")


def test_total_forces_of_one_set_are_read_in_order():
    dat = """
 total force (fx,fy,fz) for set BASE and time  0.1000000E+01

       -9.271345E-03  8.256780E-03 -3.644995E-18

 total force (fx,fy,fz) for set TOOL and time  0.1000000E+01

        1.711599E-03 -8.256780E-03  2.604754E-14

 total force (fx,fy,fz) for set BASE and time  0.2000000E+01

       -2.728803E-02  2.433359E-02 -4.886957E-18
"""
    assert total_forces(dat, "base")[:, 1] == pytest.approx([8.256780e-3, 2.433359e-2])
    assert total_forces(dat, "lid").shape == (0, 3)
