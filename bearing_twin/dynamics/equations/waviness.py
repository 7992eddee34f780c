# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
# Compiled functions take tuples and arrays of many shapes; the docstrings give their types.
# mypy: disable-error-code="no-untyped-def,no-untyped-call"
"""
Waviness of races and balls, the source of vibration of a healthy bearing.

Each race has a random profile around its circumference, and each ball has one along its rolling
track. The distance of a surface below its mean opens the gap of the ball at that place.
`TwinParameters.waviness` is the RMS velocity v that the bearing would show in each of the three
bands of a bearing vibration test: 50 to 300, 300 to 1800 and 1800 to 10000 Hz at 1800 rpm (ISO
15242-1 and -2; the makers' vibration classes set the limits).

In this test an axial load presses all Z balls equally. As the gaps w_j of the balls change, the
ring moves by ``(2/Z) sum w_j cos theta_j``. For a profile that passes f_1 times per second and has
the fraction s of the power, let P_n be the mean square of order n. Then

    s v^2 = (2/Z) sum_band (2 pi n f_1)^2 P_n ,   P_n = c / n^3
    c = s v^2 Z / (2 (2 pi f_1)^2 ln 6)

since ``sum 1/n`` over a band with an edge ratio of 6 is ln 6. Ground and honed surfaces have such
spectra: their amplitudes fall with about the power 1.5 of the order (Wensing, On the dynamics of
ball bearings, thesis, Twente 1998). With equal finish, each race has a quarter of the power and
the balls, which touch both races, have half of it.

Order 1 of a race is excluded: it is an eccentricity. Only even orders of a ball change its
diameter (Harris and Kotzalas, Advanced Concepts of Bearing Technology, 5th ed., chapter 14). The
spin axis of a ball wanders, so its track closes only after `layout.SPIN_TURNS` turns. Waves
shorter than `_SHORTEST` are left out: the contact, which is that long in the rolling direction,
bridges them. The oil film covers roughness, which is shorter still. Since the spectrum is limited,
the lowest band shows 18 % less than v and the highest 12 % less (6307, 6001 and 6320; 35 and 6 %
for the angular contact bearing 7218B).

The default of 50 um/s is a choice, not a class of a standard. ISO 15242 describes the measurement
and sets no limits; JB/T 10187 and GB/T 32325 set limits by size for the classes V (any bearing) to
V4, but their tables were not available to us. With the default, the outer race of a 6307 has RMS
amplitudes of 0.2 um at 2 waves and 17 nm at 10 waves, and a healthy bearing of the presets
vibrates with some tenths of a m/s^2. To match a real bearing, choose v in one of three ways:

- from a vibration test: the quadratic mean of its three bands;
- from a roundness trace with an RMS amplitude a_n of n waves:
  ``v = 2 pi f_1 a_n sqrt(2 ln 6 n^3 / (s Z))``, with s = 1/4 and f_1 at 30 Hz (outer race
  ``30 ftf``, inner race ``30 (1 - ftf)``, with ftf of `fault_orders`);
- from a healthy machine: compare its vibration level with that of a healthy twin.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.bearing import fault_orders
from bearing_twin.dynamics.equations.layout import SPIN_TURNS
from bearing_twin.numerics.compiled import compiled, FAST
from bearing_twin.numerics.random import normal_pair, SURFACE
from bearing_twin.numerics.vector import chosen, L, load, load_fours, splat, store
import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from bearing_twin.dynamics.parameters import TwinParameters


FloatArray = npt.NDArray[np.float64]

_F = np.float32
_TEST_HZ = 30.0
"""Shaft speed of the vibration test, Hz (1800 rpm)."""
_BAND = math.log(6.0)
"""Logarithm of the edge ratio of a band."""
_SHORTEST = 0.02
"""Shortest wavelength over ball diameter: 0.28 mm for a 6307, whose contact with the inner race is
0.3 mm long under 1 kN (Hertz)."""
_NODES = 3
"""Nodes of a table per shortest wavelength."""
REPEATED = 3
"""Nodes of a table that are repeated at its ends."""
_DRAWS = 1 << 20
"""Distance between the first random numbers of two profiles."""


class Surfaces(NamedTuple):
    """Tables of all profiles of one bearing."""

    table: Any
    """float32: profiles one after the other; gap, m, and slope, m per node, of each node. One node
    before the first and two after the last are repeated, for positions rounded beyond the ends."""
    outer: int
    """Nodes per turn of the outer race; 0 for perfect surfaces."""
    inner: int
    ball: int
    """Nodes of the track of a ball, which is `layout.SPIN_TURNS` turns long."""
    room: Any
    """float32: output of `look_up_gaps`, padded to a multiple of `vector.L` balls; zero before."""
    places: Any
    """float32, (2, balls) flat: nodes by which each ball is ahead of ball 0, on each race."""
    begins: Any
    """int64[3, balls]: index in `table` of the first node of each ball's profiles."""
    highest: float
    """Upper bound of the gap reduction by waviness, m."""


def profiles(p: TwinParameters, seed: int) -> list[tuple[FloatArray, FloatArray]]:
    """
    Return random profiles of outer race, inner race and balls: gap, m, and slope, m per round.

    Their nodes are equidistant on a turn of the race or the track of a ball, shape (1, nodes) or
    (balls, nodes). The number of nodes of a race is a multiple of the number of balls.

    Examples
    --------
    The races of a 6307 have a roundness error below a micrometre:

    >>> from bearing_twin.dynamics import preset
    >>> outer, inner, balls = profiles(preset('paper'), seed=0)
    >>> outer[0].shape, balls[0].shape
    ((1, 2408), (8, 942))
    >>> bool(0.1e-6 < outer[0].std() < 1e-6)
    True

    """
    bearing, orders = p.bearing, fault_orders(p.bearing)
    g, n = bearing.gamma, bearing.n_balls
    around, turns = math.pi / bearing.d_ball * bearing.d_pitch, SPIN_TURNS
    # Length over ball diameter, divisor of the number of nodes, passes per shaft turn, lowest
    # order, fraction of the power, random number streams.
    kinds = (
        (around * (1.0 + g), n, orders.ftf, 2, 0.25, [0]),
        (around * (1.0 - g), n, 1.0 - orders.ftf, 2, 0.25, [1]),
        (math.pi * turns, 1, orders.bsf / turns, round(2.0 * turns), 0.5, range(2, 2 + n)),
    )
    found = []
    for length, parts, rate, lowest, share, streams in kinds:
        most = int(length / _SHORTEST)
        nodes = parts * math.ceil(_NODES * most / parts)
        order = np.arange(lowest, most + 1)
        passing = 2.0 * math.pi * rate * _TEST_HZ
        power = share * p.waviness**2 * n / (2.0 * passing**2 * _BAND)
        spectrum = np.zeros((len(streams), nodes // 2 + 1), complex)
        for row, stream in zip(spectrum, streams, strict=True):
            row[order] = _draws(_DRAWS * stream, len(order), seed)
        spectrum[:, order] *= np.sqrt(power / order**3.0) * (0.5 * nodes)
        slopes = 2j * math.pi * np.arange(nodes // 2 + 1) * spectrum
        found.append((np.fft.irfft(spectrum, nodes), np.fft.irfft(slopes, nodes)))
    return found


@compiled()
def _draws(first, count, seed):
    """Return complex random numbers with standard normal real and imaginary parts."""
    numbers = np.empty(count, np.complex128)
    for k in range(count):
        real, imaginary = normal_pair(first + k, SURFACE, seed)
        numbers[k] = complex(real, imaginary)
    return numbers


def surfaces(p: TwinParameters, seed: int) -> Surfaces:
    """
    Return the surface tables of one bearing.

    Examples
    --------
    >>> from bearing_twin.dynamics import preset
    >>> surfaces(preset('paper'), seed=0)[1:4]
    (2408, 1464, 942)

    """
    n = p.bearing.n_balls
    if p.waviness == 0.0:
        return _laid_out(np.zeros(2 * (3 + n) * REPEATED, np.float32), n, 0, 0, 0)
    parts, nodes, highest = [], [], 0.0
    for gaps, slopes in profiles(p, seed):
        rows = np.stack([gaps, slopes / gaps.shape[1]], axis=-1)
        parts.append(np.pad(rows, ((0, 0), (1, REPEATED - 1), (0, 0)), 'wrap').ravel())
        nodes.append(gaps.shape[1])
        # A cubic may exceed its nodes by a quarter of the end slopes.
        highest += float(np.abs(gaps).max() + 0.25 * np.abs(slopes).max() / gaps.shape[1])
    outer, inner, ball = nodes
    table = np.concatenate(parts).astype(np.float32)
    return _laid_out(table, n, outer, inner, ball, highest)


def _laid_out(
    table: Any, n_balls: int, outer: int, inner: int, ball: int, highest: float = 0.0
) -> Surfaces:
    """
    Return the tables of one bearing from the joined profiles and their numbers of nodes.

    Examples
    --------
    >>> _laid_out(np.zeros(100, np.float32), 3, 6, 6, 4).begins[:, :3].tolist()
    [[2, 2, 2], [20, 20, 20], [38, 52, 66]]

    """
    padded = -(-n_balls // L) * L
    number = np.zeros(padded)
    number[:n_balls] = np.arange(n_balls)
    places = np.stack([number * (outer // n_balls), number * (inner // n_balls)])
    first = np.array([[0], [outer + REPEATED], [outer + inner + 2 * REPEATED]])
    begins = 2 * (1 + first + np.array([[0], [0], [1]]) * number * (ball + REPEATED))
    room = np.zeros(2 * padded, np.float32)
    return Surfaces(
        table, outer, inner, ball, room, places.astype(np.float32).ravel(),
        begins.astype(np.int64), highest,
    )  # fmt: skip


@compiled(inline=True, fast=FAST)
def _node(share, nodes):
    """Return the node at the fraction ``share`` of a table, and the fraction to the next node."""
    along = share * nodes
    node = _held(int(along), nodes)
    return node, _F(along - node)


@compiled(inline=True)
def _held(number, count):
    """Clamp ``number`` to 0..count - 1, so that no phase leads out of a table."""
    return min(max(number, 0), count - 1)


@compiled(inline=True, fast=FAST)
def gap_at(table, begins, row, node, u, rate):
    """
    Return gap, m, and its rate, m/s, at the fraction ``u`` between two nodes; ``rate`` is nodes/s.

    ``row`` and ``begins`` are arguments of `vector.load_fours`.
    """
    here, slope, there, other = load_fours(table, begins, row, node)
    v, rise = _F(1.0) - u, there - here
    uv = u * v
    gap = here + rise * (u * u * (_F(1.0) + _F(2.0) * v)) + (slope * (uv * v) - other * (u * uv))
    first, last = v * (v - _F(2.0) * u) * rate, u * (u - _F(2.0) * v) * rate
    return gap, rise * (_F(6.0) * uv * rate) + (slope * first + other * last)


@compiled()
def with_own_room(surfaces):
    """Return a copy with its own ``room``, for use in parallel."""
    s = surfaces
    room = np.zeros_like(s.room)
    return Surfaces(s.table, s.outer, s.inner, s.ball, room, s.places, s.begins, s.highest)


@compiled(inline=True, fast=FAST)
def look_up_gaps(surfaces, n_balls, phases, rates, room):
    """
    Fill ``room`` with the gaps due to waviness, m, then their rates, m/s.

    ``phases``, turns, and ``rates``, turns/s, are those of cage, shaft and ball spin; ``room`` as
    in `Surfaces`.
    """
    table, begins = surfaces.table, surfaces.begins
    turn = phases[0] - phases[1]
    outer, inner = phases[0] - math.floor(phases[0]), turn - math.floor(turn)
    round_it = phases[2] / SPIN_TURNS
    outer, inner, ball = outer * n_balls, inner * n_balls, round_it - math.floor(round_it)
    outer_cells, inner_cells = surfaces.outer // n_balls, surfaces.inner // n_balls
    outer_part, inner_part = _held(int(outer), n_balls), _held(int(inner), n_balls)
    outer_node, outer_u = _node(outer - outer_part, outer_cells)
    inner_node, inner_u = _node(inner - inner_part, inner_cells)
    ball_node, ball_u = _node(ball, surfaces.ball)
    outer_from = splat(_F(outer_part * outer_cells + outer_node))
    inner_from = splat(_F(inner_part * inner_cells + inner_node))
    ball_from = splat(_F(ball_node))
    outer_turn, inner_turn = splat(_F(surfaces.outer)), splat(_F(surfaces.inner))
    outer_rate = _F(rates[0] * surfaces.outer)
    inner_rate = _F((rates[0] - rates[1]) * surfaces.inner)
    ball_rate = _F(rates[2] / SPIN_TURNS * surfaces.ball)
    rows = room.shape[0] // (2 * L)
    for row in range(rows):
        node = outer_from + load(surfaces.places, row)
        node = chosen(node >= outer_turn, node - outer_turn, node)
        gap, rate = gap_at(table, begins, row, node, outer_u, outer_rate)
        node = inner_from + load(surfaces.places, rows + row)
        node = chosen(node >= inner_turn, node - inner_turn, node)
        more, faster = gap_at(table, begins, rows + row, node, inner_u, inner_rate)
        gap, rate = gap + more, rate + faster
        more, faster = gap_at(table, begins, 2 * rows + row, ball_from, ball_u, ball_rate)
        store(room, row, gap + more)
        store(room, rows + row, rate + faster)
