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
from typing import TYPE_CHECKING

from bearing_twin.bearing.geometry import Bearing
from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ['catalogue', 'find_bearing']


@functools.cache
def catalogue() -> Mapping[str, Bearing]:
    """Return every bearing of the catalogue by name, each with the source of its geometry."""
    text = resources.files('bearing_twin.bearing').joinpath('catalogue.csv').read_text('utf-8')
    rows = csv.DictReader(text.splitlines())
    return MappingProxyType(
        {
            row['name']: Bearing(
                name=row['name'],
                n_balls=int(row['n_balls']),
                d_ball=float(row['d_ball_mm']) / 1e3,
                d_pitch=float(row['d_pitch_mm']) / 1e3,
                contact_angle=math.radians(float(row['contact_angle_deg'])),
                source=row['source'],
            )
            for row in rows
        }
    )


def find_bearing(name: str) -> Bearing:
    """
    Return the bearing called ``name``; upper and lower case are the same.

    Raises
    ------
    BearingTwinError
        If there is none of that name; the text lists the closest ones.

    """
    by_folded = {known.casefold(): bearing for known, bearing in catalogue().items()}
    found = by_folded.get(name.strip().casefold())
    if found is None:
        close = difflib.get_close_matches(name.casefold(), by_folded, n=4, cutoff=0.3)
        names = ', '.join(by_folded[key].name for key in close or by_folded)
        msg = f'no bearing {name!r} in the catalogue; known and close: {names}'
        raise BearingTwinError(msg)
    return found
