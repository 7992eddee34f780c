# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Text form of defects, as used by parameters, services and commands.

The text is ``none`` or places joined by ``+``. Values of one place that differ from the common
ones follow it::

    inner
    inner+ball
    inner:width=0.0012,angle=1.57+inner:angle=-1.57+ball:ball=3,profile=rect
"""

from __future__ import annotations

import re
from typing import Any, cast, TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.dynamics.parameters import Defect, DOWN
from bearing_twin.errors import BearingTwinError

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import Profile


_KEYS = {'width': float, 'depth': float, 'angle': float, 'ball': int, 'profile': str}
_BETWEEN = re.compile(r'\+(?![\d.])')  # not a sign before a number


def read_defects(
    text: str, *, width: float, depth: float, profile: Profile, angle: float = DOWN
) -> tuple[Defect, ...]:
    """
    Return the defects that ``text`` describes.

    Parameters
    ----------
    text
        ``'none'`` or places joined by '+'. ``:KEY=VALUE,...`` after a place sets values of its
        own. The keys are those of :class:`Defect`: width and depth in m, angle in rad, ball,
        profile.
    width, depth, profile
        Common values for defects without their own; width and depth in m.
    angle
        Angle of outer race and cage defects without their own, rad: the direction of the load.

    Raises
    ------
    BearingTwinError
        If a place or key is unknown or a value is invalid.

    Examples
    --------
    >>> common = {'width': 1e-3, 'depth': 2e-5, 'profile': 'ball'}
    >>> for defect in read_defects('inner+ball:ball=3,width=0.0005', **common):
    ...     print(defect.place, defect.ball, defect.width)
    inner 0 0.001
    ball 3 0.0005

    """
    defects = []
    for place, given in _parts(text):
        if place not in PLACES:
            msg = f'no defect place {place!r}; choose none or one of {", ".join(PLACES)}'
            raise BearingTwinError(msg)
        common = {
            'width': width,
            'depth': depth,
            'profile': profile,
            'angle': angle if place in ('outer', 'cage') else 0.0,
        }
        defects.append(Defect(place=cast('Any', place), **{**common, **_values(place, given)}))
    return tuple(defects)


def defect_places(text: str) -> str:
    """
    Return the places alone, e.g. ``'inner+ball'``; they are not validated.

    Examples
    --------
    >>> defect_places('inner:width=0.0012+ball:ball=3')
    'inner+ball'

    """
    return '+'.join(place for place, _ in _parts(text)) or 'none'


def placed_defects(text: str, angle: float) -> str:
    """
    Return ``text`` with the load angle, rad, added to outer race and cage defects without angle.

    These are the defects for which `read_defects` takes it. For a load that acts downwards the
    text stays as it is.

    Examples
    --------
    >>> placed_defects('outer+inner', 0.5)
    'outer:angle=0.5+inner'
    >>> placed_defects('outer:angle=1.57,width=0.001', 0.5)
    'outer:angle=1.57,width=0.001'

    """
    if angle == DOWN:
        return text.strip() or 'none'
    placed = []
    for place, given in _parts(text):
        words = [word for word in given.split(',') if word.strip()]
        if place in ('outer', 'cage') and 'angle' not in _values(place, given):
            words.append(f'angle={angle!r}')
        placed.append(f'{place}:{",".join(words)}' if words else place)
    return '+'.join(placed) or 'none'


def _parts(text: str) -> list[tuple[str, str]]:
    if text.strip() in ('none', ''):
        return []
    parts = (part.partition(':') for part in _BETWEEN.split(text))
    return [(place.strip(), given) for place, _, given in parts]


def _values(place: str, given: str) -> dict[str, Any]:
    values: dict[str, Any] = {}
    for word in given.split(',') if given.strip() else ():
        key, _, value = (part.strip() for part in word.partition('='))
        if key not in _KEYS or key in values:
            msg = (
                f'{place} defect: {word.strip()!r} is not one of {", ".join(_KEYS)}, each once; '
                f"write '{place}:width=0.001,angle=1.57'"
            )
            raise BearingTwinError(msg)
        try:
            values[key] = _KEYS[key](value)
        except ValueError:
            kind = 'a whole number' if key == 'ball' else 'a number (in m or rad)'
            msg = f"{place} defect: {key}={value!r} is not {kind}; write e.g. '{key}=" + (
                "3'" if key == 'ball' else "0.001'"
            )
            raise BearingTwinError(msg) from None
    return values
