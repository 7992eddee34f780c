# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Bearing geometry and fault frequencies."""

from __future__ import annotations

from dataclasses import dataclass
import math
from typing import Literal, NamedTuple

from bearing_twin.errors import BearingTwinError
from bearing_twin.given import check_kind, real_number
from bearing_twin.quantity import check_whole


class FaultFrequencies(NamedTuple):
    """
    The four characteristic frequencies of a bearing with a fixed outer ring.

    :func:`fault_frequencies` returns them in Hz, :func:`fault_orders` in multiples of the shaft
    speed ("orders").
    """

    bpfo: float
    """Ball pass frequency, outer race."""
    bpfi: float
    """Ball pass frequency, inner race."""
    bsf: float
    """Ball spin frequency. A defect on a ball strikes a race at twice this frequency."""
    ftf: float
    """Fundamental train (cage) frequency."""

    def impacts(self, place: str) -> float:
        """
        Return the impact frequency of a defect at ``place``, in the unit of the other fields.

        A ball defect strikes both races, so twice in each spin.

        >>> FaultFrequencies(bpfo=3.1, bpfi=4.9, bsf=2.0, ftf=0.38).impacts('ball')
        4.0
        """
        return {
            'inner': self.bpfi,
            'outer': self.bpfo,
            'ball': 2.0 * self.bsf,
            'cage': self.ftf,
        }[place]


@dataclass(frozen=True, kw_only=True)
class Bearing:
    """
    Internal geometry of a rolling element bearing.

    Parameters
    ----------
    name
        Designation, e.g. ``'6307'``.
    n_balls
        Number of rolling elements, 3 to 100.
    d_ball
        Diameter of a rolling element, m.
    d_pitch
        Pitch diameter, m.
    contact_angle
        Contact angle, rad, 0 to below pi/2.
    element
        ``'ball'`` or ``'roller'``. The fault frequencies are the same. The contact differs, and
        the twin simulates only balls.
    rows
        Rows of elements, 1 or 2, with `n_balls` in each.
    bore, outside, width
        Boundary dimensions, m; None: not published.
    dynamic_rating, static_rating
        Basic radial load ratings C_r and C_0r of the maker, N; None: not published.
    series
        Dimension series, which selects the friction constants, e.g. ``'63'``; '': not known.
    kind
        Type of bearing, e.g. ``'deep groove ball'``.
    basis
        Where number and diameter of the balls come from: ``'published'``; ``'inferred'`` from a
        maker's ratings, which only these balls give; ``'estimated'``: the likeliest of several
        that fit; ``'given'`` by the user; ``'orders'``: from fault orders, which leave the size
        open.
    source
        Where the geometry was published.

    Raises
    ------
    BearingTwinError
        If the elements do not fit on the pitch circle or a value is out of its range or no
        number.

    Examples
    --------
    >>> bearing = Bearing(name='mine', n_balls=9, d_ball=7.94e-3, d_pitch=39.04e-3)
    >>> round(bearing.gamma, 4)
    0.2034

    """

    name: str
    n_balls: int
    d_ball: float
    d_pitch: float
    contact_angle: float = 0.0
    element: Literal['ball', 'roller'] = 'ball'
    rows: int = 1
    bore: float | None = None
    outside: float | None = None
    width: float | None = None
    dynamic_rating: float | None = None
    static_rating: float | None = None
    series: str = ''
    kind: str = ''
    basis: Literal['published', 'inferred', 'estimated', 'given', 'orders'] = 'given'
    source: str = ''

    def __post_init__(self) -> None:
        for name in ('n_balls', 'rows'):
            check_whole(name, getattr(self, name))
        for name in ('d_ball', 'd_pitch', 'contact_angle'):
            real_number(name, getattr(self, name))
        for name in ('bore', 'outside', 'width', 'dynamic_rating', 'static_rating'):
            if getattr(self, name) is not None:
                real_number(name, getattr(self, name))
        if not 3 <= self.n_balls <= 100:
            msg = f'n_balls={self.n_balls} is outside 3..100; give the number of rolling elements'
            raise BearingTwinError(msg)
        if not 1e-4 <= self.d_ball < self.d_pitch < 20.0:
            swapped = self.d_ball >= self.d_pitch
            remedy = 'the ball comes first, then the pitch' if swapped else 'is the unit right'
            msg = (
                f'balls of {1e3 * self.d_ball:g} mm on a pitch circle of {1e3 * self.d_pitch:g} '
                f'mm: need 0.1 mm <= d_ball < d_pitch < 20 m; {remedy}?'
            )
            raise BearingTwinError(msg)
        if not 0.0 <= self.contact_angle < math.pi / 2:
            msg = f'contact_angle={self.contact_angle} rad is outside 0..pi/2; give it in radians'
            raise BearingTwinError(msg)
        if self.d_ball >= self.d_pitch * math.sin(math.pi / self.n_balls):
            msg = (
                f'{self.n_balls} elements of {self.d_ball} m overlap on a pitch circle of '
                f'{self.d_pitch} m; check n_balls, d_ball and d_pitch'
            )
            raise BearingTwinError(msg)
        if self.element not in ('ball', 'roller') or self.rows not in (1, 2):
            msg = f"element={self.element!r}, rows={self.rows}: choose 'ball' or 'roller', 1 or 2"
            raise BearingTwinError(msg)
        bore, outside = self.bore, self.outside
        inner, outer = self.d_pitch - self.d_ball, self.d_pitch + self.d_ball
        if (bore is not None and not 0.0 < bore < inner) or (
            outside is not None and not outer < outside < 20.0
        ):
            msg = (
                f'bore={bore} m, outside={outside} m do not enclose races of {inner:.6g} and '
                f'{outer:.6g} m; check them against d_ball and d_pitch'
            )
            raise BearingTwinError(msg)
        for name in ('width', 'dynamic_rating', 'static_rating'):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < 1e9:
                msg = f'{name}={value} is not positive; give it in m or N, or leave it out'
                raise BearingTwinError(msg)

    @property
    def gamma(self) -> float:
        """Ratio ``d_ball cos(contact_angle) / d_pitch``."""
        return self.d_ball * math.cos(self.contact_angle) / self.d_pitch

    @property
    def mean_diameter(self) -> float:
        """Mean of bore and outside diameter, m; the pitch diameter if these are not known."""
        if self.bore is None or self.outside is None:
            return self.d_pitch
        return 0.5 * (self.bore + self.outside)


def check_geometry(bearing: Bearing) -> None:
    """
    Refuse what is not a :class:`Bearing`, such as the name of one.

    Examples
    --------
    >>> check_geometry('6307')
    Traceback (most recent call last):
    bearing_twin.errors.BearingTwinError: bearing='6307' is not a Bearing; use find_bearing

    """
    check_kind('bearing', bearing, Bearing, 'use find_bearing')


def fault_orders(bearing: Bearing, slip: float = 0.0) -> FaultFrequencies:
    """
    Characteristic frequencies as multiples of the shaft speed.

    Parameters
    ----------
    bearing
        Geometry.
    slip
        Cage slip: the cage turns at ``(1 - slip)`` of its kinematic speed. Slip lowers BPFO and
        FTF in proportion and raises BPFI: ``bpfo + bpfi == n_balls`` holds for every slip.

    Notes
    -----
    Zhang et al., Symmetry 2023, 15, 2166, section 2. d is the ball and D the pitch diameter: the
    paper's text calls them ring diameters, but its numbers are ball and pitch diameter. The ball
    spin is relative to the slipping cage, of balls that roll on the outer race and slide on the
    inner one. If both contacts slid alike, as in `thermal.slip`, slip would lower BSF only by the
    fraction ``slip gamma / (1 + gamma)``.

    Examples
    --------
    >>> bearing = Bearing(name='6205', n_balls=9, d_ball=7.94e-3, d_pitch=39.04e-3)
    >>> [round(order, 3) for order in fault_orders(bearing)]
    [3.585, 5.415, 2.357, 0.398]

    """
    g = bearing.gamma
    ftf = 0.5 * (1.0 - g) * (1.0 - slip)
    bpfo = bearing.n_balls * ftf
    bpfi = bearing.n_balls * (1.0 - ftf)
    bsf = bearing.d_pitch / (2.0 * bearing.d_ball) * (1.0 - g * g) * (1.0 - slip)
    return FaultFrequencies(bpfo, bpfi, bsf, ftf)


def fault_frequencies(bearing: Bearing, shaft_hz: float, slip: float = 0.0) -> FaultFrequencies:
    """
    Characteristic frequencies in Hz at a shaft speed ``shaft_hz`` in Hz.

    See :func:`fault_orders` for ``slip`` and the source.

    Examples
    --------
    >>> bearing = Bearing(name='6205', n_balls=9, d_ball=7.94e-3, d_pitch=39.04e-3)
    >>> round(fault_frequencies(bearing, 30.0).bpfi, 1)
    162.5

    """
    return FaultFrequencies(*(shaft_hz * order for order in fault_orders(bearing, slip)))
