# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Shaft speed over a record whose speed moves, from the lines of the shaft in its vibration."""

from __future__ import annotations

import math

from bearing_twin.diagnosis.signal.spectra import local_floor
import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.ndimage import uniform_filter1d

_HARMONICS = 5
_LOWEST, _HIGHEST = 0.25, 2.0
"""Range of the speed, relative to the given one: a given speed is the highest of a record that
starts up or coasts down, or its mean."""
_FRAME_TURNS = 12.0
"""Length of the first frames, turns at the given speed: long enough to part the harmonics, short
enough for a speed that doubles within a hundred turns."""
_RATIO = 0.01
"""Ratio between neighbouring speeds of the first pass, less one."""
_REFINEMENTS = ((16.0, 0.04, 0.004), (24.0, 0.015, 0.0015), (32.0, 0.006, 0.0005))
"""Turns of a frame, reach and ratio of each further pass. It takes the record at equal angles of
the pass before, so that its frames can be longer."""
_PER_TURN = 48
"""Samples a turn at equal angles."""
_HOPS = 4
"""Frames that overlap at a time."""
_AT_ONCE = 64
"""Frames that are transformed at once: those of an hour would take a gigabyte."""
_FLOOR_TURNS = 4.0
"""Width of the floor, in speeds of the shaft: as wide as that of `refine_shaft_hz`."""
_PENALTY = 0.03
"""Cost of a change by one ratio from frame to frame, against jumps of the path by chance."""
_STEEPEST = 10
"""Largest change from frame to frame, in ratios: 10 % in three turns."""
_SHOWN = 1.4
"""Mean log power over the floor of the harmonics on the path, from which it is that of a shaft:
in white noise (150 records of 5 to 12 s at 8 to 60 Hz) the mean is 0.91 and the highest 0.99."""
_FAINTEST = 1.05
"""The same after the first pass, from which the path is refined: white noise has at most 0.97, a
shaft whose moving speed is found in the end at least 1.14 (181 simulated records)."""

PRECISION = _RATIO
"""Relative error of the speeds that must be allowed for: in 79 of 79 simulated records the median
error is at most half of it."""

_MOVES = 0.02
"""Least relative change of the speed, over the middle 80 % of its values, that is a movement: at a
steady one it is 0.8 % in the median of simulated records, the steps of the first pass."""


def track_speed(
    x: NDArray[np.float64], sample_rate: float, given_hz: float
) -> NDArray[np.float64] | None:
    """
    Return the speed of the shaft at each sample, from its lines; None if they do not show it.

    The harmonics of each speed are summed in the spectra of short frames; the speeds of successive
    frames are the path of the highest sum, with a cost for changes (Viterbi; of several orders as
    in Leclere et al., Mech. Syst. Signal Process. 2016, 81, 37). The path is refined in longer
    frames at equal angles.

    Parameters
    ----------
    x
        Samples, shape (n,).
    sample_rate
        Hz.
    given_hz
        Shaft speed at some time of the record, or its mean, Hz.

    Returns
    -------
    Speeds, Hz, shape (n,). None if no lines of a shaft show, if the speed is steady, or if it is
    nowhere the given one.

    >>> rate, count = 2000.0, 16000
    >>> hertz = np.linspace(20.0, 30.0, count)
    >>> turns = np.cumsum(hertz) / rate
    >>> noise = np.random.default_rng(0).standard_normal(count)
    >>> x = noise + sum(np.cos(2.0 * np.pi * k * turns) for k in (1, 2, 3, 4))
    >>> found = track_speed(x, rate, 25.0)
    >>> bool(np.median(np.abs(found / hertz - 1.0)) < 0.005)
    True
    >>> track_speed(noise, rate, 25.0) is None
    True

    """
    padded = fft.next_fast_len(len(x), real=True)
    # Scaled, because powers of any unit must fit single precision.
    scaled = ((x - x.mean()) / max(float(x.std()), 1e-300)).astype(np.float32)
    spectrum = fft.rfft(scaled, padded)
    highest = math.ceil(2.0 * _HARMONICS * _HIGHEST * given_hz / sample_rate * padded)
    count = 2 * min(highest, padded // 2)
    rate = sample_rate * count / padded
    low = fft.irfft(spectrum, count)[: int(len(x) / sample_rate * rate)]
    frame = int(_FRAME_TURNS * rate / given_hz)
    if len(low) < 4 * frame:
        return None
    ratios = np.arange(math.log(_LOWEST), math.log(_HIGHEST), _RATIO)
    path, shown = _path(low, frame, np.exp(ratios) * given_hz / rate, given_hz / rate, _STEEPEST)
    speeds = np.exp(path) * rate
    if shown < _FAINTEST or _change(speeds) < 0.5 * _MOVES:
        return None
    numbers = np.arange(len(low))
    for turns, reach, ratio in _REFINEMENTS:
        angle = np.concatenate(([0.0], np.cumsum(speeds[:-1]) / rate))
        even = np.arange(int(angle[-1] * _PER_TURN)) / _PER_TURN
        frame = int(turns * _PER_TURN)
        if len(even) < 2 * frame:
            return None
        at_angles = np.interp(np.interp(even, angle, numbers), numbers, low)
        near = np.exp(np.arange(-reach, reach + 0.5 * ratio, ratio)) / _PER_TURN
        path, shown = _path(at_angles, frame, near, 1.0 / _PER_TURN, 3)
        speeds = speeds * np.exp(np.interp(angle, even, path)) * _PER_TURN
    as_given = speeds.min() <= (1.0 + _MOVES) * given_hz <= (1.0 + _MOVES) ** 2 * speeds.max()
    if not (shown >= _SHOWN and _change(speeds) > _MOVES and as_given):
        return None
    return np.asarray(np.interp(np.arange(len(x)) / sample_rate, numbers / rate, speeds))


def _change(speeds: NDArray[np.float64]) -> float:
    """Return the relative change of a speed over the middle 80 % of its values."""
    least, most = np.percentile(speeds, (10.0, 90.0))
    return float(most / least) - 1.0


def _path(
    x: NDArray[np.float64], frame: int, grid: NDArray[np.float64], turn: float, reach: int
) -> tuple[NDArray[np.float64], float]:
    """
    Return the log speed at each sample, in turns a sample, and the mean log power on the path.

    ``grid`` has the possible speeds, in equal ratios, ``turn`` the usual one, and ``reach`` is the
    most that the path may move from frame to frame.
    """
    count = 1 << math.ceil(math.log2(4 * frame))
    window = np.hanning(frame)
    width = max(int(_FLOOR_TURNS * turn * count), 32)
    lines = np.rint(np.arange(1, _HARMONICS + 1)[:, None] * grid * count).astype(np.intp)
    lines = lines.clip(max=count // 2)
    starts = np.arange(0, len(x) - frame + 1, frame // _HOPS)
    frames = np.lib.stride_tricks.sliding_window_view(x, frame)
    scores = np.empty((len(starts), len(grid)))
    for first in range(0, len(starts), _AT_ONCE):
        some = slice(first, first + _AT_ONCE)
        spectra = fft.rfft((frames[starts[some]] * window).astype(np.float32), count)
        power = np.square(np.abs(spectra))
        logs = np.log1p(power / local_floor(power, width))
        scores[some] = logs[:, lines].mean(axis=1)
    rows = _highest_path(scores, reach)
    # The path has steps, which are shorter than a frame, so that later passes would keep them.
    smooth = uniform_filter1d(np.log(grid)[rows], 2 * _HOPS + 1, mode='nearest')
    path = np.interp(np.arange(len(x)), starts + 0.5 * frame, smooth)
    return path, float(scores[np.arange(len(rows)), rows].mean())


def _highest_path(scores: NDArray[np.float64], reach: int) -> NDArray[np.intp]:
    """Return the column of each row of the path with the highest sum, less its changes."""
    steps = np.arange(-reach, reach + 1)
    total, back = scores[0], np.zeros(scores.shape, np.intp)
    for row in range(1, len(scores)):
        before = np.lib.stride_tricks.sliding_window_view(
            np.pad(total, reach, constant_values=-np.inf), 2 * reach + 1
        ) - _PENALTY * np.abs(steps)
        best = before.argmax(axis=1)
        total = before[np.arange(len(best)), best] + scores[row]
        back[row] = np.arange(len(best)) + steps[best]
    rows = np.empty(len(scores), np.intp)
    rows[-1] = total.argmax()
    for row in range(len(scores) - 1, 0, -1):
        rows[row - 1] = back[row, rows[row]]
    return rows
