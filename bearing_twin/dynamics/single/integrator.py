# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and records of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Integrator: fourth-order Hermite scheme, with smaller steps where the force is not smooth.

The scheme (Makino and Aarseth, Publ. Astron. Soc. Japan 1992, 44, 141) needs the force and its
time derivative once per step; Runge-Kutta needs the force four times. The derivative costs little,
since both share a square root. The corrector also gives the snap at the end of a step, which
raises the order of the next predictor by one. Corrector and next predictor are one sum each; the
other terms are computed before the force.

Nearly all error of such a scheme comes from a few instants at which the force is not smooth: a
ball gains or loses contact, or rolls over a kink of its path through a defect. Therefore a step is
split

- at a kink that a loaded ball passes (kinks are known beforehand),
- at the instant at which a ball becomes loaded or unloaded, which is found on the predictor,
- shortly after and before such an instant, into pieces of at most half the time to or since it:
  the force begins and ends with the power 1.5 of that time, as in `model.contact_law`.

Steps always end at the samples of a fixed grid, so the result does not depend on the blocks.
"""

from __future__ import annotations

from collections import namedtuple

from bearing_twin.dynamics.equations.hermite import correct, snap, sum2, sum3, sum4, taylor, ZERO
from bearing_twin.dynamics.equations.layout import COS, GAP, GAP_RATE, SIN
from bearing_twin.dynamics.equations.model import Contact, contact_force, ring_motion
from bearing_twin.dynamics.single.kinematics import at_time, kinks
from bearing_twin.numerics.compiled import compiled, FAST

_IN_ORDER = FAST - {'reassoc'}
"""Fast-math flags without reassociation. The sum over the balls then stays scalar and skips
unloaded balls; for one bearing this is faster than vector lanes with a final sum."""
FAR = 1.0
"""Upper limit of ``near``, s."""
_MASKED = 52
"""Number of balls with a bit of their own. Further balls share the next bit, and their contact is
followed less accurately. The state holds the bits as a float, which has room for 53."""
_PART = 0.5
"""Largest piece of a step, in units of the time to or since the nearest change of contact."""
_SMALLEST = 0.2
"""Smallest such piece, in units of the step."""
_RESTING = 1.5
"""Largest ratio of a piece to the one before for which the snap is still used."""
_ASIDE = 1e-6
"""Time from a kink at which a defect is evaluated on one side of it, in units of the step."""
_EVENTS = 12
"""Most changes of the loaded balls that are located in a step."""
_EXACT = 1e-5
"""Accuracy of the time of an event, in units of the step."""
_TERMS = 16
"""Terms of the sensor's Taylor series: enough for 11 kHz at steps of 39 us."""
_PER_METRE = 1e8
"""Stiffness that scales an approach to a force for comparison, N/m."""


_Motion = namedtuple('_Motion', 'q v a j s')
"""State of both rings at an instant: positions, m, and derivatives up to the snap."""
_Parted = namedtuple('_Parted', 'step number bearing scratch')
"""A split step: its record, its number from the grid point, the bearing, and work arrays."""


Scratch = namedtuple('Scratch', 'step gaps times')
"""Work arrays: a step, its gaps, and the times of all kinks within a step."""


@compiled(inline=True, fast=_IN_ORDER)
def _balls_force(step, gaps, i, q, v, a, damping, known):
    """
    Return the force of the balls on the outer ring, N, its rate, N/s, loaded balls, ``near``.

    A ball is loaded while its approach and its force are positive; loaded balls are the bits of an
    integer. At begin and end of contact the force has a singularity of the power 1.5, and a jump
    if there is contact damping. ``near`` estimates the time to it: the least of delta / |delta'|
    over the loaded balls, at most `FAR`.

    ``known`` are the balls to treat as loaded, on one side of an event; -1: they are determined.
    """
    x, y, vx, vy, ax, ay = _between(q, v, a)
    turning, contact = step.turning, Contact(step.k_b, damping)
    fx = 0.0
    fy = 0.0
    gx = 0.0
    gy = 0.0
    loaded = 0
    near = FAR
    for k in range(gaps.shape[2]):
        c, s = gaps[i, COS, k], gaps[i, SIN, k]
        delta = x * c + y * s - gaps[i, GAP, k]
        if known < 0:
            taken = delta > 0.0
        else:
            taken = known >> min(k, _MASKED) & 1 != 0 and (k < _MASKED or delta > 0.0)
        if taken:
            delta = max(delta, 0.0)
            speed = vx * c + vy * s
            closing = speed + turning * (y * c - x * s) - gaps[i, GAP_RATE, k]
            acceleration = ax * c + ay * s + turning * (vy * c - vx * s)
            force, rate = contact_force(delta, closing, speed, acceleration, contact)
            if known >= 0 or force > 0.0:
                fx += force * c
                fy += force * s
                gx += rate * c
                gy += rate * s
                loaded |= 1 << min(k, _MASKED)
                if delta < near * abs(closing):
                    near = delta / abs(closing)
    return (fx, fy), (gx - turning * fy, gy + turning * fx), loaded, near


@compiled(inline=True, fast=FAST)
def _between(q, v, a):
    """Position, velocity and acceleration of the inner ring relative to the outer ring."""
    return q[0] - q[2], q[1] - q[3], v[0] - v[2], v[1] - v[3], a[0] - a[2], a[1] - a[3]


@compiled(inline=True, fast=FAST)
def ring_rates(step, gaps, i, q, v, a, machine, known=-1):
    """Return acceleration and jerk of both rings, loaded balls, ``near``; from gaps row ``i``."""
    force, rate, loaded, near = _balls_force(
        step, gaps, i, q, v, a, machine.contact_damping, known
    )
    a1, j1 = ring_motion(machine, step, force, rate, q, v, a)
    return a1, j1, loaded, near


@compiled(fast=FAST, borrows=True)
def _rates_of(step, gaps, q, v, a, machine, known):
    """Like `ring_rates` with given loaded balls: the limit on one side of an event."""
    a1, j1, _, near = ring_rates(step, gaps, 0, q, v, a, machine, known)
    return a1, j1, near


@compiled(fast=FAST, borrows=True)
def predict(state, h):
    """Predict the next step of ``state``, ``h`` seconds long, with the snap if it is known."""
    q, v, a, j = _four(state.q), _four(state.v), _four(state.a), _four(state.j)
    last, s = state.next_step, ZERO
    if last > 0.0:
        s = sum3(ZERO, 2.0 / (last * last), sum2(-1.0, _four(state.next_a), a), -2.0 / last, j)
    further, faster, ahead = taylor(h, q, v, a, j, s)
    _set(state.next_q, further)
    _set(state.next_v, faster)
    _set(state.next_a, ahead)
    state.next_step = h


@compiled(fast=_IN_ORDER, borrows=True)
def integrate(state, bearing, steps, gaps, resonator, first, scratch, acc_x, acc_y):
    """
    Advance both rings and the sensor through ``steps``.

    ``first`` is the number of the first step from the grid point. ``acc_x`` and ``acc_y`` receive
    the sensor samples, ``machine.reads`` per step; see `filters.resonator`.
    """
    machine = bearing.machine
    h, snaps, reads = machine.step, machine.snaps, machine.reads
    h2, h3 = h * h, h * h * h
    q, v, a, j = _four(state.q), _four(state.v), _four(state.a), _four(state.j)
    further, faster, ahead = _four(state.next_q), _four(state.next_v), _four(state.next_a)
    zx, wx, zy, wy = _four(state.sensor)
    loaded, near = int(state.loaded), state.near
    for i in range(steps.shape[0]):
        step = steps[i]
        smooth = _PART * near >= h and not step.kinked & loaded
        if smooth:
            # Terms of corrector and next predictor that do not need the new force.
            v0 = sum3(v, h / 2.0, a, h2 / 12.0, j)
            q0 = sum4(q, h / 2.0, v, h / 2.0, v0, h2 / 12.0, a)
            q2 = sum4(q0, h, v0, h2 / 4.0 * snaps, a, h3 / 12.0 * snaps, j)
            v2 = sum3(v0, h * snaps, a, h2 / 3.0 * snaps, j)
            a2 = sum3(ZERO, 3.0 * snaps, a, h * snaps, j)
            a1, j1, found, near1 = ring_rates(step, gaps, i, further, faster, ahead, machine)
            smooth = found == loaded
        if smooth:
            # Acceleration and jerk times h at both ends: the cubic that drives the sensor.
            x = a[2], h * j[2], a1[2], h * j1[2]
            y = a[3], h * j[3], a1[3], h * j1[3]
            for k in range(reads):
                acc_x[i * reads + k] = _weigh(resonator[k + 2], zx, wx, x)
                acc_y[i * reads + k] = _weigh(resonator[k + 2], zy, wy, y)
            zx, wx = _weigh(resonator[0], zx, wx, x), _weigh(resonator[1], zx, wx, x)
            zy, wy = _weigh(resonator[0], zy, wy, y), _weigh(resonator[1], zy, wy, y)
            v = sum3(v0, h / 2.0, a1, -h2 / 12.0, j1)
            q = sum3(q0, h2 / 6.0, a1, -h3 / 24.0, j1)
            further = sum3(
                q2, h2 * (7.0 / 6.0 - 0.25 * snaps), a1, h3 * (1.0 / 24.0 + snaps / 6.0), j1
            )
            faster = sum3(v2, h * (1.5 - snaps), a1, h2 * (5.0 / 12.0 + 2.0 / 3.0 * snaps), j1)
            ahead = sum3(a2, 1.0 - 3.0 * snaps, a1, h * (1.0 + 2.0 * snaps), j1)
            a, j, near = a1, j1, near1
        else:
            _keep(state, q, v, a, j, (zx, wx, zy, wy), loaded, near, further, faster, ahead)
            begin = i * reads
            _split_step(
                state, bearing, step, first + i, scratch, acc_x[begin : begin + reads],
                acc_y[begin : begin + reads],
            )  # fmt: skip
            q, v, a, j = _four(state.q), _four(state.v), _four(state.a), _four(state.j)
            further, faster, ahead = _four(state.next_q), _four(state.next_v), _four(state.next_a)
            zx, wx, zy, wy = _four(state.sensor)
            loaded, near = int(state.loaded), state.near
    _keep(state, q, v, a, j, (zx, wx, zy, wy), loaded, near, further, faster, ahead)


@compiled(inline=True)
def _four(values):
    return values[0], values[1], values[2], values[3]


@compiled(inline=True)
def _set(values, given):
    for i in range(4):
        values[i] = given[i]


@compiled(inline=True)
def _keep(state, q, v, a, j, sensor, loaded, near, further, faster, ahead):
    _set(state.q, q)
    _set(state.v, v)
    _set(state.a, a)
    _set(state.j, j)
    _set(state.sensor, sensor)
    _set(state.next_q, further)
    _set(state.next_v, faster)
    _set(state.next_a, ahead)
    state.loaded, state.near = loaded, near


@compiled(inline=True, fast=FAST)
def _weigh(row, z, w, housing):
    """Apply a row of `filters.resonator`; ``housing`` is a, h a', and both at the step's end."""
    a, j, a1, j1 = housing
    return (row[0] * z + row[1] * w) + (row[2] * a + row[3] * j) + (row[4] * a1 + row[5] * j1)


@compiled(fast=_IN_ORDER, borrows=True)
def _split_step(state, bearing, step, number, scratch, acc_x, acc_y):
    """
    Advance by one ``step`` in pieces that end where the force is not smooth.

    Arguments as in `integrate`; ``number`` is the number of the step from the grid point.
    """
    machine, here, gaps, times = bearing.machine, scratch.step, scratch.gaps, scratch.times
    h, reads = machine.step, machine.reads
    found = kinks(machine, bearing.defects, _three(step.phases), _three(step.speeds), times)
    aside = _ASIDE * h
    q, v, a, j = _four(state.q), _four(state.v), _four(state.a), _four(state.j)
    # The snap contained in the prediction for a whole step.
    s = sum3(ZERO, 2.0 / (h * h), sum2(-1.0, _four(state.next_a), a), -2.0 / h, j)
    loaded, near = int(state.loaded), state.near
    time, last, events, kink, sample = 0.0, h, 0, 0, 0
    while sample < reads:
        # End of this piece: at a kink, at a sample, or earlier near a change of contact.
        stop = h * (sample + 1) / reads
        at_kink = kink < found and times[kink] <= stop
        if at_kink:
            stop = times[kink]
        piece = max(_PART * near, _SMALLEST * h)
        whole = stop - time <= 1.3 * piece
        if whole:
            piece = stop - time
        else:
            at_kink = False
        if piece > _RESTING * last:
            s = ZERO
        further, faster, ahead = taylor(piece, q, v, a, j, s)
        at_time(time + piece, -aside if at_kink else 0.0, step, number, bearing, here, gaps)
        a1, j1, after, near1 = ring_rates(here, gaps, 0, further, faster, ahead, machine)
        event = after != loaded and events < _EVENTS
        if event:
            events += 1
            motion, parted = _Motion(q, v, a, j, s), _Parted(step, number, bearing, scratch)
            piece, ball = _first_change(after ^ loaded, piece, time, parted, motion)
            at_kink = whole = False
            further, faster, ahead = taylor(piece, q, v, a, j, s)
            at_time(time + piece, 0.0, step, number, bearing, here, gaps)
            a1, j1, near1 = _rates_of(here, gaps, further, faster, ahead, machine, loaded)
            loaded ^= 1 << ball
        else:
            loaded = after
        q1, v1 = correct(piece, q, v, a, j, a1, j1)
        if machine.resonance > 0.0:
            _advance_sensor(state.sensor, 0, piece, a[2], j[2], a1[2], j1[2], machine)
            _advance_sensor(state.sensor, 2, piece, a[3], j[3], a1[3], j1[3], machine)
        s = snap(piece, a, j, a1, j1) if piece > aside and machine.snaps > 0.0 else ZERO
        last = piece
        q, v, a, j, near = q1, v1, a1, j1, near1
        time = stop if whole else time + piece
        if event:
            s = ZERO
            # Twice: the damping force's rate needs the acceleration, which the first call gives.
            a, j, near = _rates_of(here, gaps, q, v, a, machine, loaded)
            a, j, near = _rates_of(here, gaps, q, v, a, machine, loaded)
        elif at_kink:
            kink += 1
            s = ZERO
            at_time(time, aside, step, number, bearing, here, gaps)
            a, j, loaded, near = ring_rates(here, gaps, 0, q, v, a, machine)
            a, j, loaded, near = ring_rates(here, gaps, 0, q, v, a, machine)
        elif whole:
            acc_x[sample] = _read_sensor(state.sensor, 0, a[2], machine)
            acc_y[sample] = _read_sensor(state.sensor, 2, a[3], machine)
            sample += 1
    if h > _RESTING * last:
        s = ZERO
    further, faster, ahead = taylor(h, q, v, a, j, s)
    _keep(state, q, v, a, j, _four(state.sensor), loaded, near, further, faster, ahead)


@compiled(inline=True)
def _three(values):
    return values[0], values[1], values[2]


@compiled(fast=_IN_ORDER, borrows=True)
def _first_change(changed, piece, time, parted, motion):
    """
    Find the time, s from ``time``, at which the first of the ``changed`` balls changes contact.

    Uses regula falsi (Illinois) on the predictor. Returns the time and the ball.
    """
    first, which, machine = piece, -1, parted.bearing.machine
    for ball in range(min(machine.n_balls, _MASKED + 1)):
        if not changed >> ball & 1:
            continue
        begin, end = 0.0, first
        low = _load_margin(ball, begin, time, parted, motion)
        high = _load_margin(ball, end, time, parted, motion)
        if low * high >= 0.0:
            # It changed at the start, or not before another ball.
            if which < 0:
                first, which = (end, ball) if low * high > 0.0 else (begin, ball)
            continue
        side = 0
        while end - begin > _EXACT * machine.step:
            middle = begin + (end - begin) * low / (low - high)
            middle = min(max(middle, begin + 1e-3 * (end - begin)), end - 1e-3 * (end - begin))
            value = _load_margin(ball, middle, time, parted, motion)
            if value * high > 0.0:
                end, high = middle, value
                low *= 0.5 if side == 1 else 1.0
                side = 1
            else:
                begin, low = middle, value
                high *= 0.5 if side == -1 else 1.0
                side = -1
        first, which = end, ball
    return first, which


@compiled(fast=_IN_ORDER, borrows=True)
def _load_margin(ball, ahead, time, parted, motion):
    """
    Return a continuous measure of the load of a ball, ``ahead`` seconds after ``time``.

    It is evaluated on the predictor and is positive exactly while the ball is loaded: the minimum
    of its force, N, and its approach, m, times a stiffness.
    """
    step, number, bearing, scratch = parted
    here, gaps = scratch.step, scratch.gaps
    further, faster, _ = taylor(ahead, motion.q, motion.v, motion.a, motion.j, motion.s)
    at_time(time + ahead, 0.0, step, number, bearing, here, gaps)
    x, y, vx, vy, _, _ = _between(further, faster, ZERO)
    c, s = gaps[0, COS, ball], gaps[0, SIN, ball]
    delta, speed = x * c + y * s - gaps[0, GAP, ball], vx * c + vy * s
    contact = Contact(here.k_b, bearing.machine.contact_damping)
    force, _ = contact_force(max(delta, 0.0), 0.0, speed, 0.0, contact)
    return min(force, _PER_METRE * delta)


@compiled(fast=FAST, borrows=True)
def _advance_sensor(sensor, at, h, a, j, a1, j1, machine):
    """Advance one sensor axis by ``h`` seconds, at most a step, with its Taylor series."""
    if h <= 0.0:
        return
    w = machine.resonance * h
    damped = 2.0 * machine.resonance_damping * machine.resonance * h
    # Coefficients of the cubic through both accelerations and jerks, in units of h.
    slope = h * j
    square = 3.0 * (a1 - a) - h * (2.0 * j + j1)
    cube = 2.0 * (a - a1) + h * (j + j1)
    z, v = sensor[at], sensor[at + 1]
    ahead, faster = z, v
    for n in range(_TERMS):
        drive = a if n == 0 else (slope if n == 1 else (square if n == 2 else cube))
        if n > 3:
            drive = 0.0
        z, v = w * v / (n + 1), -(w * (z + drive) + damped * v) / (n + 1)
        ahead += z
        faster += v
    sensor[at], sensor[at + 1] = ahead, faster


@compiled(inline=True, fast=FAST)
def _read_sensor(sensor, at, a, machine):
    """Return the sensor output along one axis, m/s^2."""
    if machine.resonance == 0.0:
        return a
    return -sensor[at] - 2.0 * machine.resonance_damping * sensor[at + 1]
