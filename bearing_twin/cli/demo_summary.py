# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""The table at the end of the demo, read back from the recording that the run has left."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.nodes.vibration_input import GapCounter
from bearing_twin.recording.reader import read_messages

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ['Summary', 'summarise']


@dataclass(frozen=True)
class Summary:
    """What the run has shown."""

    temperature_low: float
    temperature_high: float
    defect: str
    result: str
    verdicts: dict[str, int]
    confidence: float
    fault_hz: float
    fault_hz_expected: float
    blocks_published: int
    blocks_recorded: int
    blocks_late: int
    blocks_dropped: int
    samples_lost_by_diagnosis: int
    samples_lost_by_recorder: int
    lateness_max_ms: float
    files: dict[str, int]
    open_with: str

    @property
    def good(self) -> bool:
        """Whether the fault was named and no sample was lost on the way."""
        wanted = 'healthy' if self.defect == 'none' else self.defect
        lost = self.samples_lost_by_diagnosis + self.samples_lost_by_recorder
        return self.result == wanted and lost == 0 and self.blocks_dropped == 0

    def to_json(self) -> str:
        """Return one JSON object."""
        return json.dumps({**asdict(self), 'good': self.good})

    def to_text(self) -> str:
        """Return the table."""
        found = self.result
        if self.fault_hz == self.fault_hz:
            error = 100.0 * (self.fault_hz / self.fault_hz_expected - 1.0)
            found += f' at {self.fault_hz:.2f} Hz, expected {self.fault_hz_expected:.2f} Hz'
            found += f' ({error:+.2f} %), confidence {self.confidence:.2f}'
        verdicts = ', '.join(f'{name} {count}' for name, count in self.verdicts.items())
        lost = f'{self.samples_lost_by_diagnosis} by the diagnosis, '
        lost += f'{self.samples_lost_by_recorder} by the recorder'
        rows = [
            ('temperature', f'{self.temperature_low:.1f} .. {self.temperature_high:.1f} degC'),
            ('defect of the twin', self.defect),
            ('fault found', found),
            ('verdicts', verdicts),
            (
                'blocks',
                f'{self.blocks_published} published, {self.blocks_recorded} recorded, '
                f'{self.blocks_late} late, {self.blocks_dropped} dropped',
            ),
            ('samples lost', lost),
            ('lateness', f'{self.lateness_max_ms:.1f} ms at most'),
            *(('file', f'{name} ({size / 1e6:.1f} MB)') for name, size in self.files.items()),
            ('open with', self.open_with),
        ]
        width = max(len(name) for name, _ in rows)
        return '\n'.join(f'{name:<{width}}  {text}' for name, text in rows)


def summarise(folder: Path, defect: str) -> Summary:
    """Read the run back.

    Parameters
    ----------
    folder
        Folder of the run, with the recording in ``bag``.
    defect
        What the twin was given.

    Raises
    ------
    BearingTwinError
        If the recording holds no twin state or no verdict.
    """
    low, high, worst = float('inf'), float('-inf'), 0.0
    state: Any = None
    verdict: Any = None
    verdicts: Counter[str] = Counter()
    recorded = 0
    gaps = GapCounter()
    lost_by_diagnosis = 0
    for message in read_messages(folder / 'bag'):
        if message.topic == '/vibration':
            block = message.decode()
            gaps.count(block.first_sample, block.y.size)
            recorded += 1
        elif message.topic == '/twin_state':
            state = message.decode()
            low = min(low, state.temperature_used)
            high = max(high, state.temperature_used)
            worst = max(worst, state.lateness)
        elif message.topic == '/diagnosis':
            verdict = message.decode()
            verdicts[verdict.result_name] += 1
        elif message.topic == '/diagnostics':
            for status in message.decode().status:
                for item in status.values:
                    if item.key == 'samples lost':
                        lost_by_diagnosis = int(item.value)
    if state is None or verdict is None:
        missing = 'twin state' if state is None else 'verdict'
        msg = f'the recording in {folder / "bag"} holds no {missing}; see {folder / "logs"}'
        raise BearingTwinError(msg)
    files = {
        str(path): path.stat().st_size
        for path in sorted(folder.rglob('*'))
        if path.suffix in ('.mcap', '.rrd')
    }
    return Summary(
        temperature_low=low,
        temperature_high=high,
        defect=defect,
        result=verdict.result_name,
        verdicts=dict(verdicts),
        confidence=verdict.confidence,
        fault_hz=verdict.fault_hz,
        fault_hz_expected=verdict.fault_hz_expected,
        blocks_published=state.blocks_published,
        blocks_recorded=recorded,
        blocks_late=state.blocks_late,
        blocks_dropped=state.blocks_dropped,
        samples_lost_by_diagnosis=lost_by_diagnosis,
        samples_lost_by_recorder=gaps.lost,
        lateness_max_ms=worst * 1e3,
        files=files,
        open_with=f'bearing-twin view {folder}',
    )
