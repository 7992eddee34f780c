# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Data sets in the Parquet form of the PyPI package ``bearing-datasets``, layout versions 1 and 2.

A folder holds ``metadata.parquet``, one row a signal (one channel of one recording), and
``signals/``, whose files hold the samples of a signal in one row of one row group.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import bearing_of_orders, FaultFrequencies
from bearing_twin.errors import BearingTwinError
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.bearing import Bearing


DatasetSignal = dict[str, Any]
"""One row of the metadata, by the column names of layout version 2."""

TABLE = 'metadata.parquet'
LABELS = {'normal': 'healthy', 'rolling_element': 'ball', 'ball': 'ball'}
"""Our words for fault types that are called otherwise."""
RENAMED = {'condition': 'fault_type', 'rpm': 'speed_rpm'}
"""Columns of layout version 1."""
VIBRATION = ('acceleration', 'velocity', 'displacement', 'sound_pressure', 'unknown')
MOST_ROWS = 1_000_000


def is_dataset(path: Path) -> bool:
    """Whether a path is a folder in this form."""
    return (path / TABLE).is_file()


def dataset_signals(path: Path) -> list[DatasetSignal]:
    """
    Return the signals of a data set that can be vibration, in its order.

    Raises
    ------
    BearingTwinError
        If the folder cannot be read or its table lacks a column that every signal needs.

    """
    table = _read(path / TABLE, lambda parquet: parquet.read())
    if table.num_rows > MOST_ROWS:
        msg = f'{path} has {table.num_rows} signals; at most {MOST_ROWS} are read'
        raise BearingTwinError(msg)
    names = [RENAMED.get(name, name) for name in table.column_names]
    needed = ('signal_id', 'fs', 'signal_file', 'signal_row_group', 'signal_row')
    missing = [name for name in needed if name not in names]
    if missing:
        msg = (
            f'{path / TABLE} has no column {", ".join(missing)}; was it made by bearing-datasets?'
        )
        raise BearingTwinError(msg)
    # Times are not needed, and those in ns become Python's only through pandas.
    plain = [
        name
        for name, field in zip(names, table.schema, strict=True)
        if str(getattr(field.type, 'unit', '')) != 'ns'
    ]
    rows: list[DatasetSignal] = table.rename_columns(names).select(plain).to_pylist()
    return [row for row in rows if str(row.get('quantity', 'unknown')) in VIBRATION]


def fault_label(row: DatasetSignal) -> str:
    """Return what the data set says is wrong in our words; '' where they have none for it."""
    said = str(row.get('fault_type', ''))
    return LABELS.get(said, said if said in ('inner', 'outer', 'cage') else '')


def dataset_bearing(row: DatasetSignal) -> Bearing | None:
    """
    Return the bearing by the fault orders that a data set states; None where it states none.

    Raises
    ------
    BearingTwinError
        If no bearing has such orders.

    """
    said = [row.get(name) for name in ('bpfo', 'bpfi', 'bsf', 'ftf')]
    orders = [order for order in said if isinstance(order, float) and order > 0.0]
    if len(orders) < len(said):
        return None
    model = str(row.get('bearing_model', 'of the data set'))
    return bearing_of_orders(model, FaultFrequencies(*orders))


def read_dataset_signal(path: Path, row: DatasetSignal) -> dict[str, Any]:
    """
    Read one signal of a data set, and what the set says about it.

    Returns
    -------
    ``x`` and what :func:`bearing_twin.recording.foreign.read_signal` makes a signal of.

    """
    name = Path(str(row['signal_file'])).name
    group, index = int(row['signal_row_group']), int(row['signal_row'])
    file = path / 'signals' / name
    column = _read(file, lambda parquet: parquet.read_row_group(group, columns=['signal']))
    try:
        x = column.column(0).combine_chunks()[index].values.to_numpy(zero_copy_only=False)
    except (IndexError, AttributeError) as error:
        msg = f'{file} has no signal {row["signal_id"]} in row {index} of group {group} ({error})'
        raise BearingTwinError(msg) from None
    unit = str(row.get('unit', ''))
    found: dict[str, Any] = {
        'x': x,
        'fs': np.array(row['fs']),
        'unit': np.array('g' if unit == 'g' else unit if unit == 'm/s^2' else ''),
        'bearing_name': np.array(str(row.get('bearing_model', ''))),
        'label': np.array(fault_label(row)),
        'where': f', {row["signal_id"]}',
    }
    if isinstance(row.get('speed_rpm'), (int, float)):
        found['rpm'] = np.array(float(row['speed_rpm']))
    return found | {'bearing': dataset_bearing(row)}


def _read(file: Path, action: Any) -> Any:
    # Loaded when needed: half a second.
    import pyarrow
    from pyarrow import parquet

    try:
        with parquet.ParquetFile(file) as opened:
            return action(opened)
    except (pyarrow.ArrowException, OSError, IndexError) as error:
        msg = f'{file} cannot be read as Parquet ({str(error).splitlines()[0]})'
        raise BearingTwinError(msg) from None
