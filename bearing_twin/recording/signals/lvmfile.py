# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Read channels of LabVIEW measurement files (``.lvm``), which are texts."""

from __future__ import annotations

from decimal import Decimal
from itertools import pairwise
import re
from typing import Any, NamedTuple, TYPE_CHECKING

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.signals.csvfile import fields_of, table_text
from bearing_twin.recording.signals.reading import distinct, readable
from bearing_twin.recording.signals.timecolumn import nominal_rate, rate_of_times
import numpy as np

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray


BEGIN = 'LabVIEW Measurement'
END = '***End_of_Header***'
DAY = 86_400.0


class _Part(NamedTuple):
    """What LabVIEW wrote at once, with a header of its own."""

    said: dict[str, list[str]]
    """Fields of the header, one for each channel."""
    names: list[str]
    table: NDArray[np.float64]
    """Samples, shape (channels, samples)."""
    times: NDArray[np.float64]
    """Times of the samples, s, shape (samples,); empty where the file has none."""

    def number(self, key: str) -> float:
        """Return a number of the header for the first channel; NaN if there is none."""
        return float((self.said.get(key) or ['nan'])[0])

    def start(self) -> float:
        """Return the time of day of the first sample, s; NaN if it is not stated."""
        clock = [float(field) for field in (self.said.get('Time') or ['nan'])[0].split(':')]
        return sum(v * 60.0**k for k, v in enumerate(reversed(clock))) + self.number('X0')


def read_lvm(path: Path) -> dict[str, Any]:
    """
    Return the channels of a LabVIEW measurement by name, and in ``each`` the unit of each.

    The sample rate is that of ``Delta_X``, or of the times where ``Delta_X`` has too few digits.
    Of several parts, the longest run that continues by the stated times is taken.

    Raises
    ------
    BearingTwinError
        If the file is no such measurement, a row is incomplete, or nothing in it is over time.

    """
    text = table_text(path)
    if not text.startswith(BEGIN):
        msg = f'{path} begins with {text[:20]!r}, and not with {BEGIN!r}'
        raise BearingTwinError(f'{msg}: give a table of another program the ending .txt')
    with readable(path, '.lvm', 'is it complete?'):
        head, *bodies = re.split(r'^Channels(?=[\t,])', text, flags=re.MULTILINE)
        separator = ',' if re.search('^Separator.Comma', head, re.MULTILINE) else '\t'
        # A comma at the end of a line is gone.
        if separator != ',' and re.search(r'^Decimal_Separator\t(?!\.)', head, re.MULTILINE):
            bodies = [body.replace(',', '.') for body in bodies]
        columns = re.search('^X_Columns.(One|Multi)', head, re.MULTILINE)
        parts = [_part(body, separator, timed=columns is not None) for body in bodies]
        parts = [part for part in parts if part.table.size]
        if not parts:
            raise BearingTwinError(f'{path} holds no samples below headings; write some with both')
        run = max(_runs(parts), key=lambda run: sum(part.table.shape[1] for part in run))
        first = run[0]
        rate = _rate(first)
    over = first.said.get('X_Dimension', [])
    units = first.said.get('Y_Unit_Label', [])
    found, each = {}, {}
    for k, name in enumerate(distinct(first.names)):
        if over[k : k + 1] in ([], ['Time']):
            found[name] = np.concatenate([part.table[k] for part in run])
            each[name] = {'unit': np.array(''.join(units[k : k + 1]))}
    if not found:
        msg = f'{path} is over {", ".join(over) or "nothing"}, and not over time'
        raise BearingTwinError(f'{msg}; write the time record')
    remark = f' (the longest of {len(parts)} parts without a gap)' if len(run) < len(parts) else ''
    return {**found, **rate, 'each': each, 'remark': remark}


def _part(body: str, separator: str, *, timed: bool) -> _Part:
    header, _, rows = body.partition(END)
    said = {
        key: fields
        for key, *fields in (fields_of(line, separator) for line in header.splitlines()[1:])
    }
    heading, *lines = [line for line in rows.splitlines() if line.strip(f'{separator} ')]
    names = fields_of(heading, separator)
    samples = [k for k, name in enumerate(names) if name not in ('X_Value', 'Comment')]
    used = [0, *samples] if timed else samples
    table = np.loadtxt(lines, delimiter=separator, usecols=used, ndmin=2, comments=None).T
    times = table[0] if timed else table[0, :0]
    return _Part(said, [names[k] for k in samples], table[len(used) - len(samples) :], times)


def _runs(parts: list[_Part]) -> list[list[_Part]]:
    """Return the parts in runs without a gap: each begins where the one before it ends."""
    runs = [parts[:1]]
    for before, part in pairwise(parts):
        step = part.number('Delta_X')
        gap = part.start() - before.start() - step * before.table.shape[1]
        if part.names == before.names and abs((gap + DAY / 2.0) % DAY - DAY / 2.0) < step:
            runs[-1].append(part)
        else:
            runs.append([part])
    return runs


def _rate(part: _Part) -> dict[str, Any]:
    """Return the sample rate; LabVIEW may print Delta_X with six decimals: 0.000039 s."""
    step = Decimal((part.said.get('Delta_X') or ['0'])[0])
    decimals = -int(step.as_tuple().exponent)
    if step > 0 and (decimals < 6 or 0.5 * 0.1**decimals < 5e-4 * float(step)):
        return {'fs': np.array(nominal_rate(1.0 / float(step)))}
    told = rate_of_times('time [s]', part.times)
    few = f'its Delta_X {step} has too few digits;' if step > 0 else ''
    return told or {'no_rate': np.array(few)}
