# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Read vibration signals of other programs: text, MATLAB, NumPy and others, Parquet sets, MCAP.

No code in a file is executed (npz, npy and mat are read without pickle). Stated sizes are checked
before memory is allocated: reading takes at most about three times ``LARGEST_FILE``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
import math
from pathlib import Path
from typing import Any

from bearing_twin.bearing import Bearing
from bearing_twin.diagnosis.signal.acceleration import acceleration_factor, GRAVITY
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_numbers
from bearing_twin.recording.finding import ending, SIGNAL_FILES
from bearing_twin.recording.mcap.mcapfile import refuse_special
from bearing_twin.recording.signals.csvfile import read_csv, unit_in
from bearing_twin.recording.signals.dataset import dataset_signals, is_dataset, read_dataset_signal
from bearing_twin.recording.signals.lvmfile import read_lvm
from bearing_twin.recording.signals.matfile import read_mat
from bearing_twin.recording.signals.mcapsignal import read_vibration_topic, vibration_topics
from bearing_twin.recording.signals.npz import read_npy, read_npz
from bearing_twin.recording.signals.tdmsfile import read_tdms
from bearing_twin.recording.signals.timecolumn import is_even
from bearing_twin.recording.signals.ufffile import read_uff
from bearing_twin.recording.signals.wavfile import read_wav
import numpy as np
from numpy.typing import NDArray

LARGEST_FILE = 1024 * 1024 * 1024
"""Largest file, bytes. MCAP files are read in pieces and have no limit."""
MOST_SAMPLES = 100_000_000
"""Longest signal, samples (65 min at 25.6 kHz)."""
READERS: dict[str, Callable[[Path], dict[str, Any]]] = dict(
    zip(
        SIGNAL_FILES,
        (
            read_npz, read_npy, read_mat, read_wav, read_tdms, read_uff, read_uff, read_lvm,
            read_csv, read_csv, read_csv,
        ),
        strict=True,
    )
)  # fmt: skip
"""
The reader for each suffix. It returns the arrays of a file by name, and what the file says of all
(``fs``, ``rpm``, ``unit``, ...). ``each`` has what it says of single arrays, by their names, with
the ``zero`` and the ``scale`` of integers; ``remark`` is added to the source.
"""

SHORTEST = 64
"""Samples of the shortest row that is a signal; in tables of shorter rows, columns are signals."""

RATES = ('fs', 'sample_rate', 'sampling_rate', 'samplerate', 'sr', 'rate', 'freq')
TEMPERATURES = ('temperature', 'temp_c')
SPEEDS = {'shaft_hz': 1.0, 'rpm': 1.0 / 60.0, 'speed_rpm': 1.0 / 60.0}


@dataclass(frozen=True)
class Signal:
    """One channel of vibration without gaps, and the description in its file."""

    x: NDArray[np.float64]
    """Samples, shape (n,)."""
    sample_rate: float
    """Sample rate, Hz."""
    shaft_hz: float
    """Mean shaft speed, Hz; NaN if the file does not state it."""
    speeds: NDArray[np.float64]
    """Shaft speed at each sample, Hz, shape (n,); empty if it is constant or unknown."""
    unit: str
    """Unit of ``x``: ``'m/s^2'``, ``'g'`` or another one; '' if the file does not state it."""
    bearing_name: str
    temperature: float
    """Temperature, degC; NaN if the file does not state it."""
    label: str
    """Fault of the bearing stated by the file; '' if none."""
    source: str
    """File, chosen channel and remarks on the choice."""
    bearing: Bearing | None = None
    """Bearing by the fault orders in the file; None if it has none."""
    speed_measured: bool = False
    """Whether the speed comes with each block of samples, as in a recording."""


def read_signal(
    path: Path, *, channel: str | None = None, sample_rate: float | None = None
) -> Signal:
    """
    Read one vibration channel of a file.

    =========  ====================================================================================
    ``.npz``   array ``x`` (or the longest one), ``fs``, ``rpm``, ``bearing_name``, ``label``; in a
               two-dimensional array a channel is a row, or a column if the rows have fewer than
               64 values; ``rpm`` or ``shaft_hz`` may be as long as the signal
    ``.npy``   its array, as ``x`` of ``.npz``
    ``.mat``   MATLAB: the named or the longest numeric vector among variables and struct fields;
               ``fs``/``sr``, ``rpm`` and ``X123RPM`` of CWRU
    ``.wav``   a channel is a number from 0; full scale is 1
    ``.tdms``  National Instruments: ``wf_increment``, ``unit_string`` and ``rpm`` of the channel
    ``.uff``   and ``.unv``, Universal File Format: time records in data sets 58
    ``.lvm``   LabVIEW measurement: ``Delta_X``, ``Y_Unit_Label``
    ``.csv``   comma, semicolon, tab or blanks; a column ``time``, or times of day at the begin of
               the lines, give the sample rate
    ``.39``    a name that ends in a number, as ``2004.02.12.10.32.39``: read as ``.csv``
    ``.mcap``  a file or a bag folder; ``TOPIC``, ``TOPIC:y`` or ``y``; messages Vibration, Imu,
               Accel, Vector3 and Float arrays
    Parquet    a folder of the package ``bearing-datasets``; a channel is the id of a signal
    =========  ====================================================================================

    Parameters
    ----------
    path
        The file.
    channel
        Name of the channel as above, a part of it that only one channel has (``DE`` for
        ``DE_time``), or its number in the list of :func:`channels`, from 0. None: the only
        channel, or the longest one.
    sample_rate
        Sample rate, Hz. It replaces a different rate in the file, which `Signal.source` then
        mentions.

    Raises
    ------
    BearingTwinError
        If the file cannot be read, has no such channel, or its sample rate is unknown.

    """
    if is_dataset(path):
        rows = {str(row['signal_id']): row for row in dataset_signals(path)}
        found = read_dataset_signal(path, rows[_named(rows, channel or '', path)])
    elif path.is_dir() or path.suffix.lower() == '.mcap':
        if channel and ':' not in channel and channel not in ('x', 'y', 'z'):
            channel = _named(vibration_topics(path), channel, path)
        found = read_vibration_topic(path, channel, most=MOST_SAMPLES)
    else:
        found = _choose(_read_file(path), path, channel)
    said = _number(found, RATES)
    rate = said if sample_rate is None else sample_rate
    if math.isnan(rate):
        why = _text(found, 'no_rate') or 'it does not say its sample rate;'
        raise BearingTwinError(f'{path}: {why} give the rate in Hz (--sample-rate)')
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
        # In files of MFPT, sr is the sample rate and rate the shaft speed, both in Hz.
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
        speed_measured=bool(found.get('speed_measured', False)),
    )


def channels(path: Path) -> list[str]:
    """Return the names of the channels of a file that :func:`read_signal` can read."""
    if is_dataset(path):
        return [str(row['signal_id']) for row in dataset_signals(path)]
    if path.is_dir() or path.suffix.lower() == '.mcap':
        return list(vibration_topics(path))
    arrays = _read_file(path)
    numeric = _numeric(arrays)
    names = []
    for name in _candidates(numeric):
        array = numeric[name]
        # Each row of a table is a channel.
        table = array.ndim == 2 and not _is_line(array)
        names += [f'{name}:{row}' for row in range(len(array))] if table else [name]
    return names


def _named(names: Iterable[str], said: str, path: Path) -> str:
    """Return the name that equals ``said`` (in any case), or else begins with or contains it."""
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


def _read_file(path: Path) -> dict[str, Any]:
    """Return what is in a file, after checking that it exists and is not too large."""
    refuse_special(path)
    try:
        size = path.stat().st_size
    except FileNotFoundError:
        raise BearingTwinError(f'{path} does not exist') from None
    except OSError as error:
        raise BearingTwinError(f'{path} cannot be read: {error.strerror}') from None
    if ending(path) not in READERS:
        msg = f'{path}: files ending in {", ".join(SIGNAL_FILES)} and .mcap are read'
        raise BearingTwinError(f'{msg}; export it as one of them')
    if size == 0:
        raise BearingTwinError(f'{path} is empty')
    if size > LARGEST_FILE:
        msg = f'{path} has {size} bytes; at most {LARGEST_FILE}: cut it into pieces'
        raise BearingTwinError(msg)
    return READERS[ending(path)](path)


def _numeric(arrays: Mapping[str, Any]) -> dict[str, NDArray[Any]]:
    """Return the numeric arrays of a file; tables with one channel or snapshot in each row."""
    return {
        name: array.T if array.ndim == 2 and array.shape[1] < SHORTEST <= len(array) else array
        for name, array in arrays.items()
        if isinstance(array, np.ndarray) and array.dtype.kind in 'fiu' and array.size > 1
    }


def _is_line(array: NDArray[Any]) -> bool:
    """Return whether all values of an array lie along one axis."""
    return bool(max(array.shape) == array.size)


def _candidates(numeric: Mapping[str, NDArray[Any]]) -> list[str]:
    """Return the names of arrays that may be vibration."""
    others = ('t', 'time', 'time_s', 't_s', 'temp_t_s', *TEMPERATURES, *SPEEDS)
    return [name for name in numeric if name.lower() not in others]


def _choose(arrays: Mapping[str, Any], path: Path, channel: str | None) -> dict[str, Any]:
    """Return the chosen signal as ``x``, with the other arrays of the file as its description."""
    numeric = _numeric(arrays)
    name, row = _asked(numeric, path, channel)
    others: list[str] = []
    if not name:
        name, others = _likeliest(numeric)
        if row and name and _is_line(numeric[name]):
            # The number is that of an array in the list of the channels: there is no table.
            names = _candidates(numeric)
            name, row, others = names[_index(row, len(names), f'{path}: channel')], '', []
    if name not in numeric:
        held = ', '.join(list(numeric)[:10])
        raise BearingTwinError(
            f'{path} holds no array of numbers that could be a vibration: of {len(arrays)} '
            f'entries {len(numeric)} hold two real numbers or more{held and f" ({held})"}; name '
            'the samples x, or choose an entry by --channel'
        )
    x = numeric[name]
    where = f', {name}' + (f' (there is also {", ".join(others[:10])})' if others else '')
    if x.ndim > 1 and _is_line(x):
        x = x.ravel()
    if x.ndim == 2:
        index = _row_index(x, path, name, row)
        x, where = x[index], f', {name} row {index}'
    elif x.ndim > 2:
        msg = f'{path}: {name} has {x.ndim} dimensions; save each signal as a row of two'
        raise BearingTwinError(msg)
    elif row:
        msg = f'{path}: {name} has one axis of {x.size} samples: leave out the channel {row!r}'
        raise BearingTwinError(msg)
    about = arrays.get('each', {}).get(name, {})
    said = {**{key: value for key, value in arrays.items() if key != name}, **about}
    if 'scale' in about:
        # Damaged bytes may be signalling NaN, which would warn.
        with np.errstate(invalid='ignore'):
            x = (x.astype(np.float64) - about['zero']) / about['scale']
    if unit := unit_in(name):
        said['unit'] = np.array(unit)
    return {**said, 'x': x, 'where': where + arrays.get('remark', '')}


def _asked(
    numeric: Mapping[str, NDArray[Any]], path: Path, channel: str | None
) -> tuple[str, str]:
    """Return the names of array and row in ``NAME``, ``NAME:ROW`` or a number; '' for none."""
    if channel is None or channel in numeric:
        return channel or '', ''
    if channel.isdecimal():
        return '', channel
    name, _, row = channel.rpartition(':')
    if not row.isdecimal():
        name, row = channel, ''
    return _named(numeric, name, path) if name else '', row


def _likeliest(numeric: Mapping[str, NDArray[Any]]) -> tuple[str, list[str]]:
    """Return the name of the array that is most likely the vibration, and those as likely."""
    candidates = _candidates(numeric)
    # An evenly rising array is a counter or time: choose it only if there is no other.
    free = [key for key in candidates if not is_even(numeric[key])] or candidates
    # Of columns beside each other, one of speeds or temperatures is not the vibration.
    longest = max(free, key=lambda key: (numeric[key].size, bool(unit_in(key))), default='')
    name = next((key for key in ('x', 'vibration', 'acceleration') if key in numeric), longest)
    if not name or name != longest:
        return name, []
    size = numeric[name].size
    return name, [key for key in free if key != name and numeric[key].size == size]


def _row_index(x: NDArray[Any], path: Path, name: str, row: str) -> int:
    """Return the index of a row of a table; raise if none is named or there is no such row."""
    if not row:
        raise BearingTwinError(
            f'{path}: {name} has {x.shape[0]} rows of {x.shape[1]} samples; choose one of '
            f"0..{x.shape[0] - 1} as channel, e.g. '{name}:0', or judge snapshots of one "
            "machine with 'bearing-twin diagnose --series'"
        )
    return _index(row, x.shape[0], f'{path}: row')


def _index(text: str, count: int, what: str) -> int:
    if not text.isdecimal() or len(text) > 9 or int(text) >= count:
        raise BearingTwinError(f"{what} '{text}' does not exist; there are 0..{count - 1}")
    return int(text)


def _vector(values: Any, path: Path) -> NDArray[np.float64]:
    x = np.ascontiguousarray(real_numbers(f'{path}: the signal', values))
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
    """Return the shaft speed at each sample, Hz; empty if no array has that length."""
    for name, factor in SPEEDS.items():
        values = np.asarray(found.get(name, math.nan))
        if values.size == count > 1 and values.dtype.kind in 'fiu':
            speeds = values.ravel().astype(np.float64) * factor
            known = np.flatnonzero(np.isfinite(speeds))
            # A driver may learn the speed some blocks after its first samples: fill the gaps.
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
