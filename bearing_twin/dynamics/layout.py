# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where what stands in the arrays of the compiled kernel of one bearing."""

from __future__ import annotations

# The state: x_i, y_i, x_o, y_o; then velocity, acceleration and jerk of each.
Q, V, A, J = 0, 4, 8, 12
CAGE, SHAFT, SPIN = 16, 17, 18  # phases, turns
CAGE_COS, CAGE_SIN, SHAFT_COS, SHAFT_SIN = 19, 20, 21, 22
RESONATOR = 23  # two states of x, two of y
TOUCHING, NEAR = 27, 28  # loaded balls, one bit each; see `contact`
QP, VP, AP = 29, 33, 37  # positions, velocities, accelerations predicted for the next step
EXPECTED = 41  # the step that is predicted, s
STATE_SIZE = 42

# Constants of one bearing.
(
    MI, KI, CI, MO, KO, CO, CB, UNBALANCE, FTF_ORDER, SPIN_ORDER, JITTER, NOISE_STD, STEP,
    D_BALL, R_INNER, R_OUTER, RESONANCE, RESONANCE_DAMPING, SNAPS,
) = range(19)  # fmt: skip
CONST_SIZE = 19

# Columns of a defect: place, profile, half width (m), depth (m), angle (turns), ball, curvature of
# the path on the inner and on the outer race (1/m), distance from the centre at which the path has
# a kink there besides that at the edges (m, negative for none).
(
    PLACE, PROFILE, HALF, FULL_DEPTH, ANGLE, BALL, PATH_INNER, PATH_OUTER, KINK_INNER, KINK_OUTER,
) = range(10)  # fmt: skip
DEFECT_SIZE = 10

# Rows of the ball table: cos and sin in the cage, undersize (m).
BALL_COS, BALL_SIN, UNDERSIZE = range(3)

LANES = 8
"""Balls are padded to a multiple of this, so that the compiler can use vector instructions."""
CHUNK = 32
"""Output samples, on a fixed grid, over which the cage's random walk holds its speed. At each
grid point the phases are wrapped and the rotated sines are computed anew."""

# Columns of what is prescribed at one step, at its end: PULL and the next three are unbalance and
# its rate. Then the speeds (turns/s) of cage, shaft and balls at its middle, and at its start
# their phases and the rotated sines.
TURNING, STIFF, FOOT, PULL = range(4)
SPEED, PHASE, SINES = 7, 10, 13
TABLE_SIZE = 17
# Rows of a ball at one step: gap to close (m), its rate (m/s), direction.
GAP, GAP_RATE, COS, SIN = range(4)
