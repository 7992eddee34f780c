# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Compiled kernel of one bearing: chunks of the grid, inputs, decimation, noise.

The equations are in `model`, the prescribed kinematics in `kinematics`, the scheme in
`integrator` and the records in `layout`.
"""

from __future__ import annotations

from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.dynamics.equations.coefficients import INPUTS, K_B, SHAFT_HZ
from bearing_twin.dynamics.equations.layout import CHUNK, COS, GAP, SIN, STEP
from bearing_twin.dynamics.equations.model import Contact, contact_force
from bearing_twin.dynamics.equations.statics import equilibrium
from bearing_twin.dynamics.equations.waviness import with_own_room
from bearing_twin.dynamics.single.integrator import FAR, integrate, predict, ring_rates, Scratch
from bearing_twin.dynamics.single.kinematics import (
    advance_steps,
    drive,
    Inputs,
    KernelBearing,
    open_gaps,
    place_balls,
    wrap_phases,
)
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.random import NOISE, normal_pair, WALK
from numba.np.unsafe.ndarray import to_fixed_tuple
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.equations.waviness import Surfaces


FloatArray = npt.NDArray[np.float64]
Records = npt.NDArray[np.void]

_seven: Any = to_fixed_tuple
"""Typed as Any: compiled code passes other arguments than the Python function declares."""
FAST_HZ = 27.0
"""Shaft speed above which steps are short, Hz: events are frequent, errors would exceed 0.1 %."""
_MOST_KINKS = 32
"""Most kinks of all defects within one step."""
_LONG, _SHORT = 0, 1
"""Kinds of steps: `filters.least_steps` per output sample, or three times as many."""


class Tables(NamedTuple):
    """Constants of one bearing for the kernel; see `tables` and `waviness`."""

    machines: Records
    """MACHINE[2]: constants for long and for short steps. Steps are short if the rings are stiff
    or the shaft turns faster than `FAST_HZ`."""
    defects: Records
    balls: FloatArray
    surfaces: Surfaces


@compiled(fast=FAST)
def advance(
    states: Records,
    history: FloatArray,
    tables: Tables,
    resonators: FloatArray,
    taps: FloatArray,
    ramp: FloatArray,
    drift: FloatArray,
    fade: FloatArray,
    faded: int,
    seed: int,
    first: int,
    since_tick: int,
    out: npt.NDArray[np.float32],
) -> None:
    """
    Advance one bearing by ``out.shape[1]`` output samples.

    Parameters
    ----------
    states : STATE[1]
        Changed in place.
    history : float64[2, taps - oversample]
        Last internal samples, the state of the decimator; changed in place.
    tables
        The bearing.
    resonators : float64[2, 5, 6]
        Tables of `filters.resonator`, for long and for short steps.
    taps
        Result of `filters.decimator`.
    ramp : float64[2, INPUTS]
        Inputs at the start and at the end of the block.
    drift : float64[2, INPUTS]
        Addition to the inputs at the last thermal tick, and its growth per output sample.
    fade, faded : float64[INPUTS]
        Remaining addition to the inputs after a change of parameters: its growth per output
        sample, and the output sample, a grid point, from which it is zero.
    seed, first, since_tick
        Seed of the random numbers; index of the first output sample; output samples since the last
        thermal tick.
    out : float32[2, n]
        Acceleration of the sensor along x and y, m/s^2.

    """
    state, machines = states[0], tables.machines
    n = out.shape[1]
    memory = history.shape[1]
    most = CHUNK * machines[_SHORT].steps
    oversample = machines[_SHORT].steps * machines[_SHORT].reads
    # All arrays between two grid points fit into the fastest cache.
    raw = np.empty((2, memory + CHUNK * oversample))
    steps = np.empty(most, STEP)
    gaps = np.empty((most, 4, tables.balls.shape[1]))
    one_step, one_gap = np.empty(1, STEP), np.empty((1, 4, tables.balls.shape[1]))
    scratch = Scratch(one_step[0], one_gap, np.empty(_MOST_KINKS))
    raw[:, :memory] = history
    done = 0
    while done < n:
        within = (first + done) % CHUNK
        count = min(CHUNK - within, n - done)
        if within == 0:
            wrap_phases(state)
        walk = machines[_LONG].jitter * normal_pair((first + done) // CHUNK, WALK, seed)[0]
        at = done - within
        left = min(float(first + at - faded), 0.0)
        hz = input_at(ramp, drift, fade, n, SHAFT_HZ, at, since_tick, left)
        kind = _SHORT if machines[_LONG].stiff != 0 or hz > FAST_HZ else _LONG
        machine = machines[kind]
        if state.next_step != machine.step:
            predict(state, machine.step)
        inputs, growth = _inputs(ramp, drift, fade, n, machine.steps, at, since_tick, left)
        bearing = _bearing(tables, machine, inputs, growth)
        rows, begin = count * machine.steps, float(within * machine.steps)
        new = count * oversample
        advance_steps(state, bearing, walk, begin, steps[:rows], gaps[:rows])
        integrate(
            state, bearing, steps[:rows], gaps[:rows], resonators[kind], begin, scratch,
            raw[0, memory : memory + new], raw[1, memory : memory + new],
        )  # fmt: skip
        _decimate(raw, taps, oversample, out[:, done : done + count])
        for i in range(memory):
            raw[0, i] = raw[0, new + i]
            raw[1, i] = raw[1, new + i]
        done += count
    history[:, :] = raw[:, :memory]
    _add_noise(machines[_LONG].noise, seed, first, out)


@compiled(inline=True, fast=FAST)
def _inputs(ramp, drift, fade, n, steps, at, since_tick, left):
    """
    Return the inputs at a grid point, ``at`` samples into the block, and their growth per step.

    They are computed relative to the grid, so that constant inputs give the same bits in every
    block. A fade ends after ``-left`` samples.
    """
    inputs, growth = np.empty(INPUTS), np.empty(INPUTS)
    for i in range(INPUTS):
        inputs[i] = input_at(ramp, drift, fade, n, i, at, since_tick, left)
        growth[i] = growth_of(ramp, drift, fade, n, i, left) / steps
    return _as_inputs(inputs), _as_inputs(growth)


@compiled(inline=True, fast=FAST)
def input_at(ramp, drift, fade, n, i, at, since_tick, left):
    """Input ``i`` at a grid point, see `advance`; a fade ends after ``-left`` samples."""
    slope = (ramp[1, i] - ramp[0, i]) / n
    added = drift[0, i] + drift[1, i] * (since_tick + at)
    return ramp[0, i] + slope * at + (added + fade[i] * left)


@compiled(inline=True, fast=FAST)
def growth_of(ramp, drift, fade, n, i, left):
    """Growth of input ``i`` per output sample."""
    grown = (ramp[1, i] - ramp[0, i]) / n + drift[1, i]
    return grown + fade[i] if left < 0.0 else grown


@compiled(fast=FAST)
def _decimate(raw, taps, oversample, out):
    for k in range(out.shape[1]):
        at = k * oversample
        acc_x, acc_y = raw[0, at : at + taps.shape[0]], raw[1, at : at + taps.shape[0]]
        x = 0.0
        y = 0.0
        for i in range(taps.shape[0]):
            x += taps[i] * acc_x[i]
            y += taps[i] * acc_y[i]
        out[0, k] = x
        out[1, k] = y


@compiled(fast=FAST)
def _add_noise(level, seed, first, out):
    """Add white noise; drawn in whole chunks of the grid, so that it is the same in any block."""
    x, y = np.empty(CHUNK, np.float32), np.empty(CHUNK, np.float32)
    level = np.float32(level)
    key = np.uint64(seed)
    origin = first - first % CHUNK
    while origin < first + out.shape[1]:
        for i in range(CHUNK):
            pair = normal_pair(origin + i, NOISE, key)
            x[i] = level * pair[0]
            y[i] = level * pair[1]
        begin = max(first - origin, 0)
        end = min(first + out.shape[1] - origin, CHUNK)
        for i in range(begin, end):
            out[0, origin + i - first] += x[i]
            out[1, origin + i - first] += y[i]
        origin += CHUNK


@compiled(fast=FAST)
def _instant(state, tables, values):
    """
    Return a step and its gaps for the present phases and inputs, without cage jitter.

    Three functions call this code, which takes seconds to compile.
    """
    machine, inputs = tables.machines[_LONG], _as_inputs(values)
    bearing = _bearing(tables, machine, inputs, Inputs(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    steps, gaps = np.empty(1, STEP), np.zeros((1, 4, tables.balls.shape[1]))
    hz = inputs.shaft_hz
    carried = hz * (1.0 - inputs.slip)
    turning = machine.ftf_order * carried
    rates = (turning, hz, machine.spin_order * carried)
    phases = (state.cage, state.shaft, state.spin)
    c, s = state.cage_cos, state.cage_sin
    place_balls(bearing, inputs.clearance, c, s, phases, rates, gaps, 0)
    open_gaps(bearing, phases, rates, inputs.depth, gaps, 0)
    shaft = (state.shaft_cos, state.shaft_sin)
    drive(steps[0], machine, inputs, bearing.growth, 0.0, turning, shaft)
    return steps, gaps


@compiled(inline=True)
def _bearing(tables, machine, inputs, growth):
    return KernelBearing(machine, tables.defects, tables.balls, tables.surfaces, inputs, growth)


@compiled(inline=True)
def _as_inputs(values):
    return Inputs(*_seven(values, INPUTS))


@compiled(fast=FAST)
def settle(states: Records, tables: Tables, values: FloatArray) -> None:
    """
    Put both rings into static equilibrium at the present phases, with defects under the balls.

    ``values`` are the inputs. Call `start` next.
    """
    state, machine = states[0], tables.machines[_LONG]
    wrap_phases(state)
    steps, gaps = _instant(state, tables, values)
    step = steps[0]
    foot_x, foot_y, inner = step.foot_x, step.foot_y, machine.inner_stiffness
    outer_x, outer_y = machine.outer_stiffness_x, machine.outer_stiffness_y
    compliance = 1.0 / inner + 1.0 / outer_x, 0.0, 1.0 / inner + 1.0 / outer_y
    foot = foot_x, foot_y
    _, _, fx, fy = equilibrium(foot, Contact(step.k_b, 0.0), compliance, gaps[0], foot)
    state.q[0], state.q[1] = foot_x - fx / inner, foot_y - fy / inner
    state.q[2], state.q[3] = fx / outer_x, fy / outer_y


@compiled(fast=FAST)
def start(states: Records, tables: Tables, values: FloatArray) -> None:
    """
    Compute the dependent part of the state from phases, positions and velocities.

    This part is sines, accelerations, jerks, loaded balls and the prediction for the next step.
    Call it at the start of a trajectory and after a change of parameters; ``values`` are the
    inputs.
    """
    state, machine = states[0], tables.machines[_LONG]
    wrap_phases(state)
    steps, gaps = _instant(state, tables, values)
    step = steps[0]
    q = (state.q[0], state.q[1], state.q[2], state.q[3])
    v = (state.v[0], state.v[1], state.v[2], state.v[3])
    a = (0.0, 0.0, 0.0, 0.0)
    j = a
    loaded, near = 0, FAR
    for _ in range(2):  # the damping force's rate needs the acceleration of the first pass
        a, j, loaded, near = ring_rates(step, gaps, 0, q, v, a, machine)
    for i in range(4):
        state.a[i], state.j[i] = a[i], j[i]
    state.loaded, state.near = loaded, near
    state.next_step = 0.0
    predict(state, machine.step)


@compiled()
def ball_forces(states: Records, tables: Tables, values: FloatArray) -> npt.NDArray[np.float32]:
    """Return the contact force of each ball, N, float32[n_balls], for state and inputs."""
    state, machine = states[0], tables.machines[_LONG]
    # Own work array for the look-up: the simulator may run meanwhile.
    aside = Tables(tables.machines, tables.defects, tables.balls, with_own_room(tables.surfaces))
    _, gaps = _instant(state, aside, values)
    forces = np.zeros(machine.n_balls, dtype=np.float32)
    x, y = state.q[0] - state.q[2], state.q[1] - state.q[3]
    vx, vy = state.v[0] - state.v[2], state.v[1] - state.v[3]
    contact = Contact(values[K_B], machine.contact_damping)
    for k in range(machine.n_balls):
        c, s = gaps[0, COS, k], gaps[0, SIN, k]
        delta = x * c + y * s - gaps[0, GAP, k]
        if delta > 0.0:
            force, _ = contact_force(delta, 0.0, vx * c + vy * s, 0.0, contact)
            forces[k] = max(force, 0.0)
    return forces
