# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What was drawn, read back from a Rerun file, and messages to draw."""

import math
from types import SimpleNamespace

from bearing_twin.recording.mcap.schema import message_schema, store_from_text
import numpy as np
import pyarrow as pa
from rerun.chunk import RrdReader
from rosbags.interfaces import Nodetype

VIBRATION = 'bearing_twin_msgs/msg/Vibration'
SECOND = 1_000_000_000


def columns(rrd, entity, component):
    """Return times in ns and values of a component of an entity, row by row."""
    times, values = [], []
    for chunk in RrdReader(rrd).stream():
        if str(chunk.entity_path) != entity or chunk.is_static:
            continue
        batch = chunk.to_record_batch()
        names = batch.schema.names
        data = next((n for n in names if n.endswith(f':{component}')), None)
        if data is None:
            continue
        line = next(name for name in ('ros_time', 'since_start') if name in names)
        times += batch.column(names.index(line)).cast('int64').to_numpy().tolist()
        values += _rows(batch.column(names.index(data)))
    order = np.argsort(times, kind='stable')
    return np.array(times)[order], [values[k] for k in order]


def _rows(column):
    """Return rows as lists; pyarrow makes one object a row, and a signal has a million."""
    numbers = column.type.value_type == pa.float64()
    if numbers and column.value_lengths().unique().to_pylist() == [1]:
        return column.flatten().to_numpy()[:, None].tolist()
    return column.to_pylist()


def header(time=0, frame_id=''):
    sec, nanosec = divmod(time, SECOND)
    return SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec), frame_id=frame_id)


def stamp(time):
    """Return a message that is stamped."""
    return SimpleNamespace(header=header(time))


def message(name, time=0, **fields):
    """Return a message of this package; what is not given of it is NaN, 0, '' or empty."""
    of_type = f'bearing_twin_msgs/msg/{name}'
    defined = store_from_text(of_type, message_schema(of_type).text).fielddefs[of_type][1]
    made = {field: [] if node == Nodetype.SEQUENCE else _blank(about)
            for field, (node, about) in defined} | {'header': header(time)}  # fmt: skip
    assert fields.keys() <= made.keys()
    return SimpleNamespace(**made | fields)


def _blank(about):
    kind = about[0]
    return '' if kind == 'string' else math.nan if kind.startswith('float') else 0


def view_names(rrd):
    store, names = RrdReader(rrd), {}
    for blueprint in store.blueprints():
        for chunk in store.stream(store=blueprint):
            for name, values in chunk.to_record_batch().to_pydict().items():
                if name.endswith('Blueprint:display_name'):
                    names[str(chunk.entity_path)] = values[0][0]
    return list(names.values())
