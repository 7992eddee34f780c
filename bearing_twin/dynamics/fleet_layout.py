# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where what stands in the arrays of the compiled kernel of a fleet."""

from __future__ import annotations

L = 16
"""Bearings in a group: the single precision lanes of the widest vector units."""
MAX_SPALLS = 4
"""Most spalls of one bearing of a fleet."""

# Rows of the flat work array; each row has L lanes. First the state that is carried on.
Q, V, A, J = 0, 4, 8, 12
ZX, WX = 16, 17  # the sensor along x, then along y
STATE_ROWS = 20
# Constants: of the bearing; the three rows of the sensor's table, six each; balls.
CONSTANTS = 20
LIGHT, KI, CI, HEAVY, KO, CO, CB, UNBALANCE = range(CONSTANTS, CONSTANTS + 8)
TO_Z, TO_W, READ = 28, 34, 40
N_BALLS = 46
CONSTANT_ROWS = 27
# What is prescribed: values at the grid point and growth per step, then at the step.
KB0, KB1, DEPTH0, DEPTH1, GAP0, GAP1, FOOT0, FOOT1 = range(47, 55)
C, S, CD, SD, CS, SS, CSD, SSD, TURNING, OMEGA, PULL = range(55, 66)
KB, FACTOR, GAP, FOOT = range(66, 70)
# The relative motion that the balls feel, its velocity and acceleration as seen from the cage, and
# the sums over the balls.
X, Y, VX, VY, UX, UY, BX, BY = range(70, 78)
FX, FY, GX, GY = range(78, 82)
# Predicted state: positions, velocities, accelerations.
QP, VP, AP = 82, 86, 90
# Accelerations and jerks at the end of the step, and what the sensor gives.
AN, JN, OUT = 94, 98, 102
SPALLS = 104
"""First row of the spalls; each has `SPALL_ROWS`."""
(
    U_SCALE, METRES, FIXED, EVEN, ODD, HALF, FULL, KIND, U0, DU, BALL, TAKEN, TAKEN_RATE, ONLY,
) = range(14)  # fmt: skip
SPALL_ROWS = 14
WORK_ROWS = SPALLS + MAX_SPALLS * SPALL_ROWS

# Rows of a ball: direction in the cage and undersize.
BALL_ROWS = 3

# Rows of the phases (float64): cage, shaft, spin; orders of cage and spin; walk; spalls' angles
# and which phases they follow.
CAGE, SHAFT, SPIN, FTF_ORDER, SPIN_ORDER, JITTER, FIRST_ANGLE = range(7)
PHASE_ROWS = 7 + 4 * MAX_SPALLS
