# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Claims about the equations: dimensions, signs, brackets, solver, and what is missing."""

from __future__ import annotations

from collections.abc import Callable
import functools
import math
from typing import TYPE_CHECKING

from bearing_twin.dynamics import Defect, preset, TwinParameters
from bearing_twin.dynamics.equations.stability import steps, system_matrices
from bearing_twin.dynamics.reference import solve
from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims.claim import Claim, percents, same_direction, within
from bearing_twin.paper.dimensions import dimension
from bearing_twin.paper.settings import COLD, HOT
from bearing_twin.quantity import quantities
import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

if TYPE_CHECKING:
    from bearing_twin.paper.study import Study


_Law = Callable[..., tuple[float, float]]

RK4_LIMIT = 2.78
"""Extent of the stability region of RK4 along both axes, |h lambda|."""
SAMPLE_RATE = 25600.0
SOLVED = 1280
"""Samples over which two solvers are compared: six impacts."""


def model_claims(study: Study) -> list[Claim]:
    """Judge equations 5 to 8 and 16 to 25, the solver and the completeness of the description."""
    return [
        *_geometry_claims(),
        *_dimension_claims(),
        *_resultant_claims(),
        _friction_equation(),
        _solver(),
        _absolute(study),
    ]


def static_position(parameters: TwinParameters, beta0: float = 1.0) -> float:
    """
    Vertical displacement of the inner ring at which the balls carry the load, m.

    One ball stands in the load direction, so that there is no horizontal force. ``beta0`` scales
    the stiffness of the contacts.
    """
    theta = equations.ball_angles(parameters.bearing.n_balls, -math.pi / 2)

    def excess(y: float) -> float:
        k_b = beta0 * parameters.k_b0
        _, f_y = equations.total_force(0.0, y, theta, parameters.clearance, k_b)
        return -f_y - parameters.load

    return float(brentq(excess, -1e-3, 0.0, xtol=1e-15))


def system_matrix(parameters: TwinParameters, beta0: float = 1.0) -> npt.NDArray[np.float64]:
    """
    State matrix (8, 8) of the model linearised at static equilibrium, contact loaded.

    ``beta0`` scales the stiffness of the contacts.
    """
    p = parameters
    theta = equations.ball_angles(p.bearing.n_balls, -math.pi / 2)
    y = static_position(p, beta0)
    delta = equations.deformation_eq8(0.0, y, theta, p.clearance)
    slope = 1.5 * beta0 * p.k_b0 * np.sqrt(np.maximum(delta, 0.0))
    loaded = np.where(delta > 0.0, p.contact_damping, 0.0)
    normals = np.array([np.cos(theta), np.sin(theta)])
    contact_k, contact_c = ((normals * row) @ normals.T for row in (slope, loaded))
    stiffness, damping = system_matrices(p, contact_k, contact_c)
    return np.block([[np.zeros((4, 4)), np.eye(4)], [-stiffness, -damping]])


def circulation(*, as_printed: bool) -> float:
    """
    Return the skew part of the contact stiffness over its norm; 0 if the forces have a potential.

    The law is equation 7 as printed, or equation 8 as read. The preset `paper` is displaced by 2
    um sideways from static equilibrium, with the balls a tenth of a spacing off the load
    direction.
    """
    p = preset('paper', bearing=settings.BEARING)
    theta = equations.ball_angles(p.bearing.n_balls, -math.pi / 2 + 0.1 * math.tau / 8)
    law: _Law = equations.forces_as_printed if as_printed else equations.total_force
    at, step = (2e-6, static_position(p)), 1e-9
    jacobian = np.empty((2, 2))
    for column, (dx, dy) in enumerate(((step, 0.0), (0.0, step))):
        after = law(at[0] + dx, at[1] + dy, theta, p.clearance, p.k_b0)
        before = law(at[0] - dx, at[1] - dy, theta, p.clearance, p.k_b0)
        jacobian[:, column] = np.subtract(after, before) / (2.0 * step)
    return float(abs(jacobian[0, 1] - jacobian[1, 0]) / np.linalg.norm(jacobian))


def _geometry_claims() -> list[Claim]:
    p = preset('paper', bearing=settings.BEARING)
    y = static_position(p)
    theta = equations.ball_angles(p.bearing.n_balls, -math.pi / 2)
    delta = equations.deformation_eq8(0.0, y, theta, p.clearance)
    with np.errstate(invalid='ignore'):
        printed = p.k_b0 * delta**1.5
    read = equations.ball_forces(delta, p.k_b0)
    undefined = int(np.isnan(printed).sum())
    turned = math.pi / 2 - theta
    same = np.allclose(
        equations.deformation_eq5(1e-6, y, turned, p.clearance),
        equations.deformation_eq8(1e-6, y, theta, p.clearance),
        rtol=1e-12,
    )
    mixed = np.allclose(
        equations.deformation_eq5(1e-6, y, theta, p.clearance),
        equations.deformation_eq8(1e-6, y, theta, p.clearance),
    )
    skew = {'as printed': circulation(as_printed=True), 'as read': circulation(as_printed=False)}
    return [
        Claim(
            id='angle-convention',
            where='equations 5 and 6 against 7 and 8',
            claim='x sin(theta) + y cos(theta) and x cos(theta) + y sin(theta) are both delta_i',
            paper_value='same symbol delta_i',
            our_value={'same theta': mixed, 'theta counted from the vertical in equation 5': same},
            as_printed={'same theta': mixed},
            as_read={'theta from the vertical in equation 5': same},
            why='Rule: equal for all balls. Reading taken: equation 8, theta from +x.',
        ),
        Claim(
            id='projection-of-forces',
            where='equation 7',
            claim='components F_X and F_Y of the contact forces',
            paper_value='elastic forces',
            our_value=skew,
            as_printed={'equation 7': skew['as printed'] < 1e-6},
            as_read={'equation 8': skew['as read'] < 1e-6},
            why=(
                'Rule: elastic forces have a potential, so dF_X/dy = dF_Y/dx (skew part of the '
                'stiffness over its norm below 1e-6). Equation 7 uses another deformation in '
                'each component and projects F_X with sin; such a bearing creates energy.'
            ),
        ),
        Claim(
            id='unloaded-balls',
            where='equations 6 to 8',
            claim='no contact force outside the load zone',
            paper_value=0.0,
            our_value={'as printed, undefined forces': undefined, 'of balls': len(theta)},
            as_printed={
                'as the text says, max(delta, 0)^1.5': bool(np.all(read[delta <= 0.0] == 0.0))
            },
            why=(
                'Rule: force 0 where delta <= 0, `paper` at rest. The text says so in words; the '
                'equations leave it out: delta^1.5 of a negative number is not real.'
            ),
        ),
    ]


def _dimension_claims() -> list[Claim]:
    damping, drawn = settings.C_D_UNIT, settings.AMPLITUDE_UNIT
    acceleration = dimension('N/kg')
    depth = quantities(Defect)['depth'][1].unit
    length = dimension(quantities(TwinParameters)['clearance'][1].unit)
    return [
        Claim(
            id='c-d-is-a-depth',
            where='equation 8, section 3 first paragraph',
            claim="'friction damping C_d' is subtracted from the clearance",
            paper_value=f'damping, {damping}',
            our_value={
                f'exponents of kg, m, s, A in {unit}': dimension(unit)
                for unit in dict.fromkeys((damping, depth))
            },
            as_printed={f'C_d a damping, {damping}': dimension(damping) == length},
            as_read={
                f'C_d the depth of the spall, {depth}, b its switch': dimension(depth) == length
            },
            why=(
                'Rule: what is subtracted from x, y and c_r is a length, as they are. Equation 8 '
                'is the published defect '
                'model with depth C_d and switch beta (Feng; Sawalhi and Randall; Mishra 2017). '
                "Section 3 also calls K_b, a stiffness, 'friction damping'."
            ),
        ),
        Claim(
            id='amplitude-in-volts',
            where='sections 3.1 to 3.4, waterfall figures',
            claim="the axis 'amplitude V' shows acceleration",
            paper_value=drawn,
            our_value={'exponents of kg, m, s, A': acceleration},
            as_printed=None if drawn is None else {drawn: dimension(drawn) == acceleration},
            why=(
                'Rule: the unit has the dimension of F/m, equation 19. t, V and T name the axes; '
                'no unit and no sensitivity is given.'
            ),
        ),
    ]


def _resultant_claims() -> list[Claim]:
    f_x, f_y = 3.0, 4.0
    p = preset('paper', bearing=settings.BEARING)
    housing, rotor = p.outer_mass, p.inner_mass
    angles = {'pi/2': math.pi / 2, 'pi/3': math.pi / 3, '0': 0.0}
    values = {name: equations.resultant_as_printed(f_x, f_y, a) for name, a in angles.items()}
    right = {name: math.isclose(v, math.hypot(f_x, f_y)) for name, v in values.items()}
    right_angle = {'pi/2': right.pop('pi/2')}
    return [
        Claim(
            id='resultant-angle',
            where='equations 16 and 17',
            claim="'different values are used' for the angle between F_x and F_y",
            paper_value='different angles',
            our_value=values,
            as_printed=right,
            as_read=right_angle,
            why=(
                'Rule: resultant of F_x = 3 N, F_y = 4 N is 5 N. The components are at right '
                'angles, so only pi/2 is right.'
            ),
        ),
        Claim(
            id='acceleration-from-mass',
            where='equation 19',
            claim='a = F/m with the system mass m',
            paper_value=settings.SYSTEM_MASS,
            our_value={'housing_kg': housing, 'rotor_kg': rotor},
            verdict=within(settings.SYSTEM_MASS, housing, 0.01 * housing),
            why=(
                'Rule: mass within 1 % of ours; none is given. Here the acceleration is that of '
                'the housing in the equations of motion.'
            ),
        ),
    ]


def _friction_equation() -> Claim:
    ratio = settings.FORMULA_RATIOS['C_d0/approach=0.7']
    printed = (
        equations.friction_force_as_printed(HOT, ratio)
        / equations.friction_force_as_printed(COLD, ratio)
        - 1.0
    )
    cold, hot = (equations.beta0('friction', t) for t in (COLD, HOT))
    read = float(
        equations.static_force(hot, hot, ratio) / equations.static_force(cold, cold, ratio) - 1.0
    )
    return Claim(
        id='friction-equation',
        where='equations 22 and 23',
        claim='with the friction factor the force decreases with temperature',
        paper_value='decreases',
        our_value=percents({'as printed': printed, 'friction factor in both': read}),
        as_printed={'hardness factor in C_d': same_direction(-1, printed, 0.0)},
        as_read={'friction factor in both': same_direction(-1, read, 0.0)},
        why=(
            'Rule: sign of F(110)/F(20) - 1 at C_d0/approach = 0.7. Equation 23 has the hardness '
            'factor inside C_d, pasted from equation 21, and the weight of friction is printed '
            'as h, the hardness. Reading taken: weight delta_mu, and one factor in both places.'
        ),
    )


@functools.cache
def _solver() -> Claim:
    # It takes seconds and is the same for every study.
    p = preset('paper', bearing=settings.BEARING, jitter=0.0, noise=0.0, waviness=0.0)
    values = np.linalg.eigvals(system_matrix(p))
    radius = float(np.abs(values).max())
    decay = np.abs(values.real)
    ours, exact = (
        solve(p, SOLVED, method=method, rtol=rtol, shaft_hz=settings.SHAFT_HZ).y
        for method, rtol in (('BDF', 1e-6), ('DOP853', 1e-8))
    )
    error = float(np.linalg.norm(ours - exact) / np.linalg.norm(exact))
    return Claim(
        id='ode15s-solves-the-model',
        where='section 2 (2)',
        claim="ode15s, 'for rigid and non-stiff ODEs', solves the model",
        paper_value='ode15s',
        our_value={
            'relative_error': error,
            'fastest_mode_hz': radius / math.tau,
            'decay_ratio': float(decay.max() / decay.min()),
            'rk4_stable_below_us': 1e6 * RK4_LIMIT / radius,
        },
        as_printed={'backward differences, the method of ode15s': error < 0.01},
        why=(
            f'Rule: within 1 % of DOP853 at rtol 1e-8 over {SOLVED / SAMPLE_RATE:g} s, housing '
            "acceleration, at rtol 1e-6. 'Rigid' stands for stiff. The model is not stiff, so an "
            f'explicit method does it too, in {steps(p, SAMPLE_RATE)} steps a sample of 25.6 kHz; '
            'that is no error.'
        ),
    )


def _absolute(study: Study) -> Claim:
    missing = sorted(settings.REQUIRED - settings.DISCLOSED)
    ours = {name: study.trends[name, 'all'][0].amplitude for name in settings.PRESET_NAMES}
    stated = settings.AMPLITUDE_AT_20
    return Claim(
        id='absolute-amplitudes',
        where='figures 4, 9, 16, 23, 28',
        claim='amplitudes of the simulated signals',
        paper_value=stated,
        our_value={f'{name}, m/s^2': value for name, value in ours.items()},
        verdict=within(stated, ours['paper'], 0.1 * ours['paper']),
        why=(
            'Rule: amplitude within 10 %. The text gives none, nor does it give '
            f'{", ".join(missing)}, or any equation of motion: we take cited presets.'
        ),
    )
