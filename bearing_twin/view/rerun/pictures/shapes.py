# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Solids of revolution that make up a drawn bearing; lengths in mm, the shaft's axis is z."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
import rerun as rr

if TYPE_CHECKING:
    from bearing_twin.bearing.geometry import Bearing
    from bearing_twin.view.style import Colour


TURN = 96
"""Facets of a turn."""
MILLI = 1e3
# The geometry has only balls and pitch circle. The other proportions are those of a deep-groove
# bearing of the 63 series and serve the picture only.
RING = 0.33
SHOULDER = 0.27
WIDTH = 1.5
CONFORMITY = 0.52
CUT = 0.08


def outer_radius(bearing: Bearing) -> float:
    """Return the outer radius of the outer ring, mm."""
    return MILLI * (0.5 * bearing.d_pitch + (0.5 + RING) * bearing.d_ball)


def inner_radius(bearing: Bearing) -> float:
    """Return the radius of the bore, mm."""
    return MILLI * max(
        0.5 * bearing.d_pitch - (0.5 + RING) * bearing.d_ball, 0.15 * bearing.d_pitch
    )


def face(bearing: Bearing) -> float:
    """Return the z of the plane at which the rings are cut open, mm."""
    return MILLI * CUT * bearing.d_ball


def width(bearing: Bearing) -> float:
    """Return the width of the rings, mm."""
    return MILLI * WIDTH * bearing.d_ball


def outer_ring(bearing: Bearing, colour: Colour) -> rr.Mesh3D:
    """Return the outer ring with its groove."""
    return lathe(_ring(bearing, outer_radius(bearing), 1.0), colour)


def inner_ring(bearing: Bearing, colour: Colour) -> rr.Mesh3D:
    """Return the inner ring with its groove."""
    return lathe(_ring(bearing, inner_radius(bearing), -1.0), colour)


def cage(bearing: Bearing, colour: Colour) -> list[rr.Mesh3D]:
    """Return the two rims of the cage, one on each side of the balls."""
    pitch, ball = 0.5 * MILLI * bearing.d_pitch, MILLI * bearing.d_ball
    rim = np.array([[-0.06, 0.50], [0.06, 0.50], [0.06, 0.56], [-0.06, 0.56]])
    rims = [rim, np.flipud(rim * [1.0, -1.0])]
    return [lathe([pitch, 0.0] + ball * profile, colour) for profile in rims]


def lathe(profile: NDArray[np.float64], colour: Colour) -> rr.Mesh3D:
    """
    Return the body of a closed profile of (radius, z), shape (n, 2), turned about z.

    The profile runs counter-clockwise in the (radius, z) plane; each of its sides is a facet with
    a normal of its own.
    """
    ends = np.roll(profile, -1, axis=0)
    side = ends - profile
    normal = np.stack([side[:, 1], -side[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    angles = np.linspace(0.0, 2.0 * np.pi, TURN + 1)
    turn = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    corners, out = np.stack([profile, ends], axis=1).reshape(-1, 2), np.repeat(normal, 2, axis=0)
    points = np.dstack([corners[:, :1, None] * turn, np.tile(corners[:, 1:, None], (TURN + 1, 1))])
    normals = np.dstack([out[:, :1, None] * turn, np.tile(out[:, 1:, None], (TURN + 1, 1))])
    first = 2 * (TURN + 1) * np.arange(len(profile))
    a = (first[:, None] + np.arange(TURN)).ravel()
    b = a + TURN + 1
    triangles = np.concatenate([np.stack([a, a + 1, b], 1), np.stack([a + 1, b + 1, b], 1)])
    return rr.Mesh3D(
        vertex_positions=points.reshape(-1, 3),
        vertex_normals=normals.reshape(-1, 3),
        triangle_indices=triangles,
        albedo_factor=colour,
    )


def _ring(bearing: Bearing, far: float, sign: float) -> NDArray[np.float64]:
    """
    Return the profile of a ring with a groove; sign 1 outer ring, -1 inner ring.

    The front is cut off at :func:`face`, so that the balls can be seen in their groove.
    """
    ball, pitch = MILLI * bearing.d_ball, 0.5 * MILLI * bearing.d_pitch
    back, front = -0.5 * width(bearing), face(bearing)
    radius = CONFORMITY * ball
    centre = pitch - sign * (CONFORMITY - 0.5) * ball
    shoulder = pitch + sign * SHOULDER * ball
    opening = np.arccos(np.clip(abs(shoulder - centre) / radius, 0.0, 1.0))
    angles = np.linspace(np.arcsin(front / radius), -opening, 17)
    groove = np.column_stack([centre + sign * radius * np.cos(angles), radius * np.sin(angles)])
    profile = np.concatenate([[[far, back], [far, front]], groove, [[shoulder, back]]])
    return profile if sign > 0.0 else profile[::-1]
