# SPDX-FileCopyrightText: 2026 The palpate authors
# SPDX-License-Identifier: Apache-2.0
"""What is published of haptic devices, and the damping that follows from it.

CHAI3D (3.3, src/devices/CDeltaDevices.cpp and CPhantomDevices.cpp, read 2026) gives each device the largest force and
the largest stiffness that its examples may render.  Makers publish no damping.  If that stiffness sigma is steady in a
loop of T = 1 ms, the device takes the energy that holding it gives, so by the bound of certify.py

    B = sigma T / 2

is an estimate of its damping, dry friction and the hand's share included.  CHAI3D does not say at what rate its limits
hold; at a faster one B would be smaller.  A damping that was measured is better.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["PROFILES", "DeviceProfile", "profile_named"]

PERIOD = 1e-3
"""s, of the loop in which CHAI3D's limits are taken to be steady."""


@dataclass(frozen=True)
class DeviceProfile:
    """Attributes: name; max_force N; stiffness_max N/m, at 1 kHz."""

    name: str
    max_force: float
    stiffness_max: float

    @property
    def damping(self) -> float:
        """N s/m; what the largest stiffness asks of the device."""
        return 0.5 * self.stiffness_max * PERIOD

    @property
    def source(self) -> str:
        """How the damping was found, as a clause."""
        return (
            f"{self.damping:.3g} N s/m of damping, hand and friction included: an estimate, as if the "
            f"{self.stiffness_max:g} N/m that CHAI3D allows {self.name} were steady at 1 kHz"
        )


PROFILES = (
    DeviceProfile("omega.3", 12.0, 5000.0),
    DeviceProfile("omega.6", 12.0, 5000.0),
    DeviceProfile("omega.7", 12.0, 5000.0),
    DeviceProfile("delta.3", 20.0, 5000.0),
    DeviceProfile("delta.6", 20.0, 5000.0),
    DeviceProfile("sigma.6+", 12.0, 4000.0),
    DeviceProfile("sigma.7", 12.0, 4000.0),
    DeviceProfile("Falcon", 8.0, 3000.0),
    DeviceProfile("Touch", 3.3, 400.0),
    DeviceProfile("PHANTOM Omni", 3.3, 700.0),
    DeviceProfile("PHANTOM Desktop", 7.9, 1000.0),
    DeviceProfile("PHANTOM Premium 1.5 6DOF", 8.5, 800.0),
    DeviceProfile("PHANTOM Premium 3.0 6DOF", 22.0, 1000.0),
)


def profile_named(name: str) -> DeviceProfile | None:
    """The profile of that name, whatever its capitals and spaces; None where there is none."""
    plain = {_plain(profile.name): profile for profile in PROFILES}
    return plain.get(_plain(name))


def _plain(name: str) -> str:
    return "".join(name.lower().split())
