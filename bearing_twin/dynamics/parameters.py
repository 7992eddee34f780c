# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of the twin with unit, range and source."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
import math
from typing import get_args, Literal

from bearing_twin.bearing import Bearing, check_geometry, Place, PLACES, radial_factor
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import check_kind, real_number
from bearing_twin.quantity import check_fields, check_range, check_whole, quantities, quantity
from bearing_twin.thermal.friction import SERIES
from bearing_twin.thermal.gcr15 import Beta0, FRICTION_TABLE, TABLE_HIGH, TABLE_LOW
from bearing_twin.thermal.lubricant import Lubricant
from bearing_twin.thermal.network import clearance_change, clearance_limits, Scaled, ThermalNetwork

Profile = Literal['ball', 'rect', 'halfsine', 'smooth']
ThermalMode = Literal['paper', 'physical']
SlipModel = Literal['none', 'constant', 'mu_proportional', 'traction']
PROFILES: tuple[Profile, ...] = get_args(Profile)
THERMAL_MODES: tuple[ThermalMode, ...] = get_args(ThermalMode)
SLIP_MODELS: tuple[SlipModel, ...] = get_args(SlipModel)
MAX_DEFECTS = 8
"""Most defects of one bearing."""
MAX_WIDTH = 10e-3
"""Width of the widest defect, m."""

MAX_SHAFT_HZ = 500.0
"""Highest shaft speed, Hz."""
MAX_ECCENTRICITY = 1e-3
"""Largest offset of a rotor's centre of mass, m. No machine runs with more."""

DOWN = -math.pi / 2
"""Default direction of the load, downwards, from +x, rad."""
FITTED = (
    'load', 'clearance', 'hertz_stiffness', 'contact_damping', 'inner_mass', 'slip', 'jitter',
)  # fmt: skip
"""Fields that a calibration to a machine sets in a running twin."""


def check_bearing(bearing: Bearing) -> None:
    """
    Raise an error for a bearing that the twin does not simulate.

    Raises
    ------
    BearingTwinError
        If it is not one row of balls of known size with a contact angle of at most 45 deg.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> check_bearing(find_bearing('6205'))

    """
    check_geometry(bearing)
    if bearing.element != 'ball' or bearing.rows != 1:
        msg = (
            f'{bearing.name} has {bearing.rows} row(s) of {bearing.element}s, and the twin '
            'moves one row of balls: the point contact of Hertz, the path over a spall and '
            'the friction constants hold for nothing else. Its fault frequencies are known, '
            'so a measured vibration can be diagnosed; to simulate or to fit, choose a ball '
            'bearing'
        )
        raise BearingTwinError(msg)
    if bearing.basis == 'orders':
        msg = (
            f'the fault orders {bearing.name!r} do not tell the size of the bearing, on which '
            'contacts and paths depend; to simulate or to fit, give its geometry '
            'Z,D_BALL_MM,D_PITCH_MM,ANGLE_DEG'
        )
        raise BearingTwinError(msg)
    steepest = math.radians(45.0)
    check_range('contact_angle', bearing.contact_angle, 0.0, steepest, 'rad (radial bearing)')


def check_speed(shaft_hz: float) -> float:
    """
    Return the shaft speed in Hz if it is inside 0..`MAX_SHAFT_HZ`.

    Examples
    --------
    >>> check_speed(25)
    25.0

    """
    hertz = real_number('shaft_hz', shaft_hz)
    check_range('shaft_hz', hertz, 0.0, MAX_SHAFT_HZ, 'Hz')
    return hertz


def widest(bearing: Bearing) -> float:
    """
    Return the widest local defect, m: the least of half a ball, 10 mm and the ball spacing.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> round(widest(find_bearing('6205')) * 1e3, 2)
    3.97

    """
    spacing = math.pi * (bearing.d_pitch - bearing.d_ball) / bearing.n_balls
    return min(spacing, 0.5 * bearing.d_ball, MAX_WIDTH)


@dataclass(frozen=True, kw_only=True)
class Defect:
    """
    A local fault.

    Parameters
    ----------
    place
        ``'inner'``, ``'outer'``, ``'ball'`` or ``'cage'``.
    width
        Extent in the rolling direction, m. For the cage: the play of the worn pocket, over which
        its ball slips when it enters the load zone.
    depth
        Greatest depth along the contact normal, m. For the cage: the depth by which that ball
        loses contact while it slips.
    angle
        Centre of the defect, rad. Outer race and cage: from +x, usually in the direction of the
        load. Inner race: from the mark of the shaft. Ball: spin angle at which the defect meets
        the inner race.
    ball
        Index of the ball, or of the worn cage pocket, from 0.
    profile
        Path of a ball over the defect. ``'ball'``: the ball bridges the gap and sinks by
        ``min(depth, s^2 (1/d +- 1/D_race))``. s is the distance to the nearer edge; the sign is +
        on the inner and - on the outer race. From the literature: ``'rect'`` (full depth at once;
        it makes every fixed-step scheme first order), ``'halfsine'``, ``'smooth'``
        (raised-cosine flanks over a quarter of the width).

    Examples
    --------
    >>> Defect(place='outer', width=1e-3, depth=2e-5, angle=-math.pi / 2).profile
    'ball'

    """

    place: Place = quantity(..., 'Part of the bearing.', choices=PLACES)
    width: float = quantity(
        ..., 'Width of the defect along the rolling direction.', 'm', 0.05e-3, MAX_WIDTH
    )
    depth: float = quantity(..., "Depth of the defect (the paper's C_d0).", 'm', 0.0, 0.5e-3)
    angle: float = quantity(0.0, 'Centre of the defect.', 'rad', -2.0 * math.pi, 2.0 * math.pi)
    ball: int = 0
    profile: Profile = quantity(
        'ball',
        'Path of a ball through the defect: from the geometry (ball), or of the literature.',
        choices=PROFILES,
    )

    def __post_init__(self) -> None:
        check_fields(self, 'defect ')
        check_whole('defect ball', self.ball)


@dataclass(frozen=True, kw_only=True)
class TwinParameters:
    """
    Validated parameters of the equations of motion.

    Sources: [P] Symmetry 2023, 15, 2166; [M] Mishra et al., J. Sound Vib. 2017, table 1; [S]
    Sawalhi and Randall, Mech. Syst. Signal Process. 2008, and theses of the same group; [C] Cheng
    et al. 2019, table 1; [D] D'Elia, Cocconcelli, Mucchi 2016 (generator of bearing signals).

    Parameters
    ----------
    bearing
        Geometry: one row of balls with a contact angle of at most 45 deg. The model has no axial
        load, although a bearing with a contact angle needs one.
    thermal_mode
        ``'paper'``: stiffness and defect depth follow `beta0`. ``'physical'``: ring temperatures,
        clearance, E(T), lubricant and slip.
    defects
        Up to 8 defects at once. Two of them on one race, ball or pocket must not overlap.
    load, load_angle
        Radial load and its direction. The shaft spring is grounded and would carry most of an
        applied force. Instead its foot is placed so that the bearing carries the load. The
        direction is constant.
    clearance
        c_r (6307 CN: RIC 6 to 20 um). In the physical mode it must stay in its range at every
        temperature of the outer ring, 20 to 110 degC.
    hertz_stiffness
        K_b0; None: from the geometry (6307 of the catalogue 1.228e10).
    contact_damping
        c_b [C].
    inner_mass, inner_stiffness, inner_damping
        Rotor and shaft [M]; K_rin and C_rin of [P]. Without damping of both rings the passing
        balls can excite a growing motion (parametric resonance).
    outer_mass, outer_stiffness, outer_damping, outer_stiffness_x, outer_damping_x
        Housing [M]. K_2 and C_2 of [P] act vertically. K_1 and C_1, whose names end in ``_x``, act
        horizontally; None: equal to the vertical ones.
    unbalance
        m_u e.
    slip_model, slip
        ``'constant'``: s = `slip`. ``'mu_proportional'``: s = `slip` mu(T)/mu0; the default of
        0.0965 % gives the paper's 126.42 and 126.82 Hz. ``'traction'``: the balance of oil drag
        and ball traction in `thermal.slip`. None: ``'mu_proportional'`` in the paper's mode,
        ``'traction'`` in the physical mode.
    jitter
        Irregularity of the impacts [D].
    resonance_hz, resonance_damping
        Sensor resonance [S].
    waviness
        0 for perfect surfaces. The default is a choice, not a class of a standard. A velocity from
        a bearing vibration test can be used directly. The module `waviness` also tells how to
        convert a roundness trace.
    beta0
        The paper's factor and its switches.
    lubricant
        Oil, for friction and life.
    network
        Heat capacity and conductances of the rings, for the physical mode; see `thermal_network`.
    friction_series
        None: the series of the bearing, or '62' if it is not in the catalogue.
    dynamic_rating, fatigue_limit
        C and C_u; None: C from the maker or ISO 281, C_u as C_0/22 (ISO 281).
    start_angle
        With the default, ball 0 and the mark of the shaft start at the bottom: under a load that
        acts downwards an inner race defect at angle 0 is struck at t = 0.

    Examples
    --------
    >>> from bearing_twin.bearing import find_bearing
    >>> worn = TwinParameters(
    ...     bearing=find_bearing('6205'), defects=(Defect(place='outer', width=1e-3, depth=2e-5),)
    ... )
    >>> worn.load, round(1e-9 * worn.k_b0, 2)
    (500.0, 9.42)

    """

    bearing: Bearing
    thermal_mode: ThermalMode = quantity(
        'paper',
        'Temperature law. paper: beta0 of tables 1-3; whether impacts weaken depends on the '
        'preset. physical: ring temperatures and clearance; impacts weaken once the rings '
        'have settled with the inner one hotter.', choices=THERMAL_MODES,
    )  # fmt: skip
    defects: tuple[Defect, ...] = ()
    load: float = quantity(500.0, 'Radial load on the bearing.', 'N', 10.0, 50e3)
    load_angle: float = quantity(
        DOWN, 'Direction of the load on the shaft, from +x. The default is downwards.', 'rad',
        -2.0 * math.pi, 2.0 * math.pi,
    )  # fmt: skip
    clearance: float = quantity(
        5e-6, 'Radial clearance (half the radial internal clearance) with both rings at the same '
        'temperature: -5 to 50 um for a pitch diameter of 57.5 mm (6307), others in proportion.',
        'm', -50e-6, 500e-6,
    )  # fmt: skip
    hertz_stiffness: float | None = quantity(
        None, 'Hertz coefficient K_b0: radial force over deformation^1.5.', 'N/m^1.5', 1e8, 1e12,
        special=(None, 'from the geometry'),
    )  # fmt: skip
    contact_damping: float = quantity(
        300.0, 'Contact damping of a loaded ball.', 'N s/m', 0.0, 1500.0
    )
    inner_mass: float = quantity(6.2638, 'Mass of rotor and shaft.', 'kg', 0.1, 500.0)
    inner_stiffness: float = quantity(7.42e7, 'Stiffness of the shaft.', 'N/m', 1e5, 1e10)
    inner_damping: float = quantity(1376.8, 'Damping of the shaft.', 'N s/m', 0.0, 1e6)
    outer_mass: float = quantity(12.638, 'Mass of the housing.', 'kg', 0.1, 500.0)
    outer_stiffness: float = quantity(
        1.51e7, 'Stiffness of the housing, vertical (K_2).', 'N/m', 1e5, 1e10
    )
    outer_damping: float = quantity(
        2210.7, 'Damping of the housing, vertical (C_2).', 'N s/m', 0.0, 1e6
    )
    outer_stiffness_x: float | None = quantity(
        None, 'Stiffness of the housing, horizontal (K_1).', 'N/m', 1e5, 1e10,
        special=(None, 'outer_stiffness'),
    )  # fmt: skip
    outer_damping_x: float | None = quantity(
        None, 'Damping of the housing, horizontal (C_1).', 'N s/m', 0.0, 1e6,
        special=(None, 'outer_damping'),
    )  # fmt: skip
    unbalance: float = quantity(
        0.0, 'Unbalance: mass times eccentricity, at most 1 mm times the mass of the rotor.',
        'kg m', 0.0, 2.5e-2,
    )  # fmt: skip
    slip_model: SlipModel | None = quantity(
        None,
        'Cage slip: none, constant, mu_proportional (to the friction of table 3), or traction '
        '(drag of the oil by Palmgren against the traction of the loaded balls in an EHL film).',
        choices=SLIP_MODELS,
        special=(None, 'mu_proportional with thermal mode paper, traction with physical'),
    )
    slip: float = quantity(
        0.000965, 'Cage slip of the slip models constant and, at 20 degC, mu_proportional.', '',
        0.0, 0.05,
    )  # fmt: skip
    start_angle: float = quantity(
        DOWN, 'Angle of ball 0 and of the mark of the shaft at sample 0, from +x.', 'rad',
        -2.0 * math.pi, 2.0 * math.pi, running=False,
    )  # fmt: skip
    jitter: float = quantity(
        0.005,
        'Standard deviation of the angle between two impacts, as a fraction of the ball spacing.',
        '', 0.0, 0.05,
    )  # fmt: skip
    # Healthy machines: 0.2 (floor) to 0.7 m/s^2 on an unloaded motor, 3 to 6 on a loaded bench. A
    # good sensor alone has 0.003 (IEPE) to 0.1 (MEMS), but no machine is that quiet.
    noise: float = quantity(
        0.5, 'Standard deviation of the white noise of sensor and rest of the machine.', 'm/s^2',
        0.0, 100.0,
    )  # fmt: skip
    resonance_hz: float = quantity(
        6000.0, 'Resonance frequency of the sensor.', 'Hz', 500.0, 11000.0, special=(0.0, 'none')
    )
    resonance_damping: float = quantity(
        0.04, 'Damping ratio of the resonance of the sensor.', '', 0.005, 0.7
    )
    waviness: float = quantity(
        50e-6,
        'Waviness of races and balls: RMS velocity in each band of the vibration test of ISO '
        '15242. The default is chosen for a bearing of ordinary quality; no standard sets it.',
        'm/s', 1e-6, 1e-3, special=(0.0, 'perfect surfaces'),
    )  # fmt: skip
    beta0: Beta0 = field(default_factory=Beta0)
    lubricant: Lubricant = field(default_factory=Lubricant)
    network: ThermalNetwork = field(default_factory=ThermalNetwork)
    friction_series: str | None = quantity(
        None, 'Series of the SKF friction model.', choices=tuple(SERIES),
        special=(None, "the bearing's own"),
    )  # fmt: skip
    dynamic_rating: float | None = quantity(
        None, 'C of ISO 281.', 'N', 10.0, 1e8, special=(None, 'from the geometry')
    )
    fatigue_limit: float | None = quantity(
        None, 'C_u of ISO 281.', 'N', 1.0, 1e7, special=(None, 'from the geometry')
    )

    def __post_init__(self) -> None:
        check_bearing(self.bearing)
        check_fields(self)
        for name, kind in (
            ('beta0', Beta0),
            ('lubricant', Lubricant),
            ('network', ThermalNetwork),
        ):
            check_kind(name, getattr(self, name), kind, f'make one with {kind.__name__}()')
        check_kind('defects', self.defects, Sequence, 'give a tuple of Defect')
        for index, defect in enumerate(self.defects):
            check_kind(f'defects[{index}]', defect, Defect, 'give a tuple of Defect')
        about = quantities(TwinParameters)
        about['hertz_stiffness'][1].check('hertz_stiffness', self.k_b0)
        about['friction_series'][1].check(
            'friction_series', self.friction_series or self.bearing.series or None
        )
        check_range(
            'unbalance over inner_mass',
            self.unbalance / self.inner_mass,
            0.0,
            MAX_ECCENTRICITY,
            'm',
        )
        if self.slip_law == 'mu_proportional':
            hottest = self.slip * float(FRICTION_TABLE.max()) / self.beta0.reference_friction
            check_range('slip at the highest friction of table 3', hottest, 0.0, 0.3, '(slip)')
        if len(self.defects) > MAX_DEFECTS:
            msg = f'{len(self.defects)} defects are more than {MAX_DEFECTS}; merge some'
            raise BearingTwinError(msg)
        for index, defect in enumerate(self.defects):
            self._check_defect(defect)
            for other in self.defects[:index]:
                self._check_apart(other, defect)
        low, high = clearance_limits(self.bearing.d_pitch)
        check_range('clearance', self.clearance, low, high, f'm for {self.bearing.name}')
        if self.thermal_mode == 'physical':
            self._check_clearance(low, high)

    @property
    def thermal_network(self) -> Scaled:
        """Thermal network in use: `network`, scaled to the bearing."""
        return self.network.scaled(self.bearing.d_pitch)

    @property
    def slip_law(self) -> SlipModel:
        """Slip model in use: `slip_model`, or the default of the thermal mode."""
        physical = self.thermal_mode == 'physical'
        return self.slip_model or ('traction' if physical else 'mu_proportional')

    @property
    def housing_stiffness(self) -> tuple[float, float]:
        """K_1 and K_2 in use, horizontal and vertical, N/m."""
        across = self.outer_stiffness_x
        return self.outer_stiffness if across is None else across, self.outer_stiffness

    @property
    def housing_damping(self) -> tuple[float, float]:
        """C_1 and C_2 in use, horizontal and vertical, N s/m."""
        across = self.outer_damping_x
        return self.outer_damping if across is None else across, self.outer_damping

    @property
    def k_b0(self) -> float:
        """K_b0 in use, N/m^1.5: `hertz_stiffness`, or the value from the geometry."""
        if self.hertz_stiffness is not None:
            return self.hertz_stiffness
        return radial_factor(self.bearing)

    def _check_clearance(self, low: float, high: float) -> None:
        for outer in (TABLE_LOW, TABLE_HIGH):
            excess = self.thermal_network.inner_excess(outer)
            left = self.clearance + clearance_change(outer + excess, outer, self.bearing.d_pitch)
            if not low <= left <= high:
                msg = (
                    f'with the outer ring at {outer:g} degC the inner ring is {excess:+.1f} K '
                    f'from it and leaves a radial clearance of {left * 1e6:.1f} um, outside '
                    f'{low * 1e6:.3g}..{high * 1e6:.3g} um: the bearing would '
                    f'seize or hang loose; change clearance={self.clearance * 1e6:g} um, '
                    f'shaft_ratio={self.network.shaft_ratio:g} or ambient='
                    f'{self.network.ambient:g} degC'
                )
                raise BearingTwinError(msg)

    def _check_apart(self, one: Defect, other: Defect) -> None:
        """Raise an error if two defects overlap on the same surface."""
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
        limit = widest(bearing)
        if defect.width > limit:
            msg = (
                f'{defect.place} defect {defect.width * 1e3:g} mm wide, but the model holds for '
                f'at most {limit * 1e3:.3g} mm on {bearing.name} (half a ball, one ball spacing): '
                'a wider one is no local defect'
            )
            raise BearingTwinError(msg)
