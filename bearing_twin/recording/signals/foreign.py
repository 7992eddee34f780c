# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Vibration signals from files of other people: npz, mat, wav, csv, Parquet sets, MCAP recordings.

Nothing in a file is executed (npz and mat are read without pickle), nothing it claims is believed
before memory is spent on it: reading takes at most about three times ``LARGEST_FILE``.
"""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO
import math
from typing import Any, TYPE_CHECKING
import warnings

from bearing_twin.bearing import Bearing
from bearing_twin.diagnosis.signal.acceleration import acceleration_factor, GRAVITY
from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.finding import SIGNAL_FILES
from bearing_twin.recording.mcap.mcapfile import refuse_special
from bearing_twin.recording.signals.csvfile import is_even, read_csv
from bearing_twin.recording.signals.dataset import dataset_signals, is_dataset, read_dataset_signal
from bearing_twin.recording.signals.matfile import read_mat
from bearing_twin.recording.signals.mcapsignal import read_vibration_topic, vibration_topics
from bearing_twin.recording.signals.npz import read_npz
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray


LARGEST_FILE = 1024 * 1024 * 1024
"""Largest npz, mat, wav or csv file, bytes. MCAP files are read in pieces and have no limit."""
MOST_SAMPLES = 100_000_000
"""Longest signal, samples (65 min at 25.6 kHz)."""

SHORTEST = 64
"""Samples of the shortest row that is a signal; of shorter ones the columns are the signals."""

RATES = ('fs', 'sample_rate', 'sampling_rate', 'samplerate', 'sr', 'rate', 'freq')
TEMPERATURES = ('temperature', 'temp_c')
SPEEDS = {'shaft_hz': 1.0, 'rpm': 1.0 / 60.0, 'speed_rpm': 1.0 / 60.0}


@dataclass(frozen=True)
class Signal:
    """One channel of vibration without gaps, and what its file says about it."""

    x: NDArray[np.float64]
    """Samples, shape (n,)."""
    sample_rate: float
    """Hz."""
    shaft_hz: float
    """Mean speed; NaN where the file does not say."""
    speeds: NDArray[np.float64]
    """Shaft speed at each sample, Hz, shape (n,); empty where it does not vary, or is unknown."""
    unit: str
    """``'m/s^2'``, ``'g'``, another one, or '' where the file does not say."""
    bearing_name: str
    temperature: float
    """degC; NaN where the file does not say."""
    label: str
    """What the file says is wrong with the bearing; ''."""
    source: str
    """File, channel and what was chosen in it."""
    bearing: Bearing | None = None
    """Bearing by the fault orders that the file states."""


def read_signal(
    path: Path, *, channel: str | None = None, sample_rate: float | None = None
) -> Signal:
    """
    Read one vibration channel of a file.

    =========  ====================================================================================
    ``.npz``   array ``x`` (or the longest one), ``fs``, ``rpm``, ``bearing_name``, ``label``; of a
               two-dimensional array the channel is the row, or the column where the rows are of
               fewer than 64 values; ``rpm`` or ``shaft_hz`` may be as long as the signal
    ``.mat``   MATLAB up to version 7: the longest numeric vector or the one named, variables and
               struct fields alike; ``fs``/``sr``, ``rpm`` and CWRU's ``X123RPM``
    ``.wav``   the channel is its number from 0; full scale is 1
    ``.csv``   comma, semicolon, tab or blanks; a column ``time`` gives the sample rate
    ``.mcap``  a file or a bag folder; ``TOPIC``, ``TOPIC:y`` or ``y``; ours, Imu, Accel,
               Vector3 and Float arrays
    Parquet    a folder made by the package ``bearing-datasets``; the channel is the signal's id
    =========  ====================================================================================

    Parameters
    ----------
    path
        The file.
    channel
        Which channel, named as above, or any part of the name that only one channel has
        (``DE`` for ``DE_time``); None: the only one, or the longest.
    sample_rate
        Hz; for files that do not say it, and against what they say, which `Signal.source` names.

    Raises
    ------
    BearingTwinError
        If the file cannot be read, holds no such channel, or its sample rate is not known.

    """
    if is_dataset(path):
        rows = {str(row['signal_id']): row for row in dataset_signals(path)}
        found = read_dataset_signal(path, rows[_named(rows, channel or '', path)])
    elif path.is_dir() or path.suffix.lower() == '.mcap':
        if channel and ':' not in channel and channel not in ('x', 'y', 'z'):
            channel = _named(vibration_topics(path), channel, path)
        found = read_vibration_topic(path, channel, most=MOST_SAMPLES)
    else:
        found = _read_file(path, channel)
    said = _number(found, RATES)
    rate = said if sample_rate is None else sample_rate
    if math.isnan(rate):
        why = _text(found, 'no_rate') or 'it does not say its sample rate'
        msg = f'{path}: {why}; give it in Hz (--sample-rate)'
        raise BearingTwinError(msg)
    if not 1.0 <= rate <= 1e8:
        msg = f'{path}: sample rate {rate:g} is outside 1..1e8 Hz; give it in Hz (--sample-rate)'
        raise BearingTwinError(msg)
    where = found.get('where', '')
    if abs(rate - said) > 0.001 * rate:
        where += f' (the file says {said:g} Hz)'
    x = _vector(found['x'], path)
    speeds = _speeds(found, len(x))
    numbers = [_number(found, (name,)) * factor for name, factor in SPEEDS.items()]
    if {'sr', 'gs', 'rate'} <= found.keys() or {'sr', 'x', 'rate'} <= found.keys():
        # As MFPT writes them: sr samples a second, and a shaft that turns rate times.
        numbers.append(_number(found, ('rate',)))
    shaft_hz = next((speed for speed in numbers if speed >= 0.0), math.nan)
    return Signal(
        x=x,
        sample_rate=rate,
        shaft_hz=float(speeds.mean()) if len(speeds) else shaft_hz,
        speeds=speeds if len(speeds) and np.ptp(speeds) > 0.0 else speeds[:0],
        unit=_unit(found),
        bearing_name=_text(found, 'bearing_name') or _text(found, 'bearing'),
        temperature=_number(found, TEMPERATURES),
        label=_text(found, 'label'),
        source=f'{path}{where}',
        bearing=orders if isinstance(orders := found.get('bearing'), Bearing) else None,
    )


def channels(path: Path) -> list[str]:
    """Return the names of the channels of a file that :func:`read_signal` can read."""
    if is_dataset(path):
        return [str(row['signal_id']) for row in dataset_signals(path)]
    if path.is_dir() or path.suffix.lower() == '.mcap':
        return list(vibration_topics(path))
    arrays = _reader(path)(path)
    if path.suffix.lower() == '.wav':
        return [str(index) for index in range(arrays['table'].shape[1])]
    numeric = _numeric(arrays)
    names = []
    for name in _candidates(numeric):
        shape = numeric[name].shape
        # A row of a table is a channel of its own.
        table = len(shape) == 2 and max(shape) < numeric[name].size
        names += [f'{name}:{row}' for row in range(shape[0])] if table else [name]
    return names


def _named(names: Iterable[str], said: str, path: Path) -> str:
    """Return the one name that is ``said``, has its letters in any case, or has it as a part."""
    known = list(names)
    folded = said.casefold()
    for fits in (
        [name for name in known if name == said],
        [name for name in known if name.casefold() == folded],
        [name for name in known if name.casefold().startswith(folded)],
        [name for name in known if folded in name.casefold()],
    ):
        if len(fits) == 1:
            return fits[0]
        if fits:
            break
    listed = ', '.join((fits or known)[:20]) or 'no numeric array at all'
    listed += ', ...' if len(fits or known) > 20 else ''
    if fits:
        msg = f'{path}: channel {said!r} may be any of {listed}; name one'
    else:
        msg = f'{path} has no channel {said!r}; it has {listed}'
    raise BearingTwinError(msg)


def _reader(path: Path) -> Callable[[Path], dict[str, Any]]:
    """Return what reads the arrays of a file, which is there and not too large."""
    readers = (read_npz, read_mat, _read_wav, read_csv, read_csv, read_csv)
    reader = dict(zip(SIGNAL_FILES, readers, strict=True)).get(path.suffix.lower())
    refuse_special(path)
    try:
        size = path.stat().st_size
    except FileNotFoundError:
        msg = f'{path} does not exist'
        raise BearingTwinError(msg) from None
    except OSError as error:
        msg = f'{path} cannot be read: {error.strerror}'
        raise BearingTwinError(msg) from None
    if reader is None:
        msg = f'{path}: files ending in {", ".join(SIGNAL_FILES)} and .mcap are read'
        raise BearingTwinError(msg)
    if size == 0:
        msg = f'{path} is empty'
        raise BearingTwinError(msg)
    if size > LARGEST_FILE:
        msg = f'{path} has {size} bytes; at most {LARGEST_FILE}: cut it into pieces'
        raise BearingTwinError(msg)
    return reader


def _read_file(path: Path, channel: str | None) -> dict[str, Any]:
    arrays = _reader(path)(path)
    choose = _of_wav if path.suffix.lower() == '.wav' else _choose
    return choose(arrays, path, channel)


def _read_wav(path: Path) -> dict[str, Any]:
    # Loaded when needed: scipy takes a second.
    from scipy.io import wavfile

    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')
            rate, samples = wavfile.read(BytesIO(path.read_bytes()))
        scale = 1.0
        if samples.dtype.kind in 'iu':
            scale = float(2 ** (8 * samples.dtype.itemsize - 1))
        offset = 128.0 if samples.dtype == np.uint8 else 0.0
        table = samples.reshape(samples.shape[0], -1)
    except Exception as error:
        # The bytes come from outside: scipy raises many kinds on damaged ones.
        msg = f'{path} cannot be read as .wav ({type(error).__name__}: {error})'
        raise BearingTwinError(msg) from None
    return {'table': table, 'fs': rate, 'scale': scale, 'offset': offset}


def _of_wav(wav: Mapping[str, Any], path: Path, channel: str | None) -> dict[str, Any]:
    count = wav['table'].shape[1]
    index = _index(channel or '0', count, f'{path}: channel')
    x = (wav['table'][:, index].astype(np.float64) - wav['offset']) / wav['scale']
    where = f', channel {index}'
    if channel is None and count > 1:
        where += f' (there is also {", ".join(map(str, range(1, min(count, 11))))})'
    return {'x': x, 'fs': wav['fs'], 'where': where}


def _numeric(arrays: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Arrays of numbers among those of a file; of tables a channel or a snapshot in each row."""
    return {
        name: array.T if array.ndim == 2 and array.shape[1] < SHORTEST <= len(array) else array
        for name, array in arrays.items()
        if isinstance(array, np.ndarray) and array.dtype.kind in 'fiu' and array.size > 1
    }


def _candidates(numeric: Mapping[str, NDArray[Any]]) -> list[str]:
    """Names of arrays that may be a vibration."""
    others = ('t', 'time', 'time_s', 't_s', 'temp_t_s', *TEMPERATURES, *SPEEDS)
    return [name for name in numeric if name.lower() not in others]


def _choose(arrays: Mapping[str, Any], path: Path, channel: str | None) -> dict[str, Any]:
    """Pick the signal among the arrays of a file and keep the rest as its description."""
    numeric = _numeric(arrays)
    name, row = channel, ''
    others: list[str] = []
    if channel is not None and channel not in numeric:
        name, _, row = channel.rpartition(':')
        if channel.isdecimal():
            name, row = '', channel
        elif not row.isdecimal():
            name, row = channel, ''
        name = _named(numeric, name, path) if name else name
    if not name:
        candidates = _candidates(numeric)
        # A counter or a time without a name is the vibration only where there is nothing else.
        free = [key for key in candidates if not is_even(numeric[key])] or candidates
        longest = max(free, key=lambda key: numeric[key].size, default='')
        name = next((key for key in ('x', 'vibration', 'acceleration') if key in numeric), longest)
        if name == longest and name:
            size = numeric[name].size
            others = [key for key in free if key != name and numeric[key].size == size]
    if name not in numeric:
        msg = f'{path} holds no array of numbers that could be a vibration'
        raise BearingTwinError(msg)
    x = numeric[name]
    where = f', {name}' + (f' (there is also {", ".join(others[:10])})' if others else '')
    if x.ndim > 1 and max(x.shape) == x.size:
        x = x.ravel()
    if x.ndim == 2:
        if not row:
            msg = (
                f'{path}: {name} has {x.shape[0]} rows of {x.shape[1]} samples; choose one of '
                f"0..{x.shape[0] - 1} as channel, e.g. '{name}:0', or judge snapshots of one "
                "machine with 'bearing-twin diagnose --series'"
            )
            raise BearingTwinError(msg)
        index = _index(row, x.shape[0], f'{path}: row')
        x, where = x[index], f', {name} row {index}'
    elif x.ndim > 2 or row:
        msg = f'{path}: {name} has one axis of {x.size} samples: leave out the channel {row!r}'
        if x.ndim > 2:
            msg = f'{path}: {name} has {x.ndim} dimensions; save each signal as a row of two'
        raise BearingTwinError(msg)
    said = {key: value for key, value in arrays.items() if key != name}
    return {**said, 'x': x, 'where': where}


def _index(text: str, count: int, what: str) -> int:
    if not text.isdecimal() or len(text) > 9 or int(text) >= count:
        msg = f"{what} '{text}' does not exist; there are 0..{count - 1}"
        raise BearingTwinError(msg)
    return int(text)


def _vector(values: Any, path: Path) -> NDArray[np.float64]:
    x = np.ascontiguousarray(values, dtype=np.float64)
    if not 1 <= x.size <= MOST_SAMPLES:
        msg = f'{path}: the signal has {x.size} samples; 1..{MOST_SAMPLES} are read'
        raise BearingTwinError(msg)
    return x


def _number(found: Mapping[str, Any], names: tuple[str, ...]) -> float:
    """Return the first finite scalar under one of ``names`` (any case); NaN if there is none."""
    folded = {key.lower(): value for key, value in found.items()}
    for name in names:
        value = np.asarray(folded.get(name.lower(), math.nan))
        if value.size == 1 and value.dtype.kind in 'fiu' and np.isfinite(value.item()):
            return float(value.item())
    return math.nan


def _speeds(found: Mapping[str, Any], count: int) -> NDArray[np.float64]:
    """Shaft speed at each sample, Hz; empty where there is no array of that length."""
    for name, factor in SPEEDS.items():
        values = np.asarray(found.get(name, math.nan))
        if values.size == count > 1 and values.dtype.kind in 'fiu':
            speeds = values.ravel().astype(np.float64) * factor
            known = np.flatnonzero(np.isfinite(speeds))
            # A driver knows its first speed some blocks after its first samples.
            if known.size == 0:
                break
            filled: NDArray[np.float64] = np.interp(np.arange(count), known, speeds[known])
            return filled
    return np.zeros(0)


def _text(found: Mapping[str, Any], name: str) -> str:
    value = np.asarray(found.get(name, ''))
    return str(value.item())[:200] if value.size == 1 and value.dtype.kind in 'US' else ''


def _unit(found: Mapping[str, Any]) -> str:
    unit = _text(found, 'unit').strip()[:20]
    if not unit and '(g)' in _text(found, 'sensor'):
        unit = 'g'
    return {1.0: 'm/s^2', GRAVITY: 'g'}.get(acceleration_factor(unit), unit)
