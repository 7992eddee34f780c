# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Every numbered equation, evaluated with the paper's own numbers or the preset `paper`."""

from __future__ import annotations

import math

from bearing_twin.dynamics import preset
from bearing_twin.paper import equations, settings
from bearing_twin.paper.claims.model import static_position
from bearing_twin.paper.figures.force import unit_force
from bearing_twin.paper.settings import COLD, HOT
import numpy as np


def equation_table() -> list[tuple[str, str, str, str]]:
    """
    Evaluate equations 1 to 25.

    Returns the number of each, the quantity that it defines, how it is read, and its value with
    unit.
    """
    bearing, shaft = settings.BEARING, settings.SHAFT_HZ
    p = preset('paper', bearing=bearing)
    y = static_position(p)
    omega_c = equations.cage_speed(math.tau * shaft, bearing.d_ball, bearing.d_pitch)
    theta = equations.ball_angles(bearing.n_balls, -math.pi / 2)
    delta = equations.deformation_eq8(0.0, y, theta, p.clearance)
    force = equations.ball_forces(delta, p.k_b0)
    f_x, f_y = equations.total_force(0.0, y, theta, p.clearance, p.k_b0)
    depth = np.where(np.arange(bearing.n_balls) == 0, p.defects[0].depth, 0.0)
    _, with_defect = equations.total_force(0.0, y, theta, p.clearance, p.k_b0, depth)
    ratio = settings.FORMULA_RATIOS['C_d0/approach=0.7']
    component = unit_force() * math.sqrt(0.5)

    def static(factor: settings.Factor) -> str:
        low, high = (
            component * float(equations.static_force(b, b, ratio))
            for b in (equations.beta0(factor, COLD), equations.beta0(factor, HOT))
        )
        return f'F_X = F_Y = {low:.1f} N at 20 °C, {high:.1f} N at 110 °C'

    def factor_at(factor: settings.Factor) -> str:
        low, high = (equations.beta0(factor, t) for t in (COLD, HOT))
        return f'β = {low:.5f} at 20 °C, {high:.5f} at 110 °C'

    at_rest = f'`paper` at rest, {p.load:g} N'
    single = f'one ball, cos θ = sin θ, C_d0 = {ratio:g} δ, δ = {settings.APPROACH * 1e6:g} µm'
    rows = [
        ('cage speed ω_c', 'd ball, D pitch diameter', f'{omega_c:.4f} rad/s'),
        (
            'ball angles θ_i',
            'θ from +x, ball 1 in the load direction',
            f'{np.degrees(theta[0]):.0f}° + {360 / bearing.n_balls:.0f}°(i − 1)',
        ),
        ('x = x_in − x_out', at_rest, '0 µm'),
        ('y = y_in − y_out', at_rest, f'{1e6 * y:.3f} µm'),
        (
            'deformation δ_i',
            'as equation 8, θ from +x',
            f'largest {1e6 * delta.max():.3f} µm; {int((delta > 0).sum())} of 8 balls loaded',
        ),
        ('ball force F_i', 'K max(δ, 0)^1.5', f'largest {force.max():.1f} N'),
        (
            'F_X, F_Y',
            'one δ_i in both; F_X with cos, F_Y with sin',
            f'{f_x:.1f} N, {f_y:.1f} N (load {p.load:g} N)',
        ),
        (
            'F_X, F_Y with defect',
            'C_d = spall depth, b its switch',
            f'F_Y = {with_defect:.1f} N with ball 1 in a spall of {depth.max() * 1e6:g} µm',
        ),
        ('f_in', '', f'{equations.inner_frequency(bearing, shaft):.5f} Hz'),
        ('f_out', '', f'{equations.outer_frequency(bearing, shaft):.5f} Hz'),
        (
            'f_b',
            'ball spin; a ball defect strikes at 2 f_b',
            f'{equations.ball_frequency(bearing, shaft):.5f} Hz',
        ),
        ('f_c', '', f'{equations.cage_frequency(bearing, shaft):.5f} Hz'),
        (
            'expansion coefficient α',
            'instantaneous: strain = ∫α dT',
            f'strain 20 to 110 °C {equations.alpha_strain(HOT):.5f}, '
            f'α(T)(T − T0) {equations.expansion_term(HOT):.5f}',
        ),
        ('K_b, C_d with expansion', 'α in 10⁻⁵/K', factor_at('expansion')),
        ('force with expansion', single, static('expansion')),
        ('F = F_x + F_y', 'sum of vectors, b = 0', f'({component:.1f}, {component:.1f}) N'),
        ('F', 'angle π/2: F = √(F_x² + F_y²)', f'{unit_force():.1f} N (b = 0)'),
        ('tan α = F_x/F_y', 'angle from the y axis', '1 (45°) for cos θ = sin θ'),
        (
            'a = F/m',
            "m is not given; the preset's housing. The simulation integrates instead",
            f'{unit_force() / p.outer_mass:.1f} m/s² with {p.outer_mass:g} kg',
        ),
        ('K_b, C_d with hardness', 'H0 = 63.6 HRC', factor_at('hardness')),
        ('force with hardness', single, static('hardness')),
        ('K_b, C_d with friction', 'weight Δμ, not Δh', factor_at('friction')),
        ('force with friction', f'friction in both places; {single}', static('friction')),
        (
            'β0, K_b and C_d',
            f'Δh = {settings.DELTA_H:g}, Δμ = {settings.DELTA_MU:g}',
            factor_at('all'),
        ),
        ('force with all factors', single, static('all')),
    ]
    return [
        (str(number), quantity, reading or 'as printed', value)
        for number, (quantity, reading, value) in enumerate(rows, start=1)
    ]
