# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Catalogue of bearings with published geometry, and lookup by designation."""

from __future__ import annotations

from collections.abc import Mapping
import contextlib
import csv
import difflib
import functools
from importlib import resources
import math
import re
import string
from types import MappingProxyType
from typing import Any

from bearing_twin.bearing.geometry import Bearing, FaultFrequencies
from bearing_twin.errors import BearingTwinError

_MAKERS = 'skf|fag|ina|nsk|ntn|snr|koyo|nachi|timken|zkl|urb|fbj|c&u|schaeffler|jtekt'
_SUFFIX = r'(?:-?2?(?:rs[a-z0-9]?|rz|z|ru|rd)|zz|vv|ddu?|ll[ubh]|c[2345]|cn|cm|tn9?|jem|m|j|n|nr)'
_MADE_BY = rf'(?:(?:{_MAKERS})[ -]*)?'
_WITH_SUFFIXES = rf'{_MADE_BY}(\d{{3,5}}(?:/\d\d)?)(?:[ /-]*{_SUFFIX}){{0,8}}'
"""Pattern of a designation with maker and suffixes that change neither balls nor pitch diameter.
The suffix E (as in ETN9) is not among them: it stands for more or larger balls. Without a limit on
the number of suffixes, matching a name of 45 letters takes hours."""
_ROLLERS_E = (
    rf'{_MADE_BY}(?:nu|nj|nup|n)[ -]*(\d{{3,4}})[ -]*'
    r'(?:e(?:c|a|w|m|ma|j|t|t2|g1|cp|cph|cj|cm|cml|cma|cpa)?|r)'
    r'(?:[ /.-]*(?:xl|tvp2?|m1a?|mp1a|mpa|jp1|c[2345]|cn)){0,4}'
)
"""Pattern of a cylindrical roller bearing of the reinforced design (E, EC, Koyo: R), with maker,
cage and clearance. NU, NJ, NUP and N differ in the flanges of their rings only. Without E such a
bearing has fewer, smaller rollers."""
_SAME_CAGE = 0.006
"""Largest difference between a stated FTF and that of BPFO and BPFI; makers round to 0.01."""
_SAME_SPIN = 1.05
"""Largest ratio of a stated BSF to that of balls without a contact angle; it is rounded, too."""
LONGEST_NAME = 100
"""Characters of an unknown name that are compared and shown in messages."""


@functools.cache
def catalogue() -> Mapping[str, Bearing]:
    """
    Return every bearing of the catalogue by name, each with the source of its geometry.

    Examples
    --------
    >>> catalogue()['6308'].n_balls
    8

    """
    text = resources.files('bearing_twin.bearing').joinpath('catalogue.csv').read_text('utf-8')
    bearings = (_bearing(row) for row in csv.DictReader(text.splitlines()))
    return MappingProxyType({bearing.name: bearing for bearing in bearings})


def _bearing(row: dict[str, Any]) -> Bearing:
    def known(column: str) -> float | None:
        return float(row[column]) / 1e3 if row[column] else None

    return Bearing(
        name=row['name'],
        kind=row['kind'],
        element=row['element'],
        rows=int(row['rows']),
        n_balls=int(row['n_balls']),
        d_ball=float(row['d_ball_mm']) / 1e3,
        d_pitch=float(row['d_pitch_mm']) / 1e3,
        contact_angle=math.radians(float(row['contact_angle_deg'])),
        bore=known('bore_mm'),
        outside=known('outside_mm'),
        width=known('width_mm'),
        dynamic_rating=_newton(row['dynamic_rating_kN']),
        static_rating=_newton(row['static_rating_kN']),
        series=row['series'],
        basis=row['basis'],
        source=row['source'],
    )


def _newton(kilonewton: str) -> float | None:
    return float(kilonewton) * 1e3 if kilonewton else None


def find_bearing(name: str) -> Bearing:
    """
    Return the bearing called ``name``.

    Case is ignored. A maker before the designation and suffixes of seals, shields, cage and
    clearance are ignored too, since they change no fault order: ``'SKF 6205-2RS JEM'`` is 6205.
    61805 and 61905 are 6805 and 6905, ``'NJ 216 ECP'`` is NU216E. A geometry in the form of
    :func:`own_bearing` also works.

    Raises
    ------
    BearingTwinError
        If no bearing has that name; the message lists the closest names.

    Examples
    --------
    >>> find_bearing('skf 6205-2rs').n_balls, find_bearing('NU 209').n_balls
    (9, 14)

    """
    if ',' in name:
        return own_bearing(name)
    by_folded = {known.casefold(): bearing for known, bearing in catalogue().items()}
    folded = name.strip().casefold()
    for candidate in (folded, _designation(folded), ''.join(folded.split())):
        if candidate in by_folded:
            return by_folded[candidate]
    shown = name[:LONGEST_NAME]
    close = ', '.join(bearing.name for bearing in close_bearings(shown, 5))
    msg = (
        f'no bearing {shown!r} in the catalogue; the closest names: {close}; '
        "'bearing-twin bearings' lists all; for any other give a geometry "
        'Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG or the fault orders of its maker, '
        'BPFO=ORDER,BPFI=ORDER,BSF=ORDER'
    )
    raise BearingTwinError(msg)


def close_bearings(name: str, count: int) -> list[Bearing]:
    """
    Return the bearings of the catalogue with the names most like ``name``, closest first.

    Examples
    --------
    >>> [bearing.name for bearing in close_bearings('6306', 1)]
    ['6306']
    >>> [bearing.name for bearing in close_bearings('NU 205', 1)]
    ['NU205E']
    >>> close_bearings('FAG 6205-C-2HRS-C3', 5)[0].name
    '6205'

    """
    folded = name.strip().casefold()
    folded = _designation(folded) or re.sub(rf'^(?:{_MAKERS})[ -]+|\s', '', folded)

    def unlike(bearing: Bearing) -> tuple[int, float]:
        # Each digit of a designation has its own meaning: equal digits at equal places come first.
        known = bearing.name.casefold()
        same = sum(one == other for one, other in zip(known, folded, strict=False))
        return -same, -difflib.SequenceMatcher(None, known, folded).ratio()

    kin = [bearing for bearing in catalogue().values() if _kind(bearing.name) == _kind(folded)]
    return sorted(kin or catalogue().values(), key=unlike)[:count]


def _kind(name: str) -> str:
    """Return the letters in front of a designation, which tell the kind of bearing."""
    return name[: len(name) - len(name.lstrip(string.ascii_letters))].casefold()


def _designation(folded: str) -> str:
    """Return the designation without maker and suffixes; '' if the name contains none."""
    if found := re.fullmatch(_ROLLERS_E, folded):
        return f'nu{found[1]}e'
    found = re.fullmatch(_WITH_SUFFIXES, folded)
    if not found:
        return ''
    # SKF and Schaeffler write 618 and 619 for the series that others call 68 and 69.
    return re.sub(r'^61([89])(?=\d\d$)', r'6\1', found[1])


def named_bearing(name: str) -> Bearing:
    """
    Return the catalogue bearing named in a description, such as the metadata of a data set.

    Raises
    ------
    BearingTwinError
        If the text names no bearing of the catalogue.

    Examples
    --------
    >>> named_bearing('SKF 6205-2RS JEM (drive end)').name
    '6205'

    """
    words = name.replace('/', ' ').split()
    for candidate in (name, *(' '.join(words[:count]) for count in (3, 2, 1)), *words[1:2]):
        if candidate and ',' not in candidate:
            try:
                return find_bearing(candidate)
            except BearingTwinError:
                continue
    said = f'the file says {name!r}, which is not in the catalogue' if name else 'unknown bearing'
    msg = (
        f'{said}; give --bearing NAME, or --geometry Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG or '
        'BPFO=ORDER,BPFI=ORDER,BSF=ORDER'
    )
    raise BearingTwinError(msg)


def own_bearing(geometry: str) -> Bearing:
    """
    Return a bearing from its geometry or its fault orders; its name is the text given.

    Parameters
    ----------
    geometry
        ``'Z,D_BALL_MM,D_PITCH_MM[,ANGLE_DEG]'`` of a ball bearing, or the multiples of the shaft
        speed that makers publish for a bearing of any kind,
        ``'BPFO=ORDER,BPFI=ORDER[,BSF=ORDER][,FTF=ORDER]'``. Without BSF the contact angle is 0.

    Raises
    ------
    BearingTwinError
        If the text has another form, or the geometry or the orders are impossible.

    Examples
    --------
    >>> own_bearing('9,7.94,39.04,0').n_balls, own_bearing('BPFO=5.97,BPFI=8.03').n_balls
    (9, 14)

    """
    if '=' in geometry:
        return _by_orders(geometry)
    try:
        count, ball, pitch, *rest = geometry.split(',')
        (angle,) = rest or ['0']
        degrees, n_balls = float(angle), int(count)
        d_ball, d_pitch = float(ball) * 1e-3, float(pitch) * 1e-3
    except ValueError:
        msg = (
            f'geometry={geometry!r} is not Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG; '
            "e.g. '9,7.94,39.04,0', the maker's fault orders 'BPFO=3.585,BPFI=5.415,BSF=2.357', "
            'or name a bearing of the catalogue'
        )
        raise BearingTwinError(msg) from None
    if not 0.0 <= degrees < 90.0:
        msg = (
            f'geometry={geometry!r}: a contact angle of {degrees:g} degrees is not at least 0 and '
            'below 90; give the angle to the radial plane'
        )
        raise BearingTwinError(msg)
    return Bearing(
        name=geometry,
        n_balls=n_balls,
        d_ball=d_ball,
        d_pitch=d_pitch,
        contact_angle=math.radians(degrees),
        source='given by the user',
    )


def _by_orders(text: str) -> Bearing:
    """Return the bearing with the fault orders in a text; see :func:`own_bearing`."""
    orders: dict[str, float] = {}
    with contextlib.suppress(ValueError):
        for name, _, order in (part.partition('=') for part in text.split(',')):
            orders[name.strip().lower()] = float(order)
    bpfo, bpfi = orders.get('bpfo', math.nan), orders.get('bpfi', math.nan)
    said = f'geometry={text!r:.100}'
    if len(orders) != text.count(',') + 1 or not orders.keys() <= set(FaultFrequencies._fields):
        msg = (
            f"{said} is not BPFO=ORDER,BPFI=ORDER,BSF=ORDER; e.g. 'BPFO=3.585,BPFI=5.415,"
            "BSF=2.357', in multiples of the shaft speed"
        )
        raise BearingTwinError(msg)
    if not 0.0 < bpfo < bpfi < math.inf:
        msg = f'{said}: BPFO={bpfo:g}, BPFI={bpfi:g}; give both, the smaller one is BPFO'
        raise BearingTwinError(msg)
    gamma, ftf = (bpfi - bpfo) / (bpfi + bpfo), bpfo / (bpfi + bpfo)
    if not abs(orders.get('ftf', ftf) - ftf) <= _SAME_CAGE:
        msg = (
            f'{said}: the cage of these BPFO and BPFI has FTF={ftf:.4g}; are all of one bearing '
            'whose outer ring stands still?'
        )
        raise BearingTwinError(msg)
    fastest = 0.5 * (1.0 / gamma - gamma)
    bsf = orders.get('bsf', fastest)
    if bsf > _SAME_SPIN * fastest:
        msg = (
            f'{said}: BSF is at most {fastest:.4g} with these BPFO and BPFI; give the spin of a '
            'ball, half as often as its defect strikes a race'
        )
        raise BearingTwinError(msg)
    return bearing_of_orders(text, FaultFrequencies(bpfo, bpfi, bsf, ftf))


def bearing_of_orders(name: str, orders: FaultFrequencies) -> Bearing:
    """
    Return the ball bearing whose fault orders without slip are ``orders``.

    The orders determine the number of balls, gamma and the ratio of ball to pitch diameter, but
    not the size: a pitch diameter of 50 mm is assumed, with which nothing can be simulated.

    Raises
    ------
    BearingTwinError
        If no bearing has such orders.

    Examples
    --------
    >>> bearing = bearing_of_orders('6205', FaultFrequencies(3.5848, 5.4152, 2.3567, 0.3983))
    >>> bearing.n_balls, round(bearing.d_ball / bearing.d_pitch, 3)
    (9, 0.203)

    """
    bpfo, bpfi, bsf, ftf = orders
    count = bpfo + bpfi
    said = f'{bpfo:g}, {bpfi:g}, {bsf:g}, {ftf:g}'
    msg = f'no bearing has the fault orders {said} (BPFO, BPFI, BSF, FTF)'
    if not (0.0 < ftf < bpfo < bpfi < 100.0 and bsf > 0.0 and abs(count - round(count)) < 0.05):
        raise BearingTwinError(msg)
    gamma = (bpfi - bpfo) / count
    # A ratio below gamma comes from rounding: the contact angle is zero.
    ratio = max(0.5 * (1.0 - gamma * gamma) / bsf, gamma)
    try:
        return Bearing(
            name=name,
            n_balls=round(count),
            d_ball=0.05 * ratio,
            d_pitch=0.05,
            contact_angle=math.acos(gamma / ratio),
            basis='orders',
            source='given by its fault orders',
        )
    except BearingTwinError as error:
        raise BearingTwinError(f'{msg}: {error}') from None
