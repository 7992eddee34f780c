# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Read Parquet data sets of the PyPI package ``bearing-datasets``, layout versions 1 and 2.

A folder holds ``metadata.parquet`` with one row per signal (one channel of one recording), and
``signals/`` with the samples: each signal is one row of one row group of a file.
"""

from __future__ import annotations

import functools
from pathlib import Path
import re
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import bearing_of_orders, FaultFrequencies
from bearing_twin.errors import BearingTwinError
from bearing_twin.given import real_numbers
from bearing_twin.recording.mcap.mcapfile import refuse_special
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


DatasetSignal = dict[str, Any]
"""One row of the metadata, by the column names of layout version 2."""

TABLE = 'metadata.parquet'
LABELS = {'normal': 'healthy', 'rolling_element': 'ball', 'ball': 'ball'}
"""Labels of this package for fault types that have other names in data sets."""
RENAMED = {'condition': 'fault_type', 'rpm': 'speed_rpm'}
"""Columns of layout version 1, and their names in version 2."""
VOLTS = {'V': 1.0, 'mV': 1e-3}
VIBRATION = ('acceleration', 'velocity', 'displacement', 'sound_pressure', 'unknown')
MOST_ROWS = 1_000_000


def is_dataset(path: Path) -> bool:
    """Return whether a path is the folder of a data set."""
    return (path / TABLE).is_file()


def dataset_signals(path: Path) -> list[DatasetSignal]:
    """
    Return the metadata of the signals that can be vibration, in the order of the data set.

    A signal of varying speed has no ``speed_rpm``, because one number cannot describe it.
    """
    table = path / TABLE
    # Cached: each signal needs the table, and reading one of 17 000 signals takes 0.6 s.
    return _signals(path, table.stat().st_mtime_ns if table.is_file() else 0)


@functools.lru_cache(maxsize=1)
def _signals(path: Path, _changed_ns: int) -> list[DatasetSignal]:
    table = _read(path / TABLE, lambda parquet: parquet.read())
    if table.num_rows > MOST_ROWS:
        msg = f'{path} has {table.num_rows} signals; at most {MOST_ROWS} are read'
        raise BearingTwinError(msg)
    names = [RENAMED.get(name, name) for name in table.column_names]
    needed = ('signal_id', 'fs', 'signal_file', 'signal_row_group', 'signal_row')
    missing = [name for name in needed if name not in names]
    if missing:
        raise BearingTwinError(
            f'{path / TABLE} has no column {", ".join(missing)}; was it made by bearing-datasets?'
        )
    # Times are not needed, and converting times in ns to Python objects would need pandas.
    plain = [
        name
        for name, field in zip(names, table.schema, strict=True)
        if str(getattr(field.type, 'unit', '')) != 'ns'
    ]
    try:
        rows: list[DatasetSignal] = table.rename_columns(names).select(plain).to_pylist()
    except ValueError as error:
        # Of damaged texts that are no UTF-8, among others.
        raise BearingTwinError(f'{path / TABLE} cannot be read as Parquet ({error})') from None
    signals = [row for row in rows if str(row.get('quantity', 'unknown')) in VIBRATION]
    if len({str(row['signal_id']) for row in signals}) < len(signals):
        msg = f'{path / TABLE} has one signal_id twice; each signal needs its own'
        raise BearingTwinError(msg)
    for row in signals:
        if row.get('speed_profile') not in (None, 'constant', 'unknown'):
            row.pop('speed_rpm', None)
    return signals


def chosen_signals(path: Path, channel: str | None) -> list[DatasetSignal]:
    """Return the signals whose id contains each word of ``channel``; with None all signals."""
    signals, words = dataset_signals(path), (channel or '').casefold().split()
    found = [row for row in signals if all(w in str(row['signal_id']).casefold() for w in words)]
    if not found:
        listed = ', '.join(str(row['signal_id']) for row in signals[:10]) or 'no vibration'
        raise BearingTwinError(f'{path} has no signal with {channel!r} in its id; it has {listed}')
    return found


def fault_label(row: DatasetSignal) -> str:
    """Return the fault stated by the data set as a label of this package; '' if it has none."""
    said = str(row.get('fault_type', ''))
    return LABELS.get(said, said if said in ('inner', 'outer', 'cage') else '')


def dataset_bearing(row: DatasetSignal) -> Bearing | None:
    """Return the bearing by the four fault orders in the data set; None if one is missing."""
    said = [row.get(name) for name in ('bpfo', 'bpfi', 'bsf', 'ftf')]
    orders = [order for order in said if isinstance(order, float) and order > 0.0]
    if len(orders) < len(said):
        return None
    model = str(row.get('bearing_model', 'of the data set'))
    return bearing_of_orders(model, FaultFrequencies(*orders))


def read_dataset_signal(path: Path, row: DatasetSignal) -> dict[str, Any]:
    """
    Return one signal of a data set: its samples ``x`` and its description.

    The entries are those that :func:`bearing_twin.recording.signals.signalfile.read_signal` uses.
    """
    name = Path(str(row['signal_file'])).name
    group, index = row['signal_row_group'], row['signal_row']
    file = path / 'signals' / name
    try:
        column = _read(file, lambda parquet: parquet.read_row_group(group, columns=['signal']))
        if index < 0:
            raise IndexError('rows count from 0')
        x = column.column(0).combine_chunks()[index].values.to_numpy(zero_copy_only=False)
    except (IndexError, AttributeError, TypeError, OverflowError) as error:
        msg = f'{file} has no signal {row["signal_id"]} in row {index} of group {group} ({error})'
        raise BearingTwinError(msg) from None
    x = real_numbers(f'{file}: the signal {row["signal_id"]}', x)
    factor, unit = _physical(row)
    profile = row.get('speed_profile')
    found: dict[str, Any] = {
        'x': x if factor == 1.0 else x * factor,
        'fs': np.array(row['fs']),
        'unit': np.array(unit),
        'bearing_name': np.array(str(row.get('bearing_model', ''))),
        'label': np.array(fault_label(row)),
        'where': f', {row["signal_id"]}' + (f' (speed: {profile})' if profile else ''),
    }
    if isinstance(row.get('speed_rpm'), (int, float)):
        found['rpm'] = np.array(float(row['speed_rpm']))
    return found | {'bearing': dataset_bearing(row)}


def _physical(row: DatasetSignal) -> tuple[float, str]:
    """Return factor and unit that turn the samples into acceleration; 1.0, '' if unknown."""
    unit, factor = str(row.get('unit', '')), 1.0
    said = re.fullmatch(r'(\d*\.?\d*) (m?V)/\(?([^()]+)\)?', str(row.get('sensitivity', '')))
    if said and unit in VOLTS and said[1].strip('0.'):
        factor, unit = VOLTS[unit] / (float(said[1]) * VOLTS[said[2]]), said[3]
    return (factor, unit) if unit in ('g', 'm/s^2') else (1.0, '')


def _read(file: Path, action: Any) -> Any:
    # Imported when needed: the import takes half a second.
    import pyarrow
    from pyarrow import parquet

    try:
        refuse_special(file)
        with parquet.ParquetFile(file) as opened:
            return action(opened)
    except (pyarrow.ArrowException, OSError, IndexError, UnicodeDecodeError) as error:
        reason = next(iter(str(error).splitlines()), type(error).__name__)
        raise BearingTwinError(f'{file} cannot be read as Parquet ({reason})') from None
