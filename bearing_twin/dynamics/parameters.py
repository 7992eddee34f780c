# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the twin, each with its unit, range and source."""

from __future__ import annotations

from dataclasses import dataclass, field
import math
from types import MappingProxyType
from typing import Literal, TYPE_CHECKING

from bearing_twin.bearing import Bearing, Place, PLACES, radial_factor
from bearing_twin.errors import BearingTwinError
from bearing_twin.thermal.friction import SERIES
from bearing_twin.thermal.gcr15 import Beta0, FRICTION_TABLE, TEMPERATURES
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.rings import (
    clearance_change,
    CLEARANCE_HIGH,
    CLEARANCE_LOW,
    ThermalNetwork,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = [
    'MAX_DEFECTS',
    'MAX_SHAFT_HZ',
    'PROFILES',
    'RANGES',
    'Defect',
    'TwinParameters',
    'check_speed',
]

Profile = Literal['ball', 'rect', 'halfsine', 'smooth']
PROFILES: tuple[Profile, ...] = ('ball', 'rect', 'halfsine', 'smooth')
MAX_DEFECTS = 8
"""Most defects of one bearing."""

MAX_SHAFT_HZ = 500.0
"""Fastest shaft, Hz."""
MAX_ECCENTRICITY = 1e-3
"""Largest offset of a rotor's centre of mass, m: no machine runs with more."""

_LOAD_DIRECTION = -math.pi / 2


RANGES: Mapping[str, tuple[float, float, str]] = MappingProxyType(
    {
        'load': (10.0, 50e3, 'N'),
        'clearance': (CLEARANCE_LOW, CLEARANCE_HIGH, 'm'),
        'contact_damping': (0.0, 1500.0, 'N s/m'),
        'inner_mass': (0.1, 500.0, 'kg'),
        'inner_stiffness': (1e5, 1e10, 'N/m'),
        'inner_damping': (0.0, 1e6, 'N s/m'),
        'outer_mass': (0.1, 500.0, 'kg'),
        'outer_stiffness': (1e5, 1e10, 'N/m'),
        'outer_damping': (0.0, 1e6, 'N s/m'),
        'unbalance': (0.0, 2.5e-2, 'kg m'),
        'slip': (0.0, 0.05, ''),
        'jitter': (0.0, 0.05, ''),
        'noise': (0.0, 100.0, 'm/s^2'),
        'resonance_damping': (0.005, 0.7, ''),
        'start_angle': (-2.0 * math.pi, 2.0 * math.pi, 'rad'),
    }
)
"""Least and greatest value and unit of the fields of `TwinParameters` that have a plain range."""


def check_range(name: str, value: float, low: float, high: float, unit: str) -> None:
    """Refuse a ``value`` that is not finite or outside ``low``..``high``."""
    if not low <= value <= high:
        limits = f'{low:g}..{high:g} {unit}'.rstrip()
        msg = f'{name}={value} is outside {limits}; choose a value inside'
        raise BearingTwinError(msg)


def check_speed(shaft_hz: float) -> float:
    """Return the shaft speed in Hz if it is inside 0..`MAX_SHAFT_HZ`."""
    if not 0.0 <= shaft_hz <= MAX_SHAFT_HZ:
        msg = f'shaft_hz={shaft_hz} is outside 0..{MAX_SHAFT_HZ:g} Hz'
        raise BearingTwinError(msg)
    return float(shaft_hz)


@dataclass(frozen=True, kw_only=True)
class Defect:
    """
    A local fault.

    Parameters
    ----------
    place
        ``'inner'``, ``'outer'``, ``'ball'`` or ``'cage'``.
    width
        Extent in the rolling direction, m, 0.05 to 10 mm. For the cage: the play of the worn
        pocket, over which its ball slips when it comes under load.
    depth
        Greatest depth along the contact normal, m, 0 to 0.5 mm; the paper's C_d0. For the cage:
        by how much that ball drops out of contact while it slips.
    angle
        Centre of the defect, rad. Outer and cage: from +x, best in the load direction (-pi/2).
        Inner: from the shaft's mark. Ball: spin angle at which it meets the inner race.
    ball
        Index of the ball, or of the worn cage pocket, from 0.
    profile
        Path of a ball over the defect. ``'ball'``: it bridges the gap, ``min(depth, s^2 (1/d +-
        1/D_race))`` with s the distance to the nearer edge, + on the inner, - on the outer race.
        The literature's: ``'rect'`` (full depth at once; it makes every fixed-step scheme first
        order), ``'halfsine'``, ``'smooth'`` (raised-cosine flanks over a quarter of the width).

    """

    place: Place
    width: float
    depth: float
    angle: float = 0.0
    ball: int = 0
    profile: Profile = 'ball'

    def __post_init__(self) -> None:
        if self.place not in PLACES:
            msg = f'defect place {self.place!r} is unknown; choose one of {", ".join(PLACES)}'
            raise BearingTwinError(msg)
        if self.profile not in PROFILES:
            msg = f'profile {self.profile!r} is unknown; choose one of {", ".join(PROFILES)}'
            raise BearingTwinError(msg)
        check_range('defect width', self.width, 0.05e-3, 10e-3, 'm (0.05 to 10 mm)')
        check_range('defect depth', self.depth, 0.0, 0.5e-3, 'm (0 to 0.5 mm)')
        check_range('defect angle', self.angle, -2.0 * math.pi, 2.0 * math.pi, 'rad')


@dataclass(frozen=True, kw_only=True)
class TwinParameters:
    """
    Everything that the equations of motion need, validated.

    Sources: [P] Symmetry 2023, 15, 2166; [M] Mishra et al., J. Sound Vib. 2017, table 1; [S]
    Sawalhi and Randall, Mech. Syst. Signal Process. 2008, and theses of the same group; [C] Cheng
    et al. 2019, table 1; [D] D'Elia, Cocconcelli, Mucchi 2016 (generator of bearing signals).

    Parameters
    ----------
    bearing
        Geometry: one row of balls with a contact angle of at most 45 deg. An axial load, which a
        contact angle asks for, is not in the model.
    thermal_mode
        ``'paper'``: stiffness and defect depth follow `beta0`. ``'physical'``: ring temperatures,
        clearance, E(T), lubricant and slip.
    defects
        Up to 8 defects at once. Two of them on one race, ball or pocket must not overlap.
    load
        Radial load that the bearing carries, along -y, N, 10 to 50000. The position of the shaft
        spring is solved for it, because that spring is grounded and would carry most of a force.
    clearance
        Radial clearance c_r, half the radial internal clearance, with both rings at one
        temperature, m, -5 to 50 um (6307 CN: RIC 6 to 20 um). In the physical mode it must stay
        in these limits at every temperature of the outer ring, 20 to 110 degC.
    hertz_stiffness
        K_b0 of radial force over radial deformation, N/m^1.5, 1e8 to 1e12; None: from the
        geometry (6307 of the catalogue 1.228e10).
    contact_damping
        c_b of a loaded ball, N s/m, 0 to 1500 [C].
    inner_mass, inner_stiffness, inner_damping
        Rotor and shaft: kg 0.1 to 500, N/m 1e5 to 1e10, N s/m 0 to 1e6 [M].
    outer_mass, outer_stiffness, outer_damping
        Housing: kg 0.1 to 500, N/m 1e5 to 1e10, N s/m 0 to 1e6 [M]. Without damping of both
        rings the passing balls can drive the motion up (parametric resonance).
    unbalance
        m_u e, kg m, 0 to 2.5e-2, and at most 1 mm times the rotor's mass.
    slip_model, slip
        Cage slip: ``'none'``; ``'constant'`` s = `slip`; ``'mu_proportional'`` s = `slip`
        mu(T)/mu0, whose default 0.0965 % gives the paper's 126.42 and 126.82 Hz. 0 to 0.05.
    jitter
        Standard deviation of the angle between two impacts over the ball spacing, 0 to 0.05 [D].
    noise
        White noise of the sensor, standard deviation per sample, m/s^2, 0 to 100.
    resonance_hz, resonance_damping
        Sensor resonance, Hz, 0 (none) or 500 to 11000; damping ratio 0.005 to 0.7 [S].
    beta0
        The paper's factor and its switches.
    lubricant
        Oil, for friction and life.
    network
        Heat capacities and conductances of the rings, for the physical mode.
    friction_series
        Series of the SKF friction model: '60', '62', '63', '64', '160' or '618'; None: that of
        the bearing, or '62' where the catalogue does not know it.
    dynamic_rating, fatigue_limit
        C and C_u, N, 10 to 1e8 and 1 to 1e7; None: from the geometry by ISO 281 and ISO 76.
    start_angle
        Angle of ball 0 and of the shaft's mark at sample 0, rad from +x. The default puts both
        in the load direction, so that an inner defect at angle 0 is struck at t = 0.

    """

    bearing: Bearing
    thermal_mode: Literal['paper', 'physical'] = 'paper'
    defects: tuple[Defect, ...] = ()
    load: float = 500.0
    clearance: float = 5e-6
    hertz_stiffness: float | None = None
    contact_damping: float = 300.0
    inner_mass: float = 6.2638
    inner_stiffness: float = 7.42e7
    inner_damping: float = 1376.8
    outer_mass: float = 12.638
    outer_stiffness: float = 1.51e7
    outer_damping: float = 2210.7
    unbalance: float = 0.0
    slip_model: Literal['none', 'constant', 'mu_proportional'] = 'mu_proportional'
    slip: float = 0.000965
    jitter: float = 0.005
    noise: float = 0.1
    resonance_hz: float = 6000.0
    resonance_damping: float = 0.04
    beta0: Beta0 = field(default_factory=Beta0)
    lubricant: Lubricant = field(default_factory=Lubricant)
    network: ThermalNetwork = field(default_factory=ThermalNetwork)
    friction_series: str | None = None
    dynamic_rating: float | None = None
    fatigue_limit: float | None = None
    start_angle: float = _LOAD_DIRECTION

    def __post_init__(self) -> None:
        self._check_bearing()
        if self.thermal_mode not in ('paper', 'physical'):
            msg = f'thermal_mode {self.thermal_mode!r} is unknown; choose paper or physical'
            raise BearingTwinError(msg)
        if self.slip_model not in ('none', 'constant', 'mu_proportional'):
            msg = (
                f'slip_model {self.slip_model!r} is unknown; choose none, constant or '
                'mu_proportional'
            )
            raise BearingTwinError(msg)
        for name, (low, high, unit) in RANGES.items():
            check_range(name, getattr(self, name), low, high, unit)
        check_range('hertz_stiffness', self.k_b0, 1e8, 1e12, 'N/m^1.5')
        if self.dynamic_rating is not None:
            check_range('dynamic_rating', self.dynamic_rating, 10.0, 1e8, 'N')
        if self.fatigue_limit is not None:
            check_range('fatigue_limit', self.fatigue_limit, 1.0, 1e7, 'N')
        series = self.friction_series or self.bearing.series
        if series and series not in SERIES:
            msg = (
                f'friction_series {series!r} is unknown; choose the nearest of {", ".join(SERIES)}'
            )
            raise BearingTwinError(msg)
        if self.resonance_hz != 0.0:
            check_range('resonance_hz', self.resonance_hz, 500.0, 11000.0, 'Hz, or 0 for none')
        check_range(
            'unbalance over inner_mass',
            self.unbalance / self.inner_mass,
            0.0,
            MAX_ECCENTRICITY,
            'm',
        )
        if self.slip_model == 'mu_proportional':
            hottest = self.slip * float(FRICTION_TABLE.max()) / self.beta0.reference_friction
            check_range('slip at the highest friction of table 3', hottest, 0.0, 0.3, '(slip)')
        if len(self.defects) > MAX_DEFECTS:
            msg = f'{len(self.defects)} defects are more than {MAX_DEFECTS}; merge some'
            raise BearingTwinError(msg)
        for index, defect in enumerate(self.defects):
            self._check_defect(defect)
            for other in self.defects[:index]:
                self._check_apart(other, defect)
        if self.thermal_mode == 'physical':
            self._check_clearance()

    @property
    def k_b0(self) -> float:
        """K_b0 in use, N/m^1.5: `hertz_stiffness`, or from the geometry."""
        if self.hertz_stiffness is not None:
            return self.hertz_stiffness
        return radial_factor(self.bearing)

    def _check_bearing(self) -> None:
        bearing = self.bearing
        if bearing.element != 'ball' or bearing.rows != 1:
            msg = (
                f'{bearing.name} has {bearing.rows} row(s) of {bearing.element}s, and the twin '
                'moves one row of balls: the point contact of Hertz, the path over a spall and '
                'the friction constants hold for nothing else. Its fault frequencies are known, '
                'so a measured vibration can be diagnosed; to simulate, choose a ball bearing'
            )
            raise BearingTwinError(msg)
        steepest = math.radians(45.0)
        check_range('contact_angle', bearing.contact_angle, 0.0, steepest, 'rad (radial bearing)')

    def _check_clearance(self) -> None:
        for outer in (float(TEMPERATURES[0]), float(TEMPERATURES[-1])):
            excess = self.network.inner_excess(outer)
            left = self.clearance + clearance_change(outer + excess, outer, self.bearing.d_pitch)
            if not CLEARANCE_LOW <= left <= CLEARANCE_HIGH:
                msg = (
                    f'with the outer ring at {outer:g} degC the inner ring is {excess:+.1f} K '
                    f'from it and leaves a radial clearance of {left * 1e6:.1f} um, outside '
                    f'{CLEARANCE_LOW * 1e6:g}..{CLEARANCE_HIGH * 1e6:g} um: the bearing would '
                    f'seize or hang loose; change clearance={self.clearance * 1e6:g} um, '
                    f'shaft_ratio={self.network.shaft_ratio:g} or ambient='
                    f'{self.network.ambient:g} degC'
                )
                raise BearingTwinError(msg)

    def _check_apart(self, one: Defect, other: Defect) -> None:
        """Refuse two defects that share a surface and a stretch of it."""
        shared = one.place == other.place and (
            one.place in ('inner', 'outer') or one.ball == other.ball
        )
        if not shared:
            return
        pitch, g = self.bearing.d_pitch, self.bearing.gamma
        radius = 0.5 * pitch * (1.0 - g if one.place == 'inner' else 1.0 + g)
        if one.place == 'ball':
            radius = 0.5 * self.bearing.d_ball
        distance = radius * abs(math.remainder(one.angle - other.angle, 2.0 * math.pi))
        needed = 0.5 * (one.width + other.width)
        if distance < needed:
            msg = (
                f'two {one.place} defects are {distance * 1e3:.3g} mm apart and overlap, since '
                f'their half widths add up to {needed * 1e3:.3g} mm: the ball would sink in by '
                'both depths; make one defect of them or move one'
            )
            raise BearingTwinError(msg)

    def _check_defect(self, defect: Defect) -> None:
        bearing = self.bearing
        if not 0 <= defect.ball < bearing.n_balls:
            msg = (
                f'defect on ball {defect.ball}, but {bearing.name} has balls '
                f'0..{bearing.n_balls - 1}'
            )
            raise BearingTwinError(msg)
        spacing = math.pi * (bearing.d_pitch - bearing.d_ball) / bearing.n_balls
        limit = min(spacing, 0.5 * bearing.d_ball)
        if defect.width > limit:
            msg = (
                f'{defect.place} defect {defect.width * 1e3:g} mm wide, but the model holds for '
                f'at most {limit * 1e3:.3g} mm on {bearing.name} (half a ball, one ball spacing): '
                'a wider one is no local defect'
            )
            raise BearingTwinError(msg)
