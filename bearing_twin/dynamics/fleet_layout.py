# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Where what stands in the arrays of the compiled kernel of a fleet."""

from __future__ import annotations

MAX_SPALLS = 4
"""Most spalls of one bearing of a fleet."""

# Rows of the flat work array; each row has L lanes. First the state that is carried on: positions,
# velocities, accelerations, jerks; the sensor along x and along y; directions of slot 0 (see
# below) and of the shaft.
Q, V, A, J = 0, 4, 8, 12
SENSOR = 16
C, S, CS, SS = 20, 21, 22, 23
STATE_ROWS = 24
# Constants: of the bearing; the sensor's table; balls.
CONSTANTS = STATE_ROWS
LIGHT, KI, CI, HEAVY, KO, CO, CB, UNBALANCE = range(CONSTANTS, CONSTANTS + 8)
TO_Z, TO_W, READ = 32, 38, 44  # six, six and three rows
N_BALLS, PER_BALL = 47, 48
CONSTANT_ROWS = 25
# What is prescribed: values at the grid point and growth per step; four rows, `TURN` below the
# directions, of cosines and sines of one step; speeds of cage and shaft (rad/s), unbalance and
# the random number of the cage's walk.
KB0, KB1, DEPTH0, DEPTH1, GAP0, GAP1, FOOT0, FOOT1 = range(49, 57)
TURN = 37
TURNING, OMEGA, PULL, WALK = 61, 62, 63, 64
SPALLS = 65
"""First row of the spalls; each has `SPALL_ROWS`."""
(
    U_SCALE, METRES, RACE, BALL, ONLY, EVEN, ODD, HALF, FULL, KIND, U0, DU, SPEED, FIXED, LOW,
    HIGH, SLOT, TAKEN, TAKEN_RATE,
) = range(19)  # fmt: skip
SPALL_ROWS = 19
WORK_ROWS = SPALLS + MAX_SPALLS * SPALL_ROWS

# Balls stand in slots, whose numbers go 0, 1, -1, 2, -2, ... from the direction of the load to
# both sides; slot 0 is the last ball before it. So those that may be loaded come first. Rows of a
# slot: direction relative to slot 0, zero where a lane has no such ball; negative number.
BALL_COS, BALL_SIN, NUMBER = range(3)
BALL_ROWS = 3

# Rows of the phases (float64): cage, shaft, spin; orders of cage and spin; walk; spalls' angles
# and which phases they follow.
CAGE, SHAFT, SPIN, FTF_ORDER, SPIN_ORDER, JITTER, FIRST_ANGLE = range(7)
PHASE_ROWS = 7 + 4 * MAX_SPALLS
