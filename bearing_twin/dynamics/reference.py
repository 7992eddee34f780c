# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Reference solution of the model with scipy's adaptive solvers.

It measures the error and speed of the kernels. It shares only the laws of `model` and the random
surface profiles with them. Stiffness, clearance, slip and ring temperatures come from the formulas
of `bearing` and `thermal`; a root finder gives the foot of the shaft spring and the initial
position. Angles are functions of time, the path over a defect is evaluated for every ball, and the
sensor has two more states per axis. Temperature and speed are constant; there is no jitter and no
noise.
"""

from __future__ import annotations

from collections import namedtuple
import math
from time import process_time
from typing import NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import contact_pressure, fault_orders, PLACES
from bearing_twin.dynamics.equations import filters, layout
from bearing_twin.dynamics.equations.layout import CHUNK, SPIN_TURNS
from bearing_twin.dynamics.equations.model import (
    Contact,
    contact_force,
    contact_law,
    defect_path,
    PROFILES,
)
from bearing_twin.dynamics.equations.waviness import profiles
from bearing_twin.dynamics.single.simulator import RUN_IN
from bearing_twin.numerics.compiled import compiled
from bearing_twin.thermal import friction, gcr15, life, network, slip
import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq, root

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]
Records = npt.NDArray[np.void]

_RATE = 25600.0
"""Output rate, Hz."""
_LARGEST_STEP = 1e-4
"""Longest step, s, so that an adaptive solver does not step over a spall."""
_POSITIONS = 8
"""Cage positions over one ball spacing, for the mean load."""
_MICRON = 1e-6
_HEALTHY = np.empty((0, 6))
_SMOOTH = np.empty((0, 1))
_POINTS = 1 << 16
"""Points of a surface profile, with linear interpolation between them."""


class Reference(NamedTuple):
    """Result of an adaptive solver."""

    x: FloatArray
    """Horizontal acceleration, m/s^2, decimated as in the twin."""
    y: FloatArray
    """Vertical acceleration, m/s^2."""
    states: FloatArray
    """Positions and velocities of the rings, and sensor states, (12, n) at the internal rate."""
    cost: float
    """Processor time of the solver per simulated second, s."""


_Constants = namedtuple(
    '_Constants',
    'k_b contact_damping depth clearance cage spin omega start d_ball d_pitch cosine n_balls '
    'inner_mass inner_stiffness inner_damping outer_mass outer_stiffness_x outer_stiffness_y '
    'outer_damping_x outer_damping_y foot_x foot_y unbalance resonance resonance_damping',
)
"""Constants of the equations. Fields with the name of a parameter have its value if nothing else
is given. ``depth`` is a factor on the depth of every defect along the radius. ``cage``, ``spin``
(of the balls) and ``omega`` (of the shaft) are speeds, rad/s. ``cosine`` belongs to the contact
angle. ``foot_x`` and ``foot_y`` are the position of the foot of the shaft spring, m."""
_RECORD = np.dtype([(name, np.float64) for name in _Constants._fields])
"""Record type of the constants; `_balls_force` and `_rates` take an array of one record."""


def solve(
    parameters: TwinParameters,
    samples: int,
    *,
    temperature: float = 20.0,
    shaft_hz: float = 25.4,
    seed: int = 0,
    method: str = 'DOP853',
    rtol: float = 1e-8,
    steps: int | None = None,
) -> Reference:
    """
    Solve the equations with ``scipy.integrate.solve_ivp`` from the initial state of the twin.

    Parameters
    ----------
    parameters, samples
        Parameters of the twin, whose jitter and noise are ignored, and number of samples.
    temperature, shaft_hz
        Outer ring temperature, degC, and shaft speed, Hz; both constant.
    seed
        Seed of the surface profiles.
    method, rtol
        Arguments of ``solve_ivp``.
    steps
        Equal steps per internal sample of the classical fourth-order Runge-Kutta scheme, compiled,
        instead of ``solve_ivp``.

    Examples
    --------
    The kernels agree with the reference:

    >>> from bearing_twin.dynamics import preset, Simulator
    >>> smooth = preset('paper', jitter=0.0, noise=0.0)
    >>> exact = solve(smooth, 64).y
    >>> twin = Simulator(smooth).advance(64, 20.0, 25.4).y
    >>> bool(abs(twin - exact).max() < 1e-3 * abs(exact).max())
    True

    """
    p = parameters
    constants = _constants(p, temperature, shaft_hz)
    values, surfaces = np.array([constants], _RECORD), _surfaces(p, seed)
    defects = np.array(
        [
            (PLACES.index(d.place), PROFILES[d.profile].code, d.width, d.depth, d.angle, d.ball)
            for d in p.defects
        ]
    ).reshape(-1, 6)
    factor = filters.oversampling(_RATE)
    before = CHUNK * math.ceil(RUN_IN * _RATE / CHUNK) * factor if shaft_hz else 0
    times = np.arange(1 - before, samples * factor + 1) / (_RATE * factor)
    first = -before / (_RATE * factor)
    begin = np.zeros(12)
    begin[:4] = _at_rest(constants, defects, surfaces, first)
    tolerance = rtol * np.repeat([1e-5, 1e-2, 1e2], 4)
    known, began = (values, defects, surfaces), process_time()
    if steps:
        states = _equal_steps(begin, first, times, steps, *known)
    else:
        states = solve_ivp(
            _rates, (first, times[-1]), begin, method, times, rtol=rtol, atol=tolerance,
            max_step=_LARGEST_STEP, args=known,
        ).y  # fmt: skip
    cost = (process_time() - began) / (times[-1] - first)
    if p.resonance_hz:
        sensed = -states[[8, 10]] - 2.0 * p.resonance_damping * states[[9, 11]]
    else:
        sensed = np.array(
            [_rates(t, state, *known)[6:8] for t, state in zip(times, states.T, strict=True)]
        ).T
    taps = filters.decimator(factor)
    nothing = np.zeros((2, len(taps) - factor))
    windows = np.lib.stride_tricks.sliding_window_view(
        np.concatenate([nothing, sensed], axis=1), len(taps), axis=1
    )
    x, y = (windows[:, ::factor] @ taps)[:, before // factor :]
    return Reference(x, y, states[:, before:], cost)


def _constants(p: TwinParameters, temperature: float, shaft_hz: float) -> _Constants:
    """Return the constants for an outer ring temperature, degC, and a shaft speed, Hz."""
    bearing, clearance, inner = p.bearing, p.clearance, temperature
    if p.thermal_mode == 'paper':
        factor = p.beta0.at(temperature)
        k_b, depth = factor * p.k_b0, factor
    else:
        inner = _inner_ring(p, temperature, shaft_hz)
        k_b, depth = p.k_b0 * network.relative_modulus(0.5 * (inner + temperature)), 1.0
        clearance += network.clearance_change(inner, temperature, bearing.d_pitch)
    prescribed = {'none': 0.0, 'constant': p.slip, 'traction': 0.0}.get(
        p.slip_law, p.slip * gcr15.friction(temperature) / p.beta0.reference_friction
    )
    orders, omega = fault_orders(bearing, prescribed), 2.0 * math.pi * shaft_hz
    (stiffness_x, stiffness_y), (damping_x, damping_y) = p.housing_stiffness, p.housing_damping
    values = layout.filled(
        _RECORD, p, bearing,
        # Depth is along the contact normal; along the radius the gap is larger.
        k_b=k_b, depth=depth / math.cos(bearing.contact_angle), clearance=clearance,
        cage=omega * orders.ftf, spin=omega * orders.bsf, omega=omega, start=p.start_angle,
        cosine=math.cos(bearing.contact_angle), foot_x=0.0, foot_y=0.0,
        outer_stiffness_x=stiffness_x, outer_stiffness_y=stiffness_y,
        outer_damping_x=damping_x, outer_damping_y=damping_y,
        resonance=2.0 * math.pi * p.resonance_hz,
    )  # fmt: skip
    found = _loaded(p, _Constants(*values.tolist()[0]))
    if p.slip_law == 'traction' and shaft_hz:
        nu = p.lubricant.viscosity(0.5 * (inner + temperature))
        orders = fault_orders(bearing, _held_slip(p, found, nu))
        found = found._replace(cage=omega * orders.ftf, spin=omega * orders.bsf)
    return found


def _loaded(p: TwinParameters, constants: _Constants) -> _Constants:
    """Place the foot of the shaft spring so that the bearing carries the load."""
    angles = 2.0 * math.pi / p.bearing.n_balls * (np.arange(_POSITIONS) + 0.5) / _POSITIONS
    stiffness = np.array(p.housing_stiffness)
    pushed = np.array([math.cos(p.load_angle), math.sin(p.load_angle)])
    # Deflection of shaft and housing under the load; its part across the load is compensated.
    across = np.array([-pushed[1], pushed[0]])
    give = p.load * pushed * (1.0 / p.inner_stiffness + 1.0 / stiffness)

    def moved(by: float) -> _Constants:
        x, y = by * pushed + (give @ across) * across
        return constants._replace(foot_x=x, foot_y=y)

    def excess(by: float) -> float:
        """Mean load of the bearing minus the required load, N."""
        standing = (moved(by)._replace(start=angle + p.load_angle) for angle in angles)
        forces = [stiffness * _at_rest(each, _HEALTHY, _SMOOTH, 0.0)[2:] for each in standing]
        return float(np.mean(forces, axis=0) @ pushed - p.load)

    most = 1e-6
    while excess(most) < 0.0:
        most *= 2.0
    return moved(brentq(excess, 0.0, most, xtol=1e-15, rtol=1e-13))


def _held_slip(p: TwinParameters, constants: _Constants, nu: float) -> float:
    """Return the cage slip at which the traction of the loaded balls equals the oil drag."""
    bearing, oil, hz = p.bearing, p.lubricant, constants.omega / (2.0 * math.pi)
    sizes = 60.0 * hz, nu, bearing.mean_diameter
    metallic = friction.metallic_share(*sizes)
    race = bearing.d_pitch - bearing.d_ball * constants.cosine
    rolling = 0.25 * constants.omega * race * (1.0 + bearing.gamma)
    both = [contact_pressure(bearing, 1.0, race=each) for each in ('inner', 'outer')]
    contacts = []
    for before in (0.0, math.pi / bearing.n_balls):
        standing = constants._replace(start=p.load_angle + before)
        at = _at_rest(standing, _HEALTHY, _SMOOTH, 0.0)
        angles = standing.start + 2.0 * math.pi * np.arange(bearing.n_balls) / bearing.n_balls
        deep = (at[:2] - at[2:]) @ np.array([np.cos(angles), np.sin(angles)]) - constants.clearance
        for approach in deep[deep > 0.0]:
            force = contact_law(approach, Contact(constants.k_b, 0.0))[0] / constants.cosine
            pressure = math.sqrt(both[0] * both[1]) * force ** (1.0 / 3.0) / 1.5
            film = slip.film_slope(pressure, force, nu, rolling, bearing.d_ball)
            contacts.append((force, pressure, film))

    def excess(slid: float) -> float:
        """Traction minus drag, N."""
        of = metallic, oil.boundary_friction
        given = (q * slip.traction(slid, pressure, film, *of)[0] for q, pressure, film in contacts)
        return float(sum(given) - slip.drag(*sizes, race))

    if excess(slip.HIGHEST_SLIP) < 0.0:
        return slip.HIGHEST_SLIP
    return float(brentq(excess, 0.0, slip.HIGHEST_SLIP, xtol=1e-15, rtol=1e-12))


def _inner_ring(p: TwinParameters, outer: float, shaft_hz: float) -> float:
    """Return the steady-state temperature of the inner ring with friction heat, degC."""
    rpm, oil, thermal, bearing = 60.0 * shaft_hz, p.lubricant, p.thermal_network, p.bearing
    least, most = network.clearance_limits(bearing.d_pitch)
    series = p.friction_series or bearing.series or friction.UNKNOWN_SERIES

    def excess(inner: float) -> float:
        nu = oil.viscosity(0.5 * (inner + outer))
        k_b = p.k_b0 * network.relative_modulus(0.5 * (inner + outer))
        left = p.clearance + network.clearance_change(inner, outer, bearing.d_pitch)
        gap = min(max(left, least), most)
        load = p.load
        if gap < 0.0:
            load = max(load, life.equivalent_load(load, k_b, gap, bearing.n_balls))
        sliding = friction.sliding_friction(
            friction.metallic_share(rpm, nu, bearing.mean_diameter),
            oil.boundary_friction,
            oil.film_friction,
        )
        moment = friction.friction_moment(
            rpm, nu, load, bearing.mean_diameter, friction.section_height(bearing),
            *friction.SERIES[series], oil.replenishment, sliding,
        )  # fmt: skip
        power = friction.power_loss(moment, rpm)
        shaft = thermal.shaft(outer)
        return inner - network.inner_ring_target(
            outer, shaft, power, thermal.ring_to_ring, thermal.ring_to_shaft
        )

    return float(brentq(excess, network.RING_LOW, network.RING_HIGH, xtol=1e-12))


def _surfaces(p: TwinParameters, seed: int) -> FloatArray:
    """Return gap profiles, m; rows: outer race and inner race over a turn, balls over a track."""
    if p.waviness == 0.0:
        return _SMOOTH
    turns, rows = np.arange(_POINTS) / _POINTS, []
    for gaps, slopes in profiles(p, seed):
        nodes = np.arange(gaps.shape[1] + 1) / gaps.shape[1]
        around = [np.concatenate([each, each[:, :1]], axis=1) for each in (gaps, slopes)]
        rows.append(CubicHermiteSpline(nodes, *around, axis=1)(turns))
    return np.concatenate(rows)


def _at_rest(
    constants: _Constants, defects: FloatArray, surfaces: FloatArray, time: float
) -> FloatArray:
    """Return the positions x_i, y_i, x_o, y_o in static equilibrium at an instant, m."""
    values = np.array([constants], _RECORD)
    foot = np.array([constants.foot_x, constants.foot_y])
    inner = constants.inner_stiffness
    outer = np.array([constants.outer_stiffness_x, constants.outer_stiffness_y])

    def rings_at(apart: FloatArray) -> FloatArray:
        x, y = apart * _MICRON
        force = np.array(_balls_force(time, x, y, 0.0, 0.0, values, defects, surfaces))
        return np.concatenate([foot - force / inner, force / outer])

    def excess(apart: FloatArray) -> FloatArray:
        at = rings_at(apart)
        return apart - (at[:2] - at[2:]) / _MICRON

    found = root(excess, foot / _MICRON, tol=1e-13)
    return rings_at(found.x)


@compiled()
def _profile(surface: FloatArray, angle: float) -> float:
    """Gap of one surface at an angle, m."""
    at = angle / (2.0 * math.pi)
    at = (at - math.floor(at)) * len(surface)
    point = min(int(at), len(surface) - 1)
    here, there = surface[point], surface[(point + 1) % len(surface)]
    return float(here + (at - point) * (there - here))


@compiled()
def _balls_force(
    t: float,
    x: float,
    y: float,
    vx: float,
    vy: float,
    constants: Records,
    defects: FloatArray,
    surfaces: FloatArray,
) -> tuple[float, float]:
    """Force of the balls on the outer ring, N."""
    m = constants[0]
    d, across, spun = m.d_ball, m.d_ball * m.cosine, m.spin * t
    inner, outer = 0.5 * (m.d_pitch - across), 0.5 * (m.d_pitch + across)
    path_inner, path_outer = 1.0 / d + 0.5 * m.cosine / inner, 1.0 / d - 0.5 * m.cosine / outer
    contact = Contact(m.k_b, m.contact_damping)
    fx = fy = 0.0
    for j in range(int(m.n_balls)):
        angle = m.start + m.cage * t + 2.0 * math.pi * j / m.n_balls
        gap = m.clearance
        if surfaces.shape[0]:
            gap += _profile(surfaces[0], angle)
            gap += _profile(surfaces[1], angle - m.start - m.omega * t)
            gap += _profile(surfaces[2 + j], spun / SPIN_TURNS)
        for i in range(defects.shape[0]):
            place, profile, width, depth, where = defects[i, :5]
            half = 0.5 * width
            if place == 0.0:
                along = _wrap(angle - m.start - m.omega * t - where) * inner
                gap += m.depth * defect_path(profile, half, depth, path_inner, along)[0]
            elif place == 1.0 or (place == 3.0 and defects[i, 5] == j):
                along = _wrap(angle - where) * outer
                gap += m.depth * defect_path(profile, half, depth, path_outer, along)[0]
            elif place == 2.0 and defects[i, 5] == j:
                along = _wrap(spun - where) * 0.5 * d
                gap += m.depth * defect_path(profile, half, depth, path_inner, along)[0]
                along = _wrap(spun - where - math.pi) * 0.5 * d
                gap += m.depth * defect_path(profile, half, depth, path_outer, along)[0]
        c, s = math.cos(angle), math.sin(angle)
        delta = x * c + y * s - gap
        if delta > 0.0:
            force, _ = contact_force(delta, 0.0, vx * c + vy * s, 0.0, contact)
            fx += max(force, 0.0) * c
            fy += max(force, 0.0) * s
    return fx, fy


@compiled()
def _rates(
    t: float, state: FloatArray, constants: Records, defects: FloatArray, surfaces: FloatArray
) -> FloatArray:
    """Time derivative of the 12 states: positions, velocities, sensor along x and y."""
    m = constants[0]
    ki, ci = m.inner_stiffness, m.inner_damping
    x, y = state[0] - state[2], state[1] - state[3]
    vx, vy = state[4] - state[6], state[5] - state[7]
    fx, fy = _balls_force(t, x, y, vx, vy, constants, defects, surfaces)
    pull, turned = m.unbalance * m.omega * m.omega, m.start + m.omega * t
    pulled = pull * math.cos(turned), pull * math.sin(turned)
    rates = np.empty(12)
    rates[:4] = state[4:8]
    rates[4] = (pulled[0] - fx - ki * (state[0] - m.foot_x) - ci * state[4]) / m.inner_mass
    rates[5] = (pulled[1] - fy - ki * (state[1] - m.foot_y) - ci * state[5]) / m.inner_mass
    rates[6] = (fx - m.outer_stiffness_x * state[2] - m.outer_damping_x * state[6]) / m.outer_mass
    rates[7] = (fy - m.outer_stiffness_y * state[3] - m.outer_damping_y * state[7]) / m.outer_mass
    for axis in range(2):
        z, w = state[8 + 2 * axis], state[9 + 2 * axis]
        rates[8 + 2 * axis] = m.resonance * w
        rates[9 + 2 * axis] = -m.resonance * (z + 2.0 * m.resonance_damping * w + rates[6 + axis])
    return rates


@compiled()
def _equal_steps(
    state: FloatArray,
    t: float,
    times: FloatArray,
    steps: int,
    constants: Records,
    defects: FloatArray,
    surfaces: FloatArray,
) -> FloatArray:
    """Integrate with equal steps from the state at ``t``; return states at ``times``, (12, n)."""
    states = np.empty((12, len(times)))
    h = (times[0] - t) / steps
    for sample in range(len(times)):
        for _ in range(steps):
            one = _rates(t, state, constants, defects, surfaces)
            two = _rates(t + 0.5 * h, state + 0.5 * h * one, constants, defects, surfaces)
            three = _rates(t + 0.5 * h, state + 0.5 * h * two, constants, defects, surfaces)
            t += h
            four = _rates(t, state + h * three, constants, defects, surfaces)
            state = state + h / 6.0 * (one + 2.0 * (two + three) + four)
        states[:, sample], t = state, times[sample]
    return states


@compiled()
def _wrap(angle: float) -> float:
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
