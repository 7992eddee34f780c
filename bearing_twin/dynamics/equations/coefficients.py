# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Coefficients of the equations of motion for given temperatures and speed, compiled.

They are stiffness, defect depth, clearance, slip and the foot of the shaft spring. Viscosity,
friction and life are computed with them. The formulas are plain functions in
`bearing_twin.thermal`; here they are combined for one bearing, fast enough for a fleet, which
evaluates them a thousand times a block. The equations with the contact law are in `model`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from bearing_twin.bearing import contact_pressure
from bearing_twin.dynamics.equations import layout
from bearing_twin.dynamics.equations.layout import COS, Record, Records, SIN
from bearing_twin.dynamics.equations.model import Contact, contact_law
from bearing_twin.dynamics.equations.statics import (
    against_load,
    equilibrium,
    healthy_balls,
    spring_position,
    Supports,
    supports,
)
from bearing_twin.dynamics.parameters import SLIP_MODELS
from bearing_twin.numerics.compiled import compiled
from bearing_twin.thermal import friction, gcr15, life, lubricant, network, slip
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]

# The last name of each list is the number of the names before it.
_ROWS = range(99)

# Elements of the result of `evaluate`. The kernel ramps the first INPUTS of them.
K_B, DEPTH, CLEARANCE, SHAFT_HZ, SLIP, FOOT_X, FOOT_Y, INPUTS, *_ = _ROWS
(
    ALPHA, HARDNESS, FRICTION, BETA0, INNER, OUTER, VISCOSITY, KAPPA, MOMENT, EQUIVALENT, LIFE,
    THERMAL_GAP, CONDITION_SIZE, *_,
) = _ROWS[INPUTS:]  # fmt: skip

# Argument of `evaluate`: one record of constants per bearing.
CONSTANTS = layout.constants(
    'physical k_b0 clearance load up_x up_y across skew along aside n_balls '
    'slip_model slip pressed cosine d_ball gamma alpha_unit expands '
    'delta_h delta_mu reference_temperature reference_hardness reference_friction '
    'd_pitch mean_diameter section astm_a astm_b replenishment '
    'boundary_friction film_friction contamination rolling sliding '
    'dynamic_rating static_rating fatigue_limit inner_capacity ring_to_ring '
    'ring_to_shaft ambient shaft_ratio least_gap most_gap'
)

_CONSTANT, _MU_PROPORTIONAL, _TRACTION = (
    SLIP_MODELS.index(name) for name in ('constant', 'mu_proportional', 'traction')
)

_SKIDDING = slip.HIGHEST_SLIP * (1.0 - 1e-12)

_viscosity = compiled()(lubricant.viscosity)
_rated_viscosity = compiled()(lubricant.rated_viscosity)
_sliding_friction = compiled()(friction.sliding_friction)
_metallic_share = compiled()(friction.metallic_share)
_friction_moment = compiled()(friction.friction_moment)
_power_loss = compiled()(friction.power_loss)
_clearance_change = compiled()(network.clearance_change)
_relative_modulus = compiled()(network.relative_modulus)
_inner_ring_target = compiled()(network.inner_ring_target)
_inner_ring_step = compiled()(network.inner_ring_step)
_beta0 = compiled()(gcr15.beta0)
_equivalent_load = compiled()(life.equivalent_load)
_life_factor = compiled()(life.life_factor)
_life_hours = compiled()(life.life_hours)
_drag = compiled()(slip.drag)
_film_slope = compiled()(slip.film_slope)
_traction = compiled()(slip.traction)


def constants_of(p: TwinParameters) -> Records:
    """
    Return the constants for :func:`evaluate`: one record `CONSTANTS`.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> float(constants_of(preset('incipient'))['load'][0])
    500.0

    """
    (across, skew, along), aside = supports(p)
    up_x, up_y = against_load(p)
    bearing, oil = p.bearing, p.lubricant
    # Mean pressure under 1 N, geometric mean of both contacts; it is 2/3 of the maximum pressure.
    inner, outer = (contact_pressure(bearing, 1.0, race=race) for race in ('inner', 'outer'))
    expands, delta_h, delta_mu, _, _ = p.beta0.weights
    astm_a, astm_b = oil.astm_constants
    rolling, sliding = friction.SERIES[
        p.friction_series or bearing.series or friction.UNKNOWN_SERIES
    ]
    least_gap, most_gap = network.clearance_limits(bearing.d_pitch)
    return layout.filled(
        CONSTANTS, p, bearing, oil, p.thermal_network, p.beta0,
        physical=p.thermal_mode == 'physical', slip_model=SLIP_MODELS.index(p.slip_law),
        up_x=up_x, up_y=up_y, across=across, skew=skew, along=along, aside=aside,
        pressed=math.sqrt(inner * outer) / 1.5, cosine=math.cos(bearing.contact_angle),
        expands=expands, delta_h=delta_h, delta_mu=delta_mu,
        section=friction.section_height(bearing), astm_a=astm_a, astm_b=astm_b,
        rolling=rolling, sliding=sliding, static_rating=life.static_rating(bearing),
        dynamic_rating=p.dynamic_rating or life.dynamic_rating(bearing),
        fatigue_limit=p.fatigue_limit or life.fatigue_limit(bearing),
        least_gap=least_gap, most_gap=most_gap,
    )  # fmt: skip


@compiled()
def evaluate(constants: Records, outer: float, inner: float, hz: float, out: FloatArray) -> None:
    """
    Fill ``out`` (CONDITION_SIZE) for ring temperatures in degC and a shaft speed in Hz.

    In the paper's mode ``inner`` is not used, the ring temperatures are NaN, and the lubricant has
    the measured temperature. In the physical mode the clearance of the equations, CLEARANCE, is
    limited as in `thermal.network`; THERMAL_GAP is the clearance without limits.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> constants, out = constants_of(preset('paper')), np.empty(CONDITION_SIZE)
    >>> evaluate(constants, 110.0, 110.0, 25.0, out)
    >>> round(float(out[BETA0]), 3)
    1.13

    """
    c = constants[0]
    alpha = np.interp(outer, gcr15.TEMPERATURES, gcr15.EXPANSION_TABLE) * c.alpha_unit
    hardness = np.interp(outer, gcr15.TEMPERATURES, gcr15.HARDNESS_TABLE)
    mu = np.interp(outer, gcr15.TEMPERATURES, gcr15.FRICTION_TABLE)
    out[ALPHA], out[HARDNESS], out[FRICTION], out[SHAFT_HZ] = alpha, hardness, mu, hz
    if c.physical == 0.0:
        references = c.reference_hardness, c.reference_friction
        weights = (c.expands, c.delta_h, c.delta_mu, *references)
        factor = _beta0(outer - c.reference_temperature, alpha, hardness, mu, weights)
        out[K_B], out[DEPTH], out[BETA0] = factor * c.k_b0, factor, factor
        out[CLEARANCE] = out[THERMAL_GAP] = c.clearance
        # The paper has one temperature; it suffices for lubricant and life.
        out[INNER] = out[OUTER] = math.nan
        _lubricate(c, outer, outer, hz, out)
    else:
        at_rings(c, outer, inner, hz, out)
    held = Supports((c.across, c.skew, c.along), c.aside)
    spring = spring_position(c.load, _contact(out), out[CLEARANCE], held, int(c.n_balls))
    out[FOOT_X] = c.up_x * spring + c.up_y * c.aside
    out[FOOT_Y] = c.up_y * spring - c.up_x * c.aside
    model, out[SLIP] = c.slip_model, 0.0
    if model == _CONSTANT:
        out[SLIP] = c.slip
    elif model == _MU_PROPORTIONAL:
        out[SLIP] = c.slip * mu / c.reference_friction
    elif model == _TRACTION:
        out[SLIP] = _slip(c, out)


@compiled()
def at_rings(c: Record, outer: float, inner: float, hz: float, out: FloatArray) -> None:
    """Fill ``out`` with the results of the ring temperatures, except spring foot and slip."""
    out[DEPTH] = out[BETA0] = 1.0
    out[INNER], out[OUTER] = inner, outer
    _fit(c, outer, inner, out)
    _lubricate(c, outer, inner, hz, out)


@compiled()
def skids(constants: Records, values: FloatArray) -> bool:
    """
    Whether the traction of the balls does not suffice; ``values`` come from `evaluate`.

    The comparison has a tolerance, since a slip that is a sum of parts may differ from the highest
    slip in the last bit.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> constants = constants_of(preset('paper', thermal_mode='physical', load=20.0))
    >>> values = np.empty(CONDITION_SIZE)
    >>> evaluate(constants, 20.0, 20.0, 50.0, values)
    >>> skids(constants, values)
    True

    """
    return bool(constants[0].slip_model == _TRACTION and values[SLIP] >= _SKIDDING)


@compiled()
def _contact(values: FloatArray) -> Contact:
    """Return the contact parameters without damping, for equilibrium."""
    return Contact(values[K_B], 0.0)


@compiled()
def _equilibrium_displacement(
    c: Record, values: FloatArray, balls: FloatArray
) -> tuple[float, float]:
    """Return the displacement between the rings in equilibrium, m, in the load's frame."""
    x, y = values[FOOT_X], values[FOOT_Y]
    foot = c.up_y * x - c.up_x * y, c.up_x * x + c.up_y * y
    stood = equilibrium(foot, _contact(values), (c.across, c.skew, c.along), balls, foot)
    return stood[0], stood[1]


@compiled()
def _slip(c: Record, values: FloatArray) -> float:
    """Slip at which ball traction equals drag, see `thermal.slip`; Newton's method from below."""
    hz, n, clearance = values[SHAFT_HZ], int(c.n_balls), values[CLEARANCE]
    if hz == 0.0:
        return 0.0
    rpm, nu, race = 60.0 * hz, values[VISCOSITY], c.d_pitch * (1.0 - c.gamma)
    braked = _drag(rpm, nu, c.mean_diameter, race)
    metallic = _metallic_share(rpm, nu, c.mean_diameter)
    rolling = 0.5 * math.pi * hz * race * (1.0 + c.gamma)
    # Force, mean pressure and film slope of the loaded balls, averaged over two cage positions.
    pressed, loaded = np.empty((2 * n, 3)), 0
    for half in range(2):
        balls = healthy_balls((half / n - 0.5) * math.pi, clearance, n)
        x, y = _equilibrium_displacement(c, values, balls)
        for k in range(n):
            delta = x * balls[COS, k] + y * balls[SIN, k] - clearance
            if delta > 0.0:
                force = contact_law(delta, _contact(values))[0] / c.cosine
                pressure = c.pressed * force ** (1.0 / 3.0)
                slope = _film_slope(pressure, force, nu, rolling, c.d_ball)
                pressed[loaded] = force, pressure, slope
                loaded += 1
    slid = 0.0
    for _ in range(100):
        given, growth = 0.0, 0.0
        for k in range(loaded):
            force, pressure, slope = pressed[k, 0], pressed[k, 1], pressed[k, 2]
            mu, rise = _traction(slid, pressure, slope, metallic, c.boundary_friction)
            given += force * mu
            growth += force * rise
        step = (braked - given) / growth
        slid += step
        if not (step > 1e-12 * slid and slid < slip.HIGHEST_SLIP):
            break
    return min(slid, slip.HIGHEST_SLIP)


@compiled()
def highest_ball_force(constants: Records, values: FloatArray) -> float:
    """
    Radial force on a ball in the direction of the load, N; ``values`` come from `evaluate`.

    Examples
    --------
    One of eight balls carries somewhat less than 5/8 of 3.2 kN:

    >>> from bearing_twin.dynamics import preset
    >>> constants, values = constants_of(preset('paper')), np.empty(CONDITION_SIZE)
    >>> evaluate(constants, 20.0, 20.0, 25.0, values)
    >>> round(highest_ball_force(constants, values))
    1832

    """
    c = constants[0]
    balls = healthy_balls(-0.5 * math.pi, values[CLEARANCE], int(c.n_balls))
    _, y = _equilibrium_displacement(c, values, balls)
    force: float = contact_law(max(-y - values[CLEARANCE], 0.0), _contact(values))[0]
    return force


@compiled()
def _fit(c: Record, outer: float, inner: float, out: FloatArray) -> None:
    """Fill in contact stiffness and clearance at the ring temperatures."""
    out[K_B] = c.k_b0 * _relative_modulus(0.5 * (inner + outer))
    gap = c.clearance + _clearance_change(inner, outer, c.d_pitch)
    out[THERMAL_GAP] = gap
    out[CLEARANCE] = min(max(gap, c.least_gap), c.most_gap)


@compiled()
def _lubricate(c: Record, outer: float, inner: float, hz: float, out: FloatArray) -> None:
    """Fill in viscosity at the mean ring temperature, kappa, friction moment and life."""
    load = _equivalent_load(c.load, out[K_B], out[CLEARANCE], int(c.n_balls))
    # The friction model has no preload; the equivalent load is a lower bound of its effect.
    rubbing = max(c.load, load) if out[CLEARANCE] < 0.0 else c.load
    rpm = 60.0 * hz
    nu = _viscosity(0.5 * (inner + outer), c.astm_a, c.astm_b)
    mu = _sliding_friction(
        _metallic_share(rpm, nu, c.mean_diameter),
        c.boundary_friction,
        c.film_friction,
    )
    kappa = nu / _rated_viscosity(rpm, c.mean_diameter)
    out[VISCOSITY], out[KAPPA], out[EQUIVALENT] = nu, kappa, load
    out[MOMENT] = _friction_moment(
        rpm, nu, rubbing, c.mean_diameter, c.section, c.rolling, c.sliding,
        c.replenishment, mu,
    )  # fmt: skip
    factor = _life_factor(kappa, c.contamination * c.fatigue_limit / load)
    out[LIFE] = _life_hours(factor, load, rpm, c.dynamic_rating, c.static_rating)


@compiled()
def inner_temperature(
    constants: Records, outer: float, inner: float, hz: float, duration: float
) -> float:
    """
    Inner ring temperature after ``duration`` s, degC; the steady state for infinite duration.

    It is limited to the range of `thermal.network`.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> constants = constants_of(preset('incipient', thermal_mode='physical'))
    >>> round(inner_temperature(constants, 60.0, 60.0, 25.0, 1.0), 1)
    60.4
    >>> round(inner_temperature(constants, 60.0, 60.0, 25.0, math.inf), 1)
    63.3

    """
    c = constants[0]
    out = np.zeros(CONDITION_SIZE)
    start = inner if duration < math.inf else outer
    for _ in range(1 if duration < math.inf else 30):
        _fit(c, outer, start, out)
        _lubricate(c, outer, start, hz, out)
        shaft = c.ambient + c.shaft_ratio * (outer - c.ambient)
        target = _inner_ring_target(
            outer, shaft, _power_loss(out[MOMENT], 60.0 * hz), c.ring_to_ring,
            c.ring_to_shaft,
        )  # fmt: skip
        start = (
            _inner_ring_step(
                inner,
                target,
                duration,
                c.inner_capacity,
                c.ring_to_ring,
                c.ring_to_shaft,
            )
            if duration < math.inf
            else target
        )
        start = min(max(start, network.RING_LOW), network.RING_HIGH)
    return start
