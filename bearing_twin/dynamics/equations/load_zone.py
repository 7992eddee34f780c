# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Contact forces around the rings at a given displacement of the inner ring."""

from __future__ import annotations

from typing import Any

from bearing_twin.dynamics.equations.model import Contact, contact_law
from bearing_twin.numerics.compiled import compiled
import numpy as np
from numpy.typing import NDArray


def contact_forces(
    angles: NDArray[np.floating[Any]],
    x: float | NDArray[np.float64],
    y: float | NDArray[np.float64],
    clearance: float | NDArray[np.float64],
    stiffness: float | NDArray[np.float64],
) -> NDArray[np.float64]:
    """
    Return the Hertz contact force in N of balls at given angles; all arrays broadcast.

    Parameters
    ----------
    angles
        Positions from +x, rad.
    x, y
        Displacement of the inner ring against the outer ring, m.
    clearance
        Half the radial internal clearance, m.
    stiffness
        K_b of the contact law, N/m^1.5.

    Notes
    -----
    Zhang et al., Symmetry 2023, 15, 2166, equation of the contact deformation, without the
    defect's depth.

    Examples
    --------
    >>> contact_forces(np.array([0.0, np.pi]), 5e-6, 0.0, 1e-6, 1e10).round(3).tolist()
    [80.0, 0.0]

    """
    deformation = x * np.cos(angles) + y * np.sin(angles) - clearance
    delta, stiff = np.broadcast_arrays(deformation, stiffness)
    force = np.empty(delta.shape)
    _force(delta.ravel(), stiff.ravel(), force.reshape(-1))
    return force


@compiled()
def _force(
    delta: NDArray[np.float64], stiffness: NDArray[np.float64], force: NDArray[np.float64]
) -> None:
    for k in range(delta.size):
        force[k] = contact_law(max(delta[k], 0.0), Contact(stiffness[k], 0.0))[0]
