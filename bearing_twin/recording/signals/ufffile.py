# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read time records of the Universal File Format (data set 58), by pyuff (extra ``files``)."""

from __future__ import annotations

import math
import os
from pathlib import Path
import re
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.reading import (
    clock_time,
    distinct,
    head_of,
    library,
    readable,
    TORN,
)
from bearing_twin.recording.signals.timecolumn import rate_of_times, SECONDS
import numpy as np

FUNCTIONS = (
    'general function', 'time response', 'auto spectrum', 'cross spectrum', 'frequency response',
    'transmissibility', 'coherence', 'auto correlation', 'cross correlation',
    'power spectral density', 'energy spectral density', 'probability density', 'spectrum',
)  # fmt: skip
"""Function types of data set 58, from 0."""
ACCELERATION, TIME = 12, 17
"""Codes of data types."""
HEADER = re.compile(r'^ +-1 *\r?\n +58b?\b.*\n.*\n.*\n(.*)', re.MULTILINE)
"""Begin of a data set 58 up to its third text, date and time."""
AXES = {1: '+X', -1: '-X', 2: '+Y', -2: '-Y', 3: '+Z', -3: '-Z'}


def read_uff(path: Path) -> dict[str, Any]:
    """
    Return the time records of a universal file by name, and in ``each`` the description of each.

    A name is the first line of the description, node and direction: ``Motor DE 1+Z``. The unit is
    that of the ordinate, or that of data set 164 for accelerations.

    Raises
    ------
    BearingTwinError
        If pyuff is missing, the file is damaged, or has no data set 58 that is a time record.

    """
    pyuff = library('pyuff', path)
    with readable(path, f'{path.suffix.lower()} data set 58', 'is it complete?'):
        file = pyuff.UFF(str(path))
        wanted = [n for n, kind in enumerate(file.get_set_types()) if kind in (58, 164)]
        sets = [file.read_sets(n) for n in wanted]
        with path.open('rb') as opened:
            opened.seek(-min(path.stat().st_size, 200), os.SEEK_END)
            # pyuff passes over a set without its end.
            torn = not opened.read().rstrip().endswith(b'-1')
    length = 0.0
    records, names, left = [], [], []
    for data in sets:
        if data['type'] == 164:
            length = data['length']
            continue
        label = '' if data['id1'].startswith('NONE') else data['id1']
        node = f' {data["rsp_node"]}{AXES.get(data["rsp_dir"], "")}' if data['rsp_node'] else ''
        name = f'{label}{node}'.strip() or 'x'
        kind = data['func_type']
        if kind == 1 or (kind == 0 and data['abscissa_spec_data_type'] == TIME):
            names.append(name)
            records.append((data, length))
        else:
            left.append(
                f'{name}: {dict(enumerate(FUNCTIONS)).get(kind, "function")} (type {kind})'
            )
    if not records:
        listed = f' ({", ".join(left[:10])})' if left else ''
        raise BearingTwinError(
            f'{path}{TORN if torn else ""} has no time record among its {len(left)} data sets '
            f'58{listed}; export the time history (type 1)'
        )
    found: dict[str, Any] = {}
    each: dict[str, dict[str, Any]] = {}
    for name, (data, scale) in zip(distinct(names), records, strict=True):
        count = data['num_pts']
        found[name] = data['data'][:count]
        torn |= len(data['data']) < count
        each[name] = _rate(data)
        unit = data.get('ordinate_axis_units_lab', '').strip('()[] ').replace('NONE', '')
        if not unit and scale > 0.0 and data['ordinate_spec_data_type'] == ACCELERATION:
            found[name], unit = found[name] / scale, 'm/s^2'
        each[name]['unit'] = np.array(unit)
    return {**found, 'each': each, 'remark': TORN if torn else ''}


def uff_start(path: Path) -> float | None:
    """Return date and time of the first data set 58, s since 1970; None if none is stated."""
    found = HEADER.search(head_of(path))
    return clock_time(found[1].strip(), '%d-%b-%y %H:%M:%S') if found else None


def _rate(data: dict[str, Any]) -> dict[str, Any]:
    """Return the sample rate of a data set."""
    unit = data.get('abscissa_axis_units_lab', '').lower()
    unit = unit if unit in SECONDS else ''
    if data['abscissa_spacing'] == 0:
        return rate_of_times(f'time [{unit}]', data['x'])
    step = data['abscissa_inc']
    if not step > 0.0:
        return {}
    # The increment is printed with six digits.
    whole = max(round(1.0 / step), 1)
    digit = 10.0 ** (math.floor(math.log10(step)) - 5)
    rate = whole if abs(1.0 / whole - step) < 0.501 * digit else 1.0 / step
    return {'fs': np.array(rate / SECONDS[unit])}
