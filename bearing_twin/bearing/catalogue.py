# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bearings of published geometry, from the data file beside this module."""

from __future__ import annotations

import csv
import difflib
import functools
from importlib import resources
import math
from types import MappingProxyType
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing.geometry import Bearing
from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ['catalogue', 'find_bearing', 'own_bearing']


@functools.cache
def catalogue() -> Mapping[str, Bearing]:
    """Return every bearing of the catalogue by name, each with the source of its geometry."""
    text = resources.files('bearing_twin.bearing').joinpath('catalogue.csv').read_text('utf-8')
    bearings = (_bearing(row) for row in csv.DictReader(text.splitlines()))
    return MappingProxyType({bearing.name: bearing for bearing in bearings})


def _bearing(row: dict[str, Any]) -> Bearing:
    return Bearing(
        name=row['name'],
        element=row['element'],
        rows=int(row['rows']),
        n_balls=int(row['n_balls']),
        d_ball=float(row['d_ball_mm']) / 1e3,
        d_pitch=float(row['d_pitch_mm']) / 1e3,
        contact_angle=math.radians(float(row['contact_angle_deg'])),
        bore=float(row['bore_mm']) / 1e3 if row['bore_mm'] else None,
        outside=float(row['outside_mm']) / 1e3 if row['outside_mm'] else None,
        series=row['series'],
        source=row['source'],
    )


def find_bearing(name: str) -> Bearing:
    """
    Return the bearing called ``name``; upper and lower case are the same.

    A geometry as :func:`own_bearing` takes it is a name too.

    Raises
    ------
    BearingTwinError
        If there is none of that name; the text lists the closest ones.

    """
    if ',' in name:
        return own_bearing(name)
    by_folded = {known.casefold(): bearing for known, bearing in catalogue().items()}
    found = by_folded.get(name.strip().casefold())
    if found is None:
        close = difflib.get_close_matches(name.casefold(), by_folded, n=4, cutoff=0.3)
        names = ', '.join(by_folded[key].name for key in close or by_folded)
        msg = f'no bearing {name!r} in the catalogue; known and close: {names}'
        raise BearingTwinError(msg)
    return found


def own_bearing(geometry: str) -> Bearing:
    """
    Return a ball bearing that is in no catalogue; its name is the text given.

    Parameters
    ----------
    geometry
        ``'Z,D_BALL_MM,D_PITCH_MM[,ANGLE_DEG]'``.

    Raises
    ------
    BearingTwinError
        If the text is something else or such a bearing cannot be built.

    """
    try:
        count, ball, pitch, *rest = geometry.split(',')
        (angle,) = rest or ['0']
        numbers = int(count), float(ball) * 1e-3, float(pitch) * 1e-3, math.radians(float(angle))
    except ValueError:
        msg = (
            f'geometry={geometry!r} is not Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG; '
            "e.g. '9,7.94,39.04,0', or name a bearing of the catalogue"
        )
        raise BearingTwinError(msg) from None
    n_balls, d_ball, d_pitch, contact_angle = numbers
    return Bearing(
        name=geometry,
        n_balls=n_balls,
        d_ball=d_ball,
        d_pitch=d_pitch,
        contact_angle=contact_angle,
        source='given by the user',
    )
