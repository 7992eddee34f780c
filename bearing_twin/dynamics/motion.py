# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
The integrator: Hermite's scheme of order 4, with smaller steps about what is not smooth.

The scheme (Makino and Aarseth, Publ. Astron. Soc. Japan 1992, 44, 141) needs the force and its
time derivative once a step where Runge-Kutta needs the force four times; the derivative costs
little beside the square root that both share. The snap at the end of a step, which the corrector
implies, makes the next step's predictor one order better. Corrector and next predictor are one
sum each, whose other terms are known before the force is.

Nearly all the error of such a scheme comes from a few instants at which the force is not smooth: a
ball meets or leaves the races, or rolls over a kink of its path through a defect. So a step

- in which a loaded ball passes a kink is parted there (kinks are known beforehand),
- in which a ball becomes loaded or unloaded is parted at that instant, found on the predictor,
- soon after the one and before the other is parted into pieces of at most half the time of
  contact, since the force begins and ends as the power 1.5 of that time.

Steps end at the samples of a fixed grid whatever happens between, so the result does not depend on
the blocks.
"""

from __future__ import annotations

from bearing_twin.dynamics.compiled import compiled, FAST
from bearing_twin.dynamics.contact import (
    IN_ORDER,
    MASKED,
    motion,
    motion_of,
    press,
)  # fmt: skip
from bearing_twin.dynamics.hermite import correct, NOUGHT, predict, snap, sum2, sum3, sum4
from bearing_twin.dynamics.layout import (
    A,
    AP,
    CB,
    EXPECTED,
    J,
    NEAR,
    PHASE,
    Q,
    QP,
    RESONANCE,
    RESONANCE_DAMPING,
    RESONATOR,
    SNAPS,
    SPEED,
    STEP,
    TOUCHING,
    V,
    VP,
)  # fmt: skip
from bearing_twin.dynamics.turning import kinks, stand

__all__ = ['expect', 'integrate']

_PART = 0.5
"""Largest piece of a step, in units of the time to or since the nearest loss of contact."""
_SMALLEST = 0.2
"""Smallest such piece, in units of the step."""
_RESTING = 1.5
"""Factor by which a piece may be longer than the one before and still use its snap."""
_ASIDE = 1e-6
"""How far from a kink a defect is looked at to see one side of it, in units of the step."""
_EVENTS = 12
"""Most changes of the loaded balls that are looked for in a step."""
_EXACT = 1e-5
"""To what part of the step an event is found."""
_TERMS = 16
"""Terms of the sensor's Taylor series: enough for 11 kHz at steps of 39 us."""


@compiled(fast=FAST, borrows=True)
def expect(state, h):
    """Predict the next step of ``state``, of ``h`` seconds, with the snap if one is known."""
    q, v, a, j = _at(state, Q), _at(state, V), _at(state, A), _at(state, J)
    last, s = state[EXPECTED], NOUGHT
    if last > 0.0:
        s = sum3(NOUGHT, 2.0 / (last * last), sum2(-1.0, _at(state, AP), a), -2.0 / last, j)
    further, faster, ahead = predict(h, q, v, a, j, s)
    for i in range(4):
        state[QP + i], state[VP + i], state[AP + i] = further[i], faster[i], ahead[i]
    state[EXPECTED] = h


@compiled(fast=IN_ORDER, borrows=True)
def integrate(
    state, const, table, gaps, kinked, resonator, left, up, first, defects, balls, base, step,
    n_balls, row, beside, times,
):  # fmt: skip
    """
    Advance both rings and the sensor through the rows of ``table``.

    ``first`` counts its first row from the grid point. ``left`` and ``up``, what the sensor gives,
    has as many samples a step as ``resonator`` (see `filters.resonator`) has rows beyond two.
    ``row``, ``beside`` and ``times`` are room to work in: as one row of ``table`` and ``gaps``,
    and for all kinks of a step.
    """
    h, snaps = const[STEP], const[SNAPS]
    h2, h3 = h * h, h * h * h
    per_step = resonator.shape[0] - 2
    q, v, a, j = _at(state, Q), _at(state, V), _at(state, A), _at(state, J)
    further, faster, ahead = _at(state, QP), _at(state, VP), _at(state, AP)
    zx, wx, zy, wy = _at(state, RESONATOR)
    touching, near = int(state[TOUCHING]), state[NEAR]
    for i in range(table.shape[0]):
        smooth = _PART * near >= h and not kinked[i] & touching
        if smooth:
            # What corrector and next predictor owe to the start, while the force is under way.
            v0 = sum3(v, h / 2.0, a, h2 / 12.0, j)
            q0 = sum4(1.0, q, h / 2.0, v, h / 2.0, v0, h2 / 12.0, a)
            q2 = sum4(1.0, q0, h, v0, h2 / 4.0 * snaps, a, h3 / 12.0 * snaps, j)
            v2 = sum3(v0, h * snaps, a, h2 / 3.0 * snaps, j)
            a2 = sum3(NOUGHT, 3.0 * snaps, a, h * snaps, j)
            a1, j1, loaded, near1 = motion(table, gaps, i, further, faster, ahead, const)
            smooth = loaded == touching
        if smooth:
            # Jerks times h: the sensor takes the cubic through all four.
            bx, by, ex, ey = h * j[2], h * j[3], h * j1[2], h * j1[3]
            for k in range(per_step):
                left[i * per_step + k] = _weigh(resonator, k + 2, zx, wx, a[2], bx, a1[2], ex)
                up[i * per_step + k] = _weigh(resonator, k + 2, zy, wy, a[3], by, a1[3], ey)
            zx, wx = (
                _weigh(resonator, 0, zx, wx, a[2], bx, a1[2], ex),
                _weigh(resonator, 1, zx, wx, a[2], bx, a1[2], ex),
            )
            zy, wy = (
                _weigh(resonator, 0, zy, wy, a[3], by, a1[3], ey),
                _weigh(resonator, 1, zy, wy, a[3], by, a1[3], ey),
            )
            v = sum3(v0, h / 2.0, a1, -h2 / 12.0, j1)
            q = sum3(q0, h2 / 6.0, a1, -h3 / 24.0, j1)
            further = sum3(
                q2, h2 * (7.0 / 6.0 - 0.25 * snaps), a1, h3 * (1.0 / 24.0 + snaps / 6.0), j1
            )
            faster = sum3(v2, h * (1.5 - snaps), a1, h2 * (5.0 / 12.0 + 2.0 / 3.0 * snaps), j1)
            ahead = sum3(a2, 1.0 - 3.0 * snaps, a1, h * (1.0 + 2.0 * snaps), j1)
            a, j, near = a1, j1, near1
        else:
            _keep(state, q, v, a, j, zx, wx, zy, wy, touching, near, further, faster, ahead)
            _in_pieces(
                state, const, table, i, first + i, defects, balls, base, step, n_balls, row,
                beside, times, left, up, per_step,
            )  # fmt: skip
            q, v, a, j = _at(state, Q), _at(state, V), _at(state, A), _at(state, J)
            further, faster, ahead = _at(state, QP), _at(state, VP), _at(state, AP)
            zx, wx, zy, wy = _at(state, RESONATOR)
            touching, near = int(state[TOUCHING]), state[NEAR]
    _keep(state, q, v, a, j, zx, wx, zy, wy, touching, near, further, faster, ahead)


@compiled(inline=True)
def _at(state, begin):
    return state[begin], state[begin + 1], state[begin + 2], state[begin + 3]


@compiled(inline=True)
def _keep(state, q, v, a, j, zx, wx, zy, wy, touching, near, further, faster, ahead):
    for i in range(4):
        state[Q + i], state[V + i], state[A + i], state[J + i] = q[i], v[i], a[i], j[i]
        state[QP + i], state[VP + i], state[AP + i] = further[i], faster[i], ahead[i]
    state[RESONATOR], state[RESONATOR + 1] = zx, wx
    state[RESONATOR + 2], state[RESONATOR + 3] = zy, wy
    state[TOUCHING], state[NEAR] = touching, near


@compiled(inline=True, fast=FAST)
def _weigh(resonator, i, z, w, a, j, a1, j1):
    return (
        (resonator[i, 0] * z + resonator[i, 1] * w)
        + (resonator[i, 2] * a + resonator[i, 3] * j)
        + (resonator[i, 4] * a1 + resonator[i, 5] * j1)
    )


@compiled(fast=IN_ORDER, borrows=True)
def _in_pieces(
    state, const, table, i, number, defects, balls, base, step, n_balls, row, gaps, times, left,
    up, per_step,
):  # fmt: skip
    """
    Advance by one step in pieces that end where something is not smooth.

    As `integrate`, for row ``i`` of ``table``; ``number`` counts the step from the grid point.
    """
    h = const[STEP]
    phases = (table[i, PHASE], table[i, PHASE + 1], table[i, PHASE + 2])
    rates = (table[i, SPEED], table[i, SPEED + 1], table[i, SPEED + 2])
    found = kinks(n_balls, phases, rates, h, const, defects, times)
    aside = _ASIDE * h
    q, v, a, j = _at(state, Q), _at(state, V), _at(state, A), _at(state, J)
    # The snap that the prediction for a whole step holds.
    s = sum3(NOUGHT, 2.0 / (h * h), sum2(-1.0, _at(state, AP), a), -2.0 / h, j)
    touching, near = int(state[TOUCHING]), state[NEAR]
    time, last, events, kink, sample = 0.0, h, 0, 0, 0
    while sample < per_step:
        # Where this piece ends: at a kink, at a sample, or sooner near a loss of contact.
        stop = h * (sample + 1) / per_step
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
            s = NOUGHT
        further, faster, ahead = predict(piece, q, v, a, j, s)
        stand(
            time + piece, -aside if at_kink else 0.0, table, i, number, const, defects, balls,
            base, step, n_balls, row, gaps,
        )  # fmt: skip
        a1, j1, loaded, near1 = motion(row, gaps, 0, further, faster, ahead, const)
        event = loaded != touching and events < _EVENTS
        if event:
            events += 1
            changed = loaded ^ touching
            piece, ball = _first_change(
                changed, piece, time, table, i, number, const, defects, balls, base, step,
                n_balls, row, gaps, q, v, a, j, s,
            )  # fmt: skip
            at_kink = whole = False
            further, faster, ahead = predict(piece, q, v, a, j, s)
            stand(
                time + piece, 0.0, table, i, number, const, defects, balls, base, step, n_balls,
                row, gaps,
            )  # fmt: skip
            a1, j1, near1 = motion_of(row, gaps, 0, further, faster, ahead, const, touching)
            touching ^= 1 << ball
        else:
            touching = loaded
        q1, v1 = correct(piece, q, v, a, j, a1, j1)
        if const[RESONANCE] > 0.0:
            _sense(state, RESONATOR, piece, a[2], j[2], a1[2], j1[2], const)
            _sense(state, RESONATOR + 2, piece, a[3], j[3], a1[3], j1[3], const)
        s = snap(piece, a, j, a1, j1) if piece > aside and const[SNAPS] > 0.0 else NOUGHT
        last = piece
        q, v, a, j, near = q1, v1, a1, j1, near1
        time = stop if whole else time + piece
        if event:
            s = NOUGHT
            a, j, near = motion_of(row, gaps, 0, q, v, a, const, touching)
            a, j, near = motion_of(row, gaps, 0, q, v, a, const, touching)
        elif at_kink:
            kink += 1
            s = NOUGHT
            stand(
                time, aside, table, i, number, const, defects, balls, base, step, n_balls, row,
                gaps,
            )  # fmt: skip
            a, j, touching, near = motion(row, gaps, 0, q, v, a, const)
            a, j, touching, near = motion(row, gaps, 0, q, v, a, const)
        elif whole:
            left[i * per_step + sample] = _felt(state, RESONATOR, a[2], const)
            up[i * per_step + sample] = _felt(state, RESONATOR + 2, a[3], const)
            sample += 1
    if h > _RESTING * last:
        s = NOUGHT
    zx, wx, zy, wy = _at(state, RESONATOR)
    further, faster, ahead = predict(h, q, v, a, j, s)
    _keep(state, q, v, a, j, zx, wx, zy, wy, touching, near, further, faster, ahead)


@compiled(fast=IN_ORDER, borrows=True)
def _first_change(
    changed, piece, time, table, i, number, const, defects, balls, base, step, n_balls, row, gaps,
    q, v, a, j, s,
):  # fmt: skip
    """
    Find when, in s from ``time``, the first of the ``changed`` balls becomes loaded or unloaded.

    Regula falsi (Illinois) on the predictor; returns the ball as well.
    """
    first, which = piece, -1
    for ball in range(min(n_balls, MASKED + 1)):
        if not changed >> ball & 1:
            continue
        begin, end = 0.0, first
        low = _press_at(
            ball, begin, time, table, i, number, const, defects, balls, base, step, n_balls, row,
            gaps, q, v, a, j, s,
        )  # fmt: skip
        high = _press_at(
            ball, end, time, table, i, number, const, defects, balls, base, step, n_balls, row,
            gaps, q, v, a, j, s,
        )  # fmt: skip
        if low * high >= 0.0:
            # Changed at once, or not before another ball did.
            if which < 0:
                first, which = (end, ball) if low * high > 0.0 else (begin, ball)
            continue
        side = 0
        while end - begin > _EXACT * const[STEP]:
            middle = begin + (end - begin) * low / (low - high)
            middle = min(max(middle, begin + 1e-3 * (end - begin)), end - 1e-3 * (end - begin))
            value = _press_at(
                ball, middle, time, table, i, number, const, defects, balls, base, step, n_balls,
                row, gaps, q, v, a, j, s,
            )  # fmt: skip
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


@compiled(fast=IN_ORDER, borrows=True)
def _press_at(
    ball, ahead, time, table, i, number, const, defects, balls, base, step, n_balls, row, gaps, q,
    v, a, j, s,
):  # fmt: skip
    """Tell how firmly a ball is loaded ``ahead`` seconds after ``time`` on the predictor."""
    at, speed, _ = predict(ahead, q, v, a, j, s)
    stand(
        time + ahead, 0.0, table, i, number, const, defects, balls, base, step, n_balls, row, gaps
    )
    return press(
        row, gaps, 0, ball, at[0] - at[2], at[1] - at[3], speed[0] - speed[2],
        speed[1] - speed[3], const[CB],
    )  # fmt: skip


@compiled(fast=FAST, borrows=True)
def _sense(state, at, h, a, j, a1, j1, const):
    """Advance one axis of the sensor by its Taylor series, for any ``h`` up to a step."""
    if h <= 0.0:
        return
    w, damped = const[RESONANCE] * h, 2.0 * const[RESONANCE_DAMPING] * const[RESONANCE] * h
    # The cubic through both accelerations and jerks, in units of h.
    slope = h * j
    square = 3.0 * (a1 - a) - h * (2.0 * j + j1)
    cube = 2.0 * (a - a1) + h * (j + j1)
    z, v = state[at], state[at + 1]
    ahead, faster = z, v
    for n in range(_TERMS):
        drive = a if n == 0 else (slope if n == 1 else (square if n == 2 else cube))
        if n > 3:
            drive = 0.0
        z, v = w * v / (n + 1), -(w * (z + drive) + damped * v) / (n + 1)
        ahead += z
        faster += v
    state[at], state[at + 1] = ahead, faster


@compiled(inline=True, fast=FAST)
def _felt(state, at, a, const):
    """Read the sensor along one axis, m/s^2."""
    if const[RESONANCE] == 0.0:
        return a
    return -state[at] - 2.0 * const[RESONANCE_DAMPING] * state[at + 1]
