# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Table at the end of the demo, read from the recording of the run."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
import math
from pathlib import Path
import shlex
import shutil
import sys

from bearing_twin.bearing import PLACES
from bearing_twin.cli.terminal import lined_up
from bearing_twin.dynamics.presets import PRESETS
from bearing_twin.errors import BearingTwinError
from bearing_twin.quantity import signed
from bearing_twin.recording.health import sent_before
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.topics import LEVEL_FAULT
from bearing_twin.view.report.data import collect, Machine
from bearing_twin.view.verdict import impacts


@dataclass(frozen=True)
class Summary:
    """Results of a demo run."""

    temperature_low: float
    temperature_high: float
    defect: str
    preset: str
    amplitude_by_temperature: dict[float, float]
    """Impact amplitude, m/s^2, by temperature, degC."""
    amplitude_change: float
    """Relative change from coldest to hottest third; the paper states a decrease."""
    result: str
    verdicts: dict[str, int]
    false_alarms: int
    """Verdicts at level FAULT that name a place where the twin has no defect."""
    confidence: float
    fault_hz: float
    fault_hz_expected: float
    """Frequency expected by the diagnosis, without slip."""
    fault_hz_twin: float
    """Frequency of the twin, with its slip; NaN without a fault."""
    blocks_published: int
    blocks_recorded: int
    blocks_late: int
    blocks_dropped: int
    samples_lost_by_diagnosis: int
    samples_lost_by_recorder: int
    sent_before_recorder: int
    """Messages sent before the recorder listened."""
    lateness_max_ms: float
    files: dict[str, int]
    open_with: str

    @property
    def good(self) -> bool:
        """Whether the fault was named and no sample was lost on the way."""
        wanted = 'healthy' if self.defect == 'none' else self.defect
        lost = self.samples_lost_by_diagnosis + self.samples_lost_by_recorder
        lost += self.sent_before_recorder
        clean = lost == 0 and self.blocks_dropped == 0 and self.false_alarms == 0
        return clean and self.result in wanted.split('+')

    def _amplitude(self) -> str:
        bars = ', '.join(f'{t:g}: {a:.0f}' for t, a in self.amplitude_by_temperature.items())
        text = f'{bars} (degC: m/s^2)'
        if not math.isnan(self.amplitude_change):
            change = signed(100.0 * self.amplitude_change)
            text += f'; {change} % from the coldest to the hottest third'
        return f'{text}; the paper states a decrease'

    def to_text(self) -> str:
        """Return the table."""
        found = self.result
        if math.isfinite(self.fault_hz):
            found += f' at {self.fault_hz:.2f} Hz'
            if math.isfinite(self.fault_hz_twin):
                error = signed(100.0 * (self.fault_hz / self.fault_hz_twin - 1.0), 2)
                found += f', the twin with its slip {self.fault_hz_twin:.2f} Hz ({error} %)'
            found += f', confidence {self.confidence:.2f}'
        verdicts = ', '.join(f'{name} {count}' for name, count in self.verdicts.items())
        missing = self.blocks_dropped + max(0, self.blocks_published - self.blocks_recorded)
        lost = f'{self.samples_lost_by_diagnosis} by the diagnosis, '
        lost += f'{self.samples_lost_by_recorder} by the recorder'
        rows = [
            ('temperature', f'{self.temperature_low:.1f} .. {self.temperature_high:.1f} degC'),
            ('defect of the twin', self.defect),
            ('preset of the twin', f'{self.preset}: {PRESETS[self.preset]}'),
            ('impact amplitude', self._amplitude()),
            ('fault found', found),
            ('verdicts', verdicts),
            (
                'blocks',
                f'{self.blocks_published} published, {self.blocks_late} late, {missing} lost',
            ),
            ('samples lost', lost),
            ('sent too early', f'{self.sent_before_recorder} messages before the recorder heard'),
            ('lateness', f'{self.lateness_max_ms:.1f} ms at most'),
            *(('file', f'{name} ({size / 1e6:.2g} MB)') for name, size in self.files.items()),
        ]
        return '\n'.join(lined_up(rows))


def summarise(folder: Path, defect: str, preset: str) -> Summary:
    """Return the summary of a run; raise if it has no twin state or no verdict."""
    bag = folder / 'bag'
    _, health, machines = collect(bag)
    machine = machines.get('', Machine(''))
    state, verdicts = machine.last_state, [verdict for _, verdict in machine.diagnoses]
    if state is None or not verdicts:
        missing = 'twin state' if state is None else 'verdict'
        raise BearingTwinError(f'the recording in {bag} holds no {missing}; see {folder / "logs"}')
    verdict = verdicts[-1]
    found = verdict.result_name
    wrong = set(PLACES) - set(defect.split('+'))
    amplitudes, change = _over_temperature(machine)
    early: dict[str, int] = {}
    lost_by_diagnosis = 0
    for message in read_messages(bag, topics=['/diagnostics']):
        diagnostics = message.decode()
        early |= sent_before(diagnostics)
        for item in (item for status in diagnostics.status for item in status.values):
            if item.key == 'samples_lost':
                lost_by_diagnosis = int(item.value)
    used = [each.temperature_used for _, each in [*machine.states, (0.0, state)]]
    vibration = health.topics['/vibration']
    return Summary(
        temperature_low=min(used),
        temperature_high=max(used),
        defect=defect,
        preset=preset,
        amplitude_by_temperature=amplitudes,
        amplitude_change=change,
        result=found,
        verdicts=dict(Counter(v.result_name for v in verdicts)),
        false_alarms=sum(v.level == LEVEL_FAULT and v.result_name in wrong for v in verdicts),
        confidence=verdict.confidence,
        fault_hz=verdict.fault_hz,
        fault_hz_expected=verdict.fault_hz_expected,
        fault_hz_twin=impacts(state, found) if found in PLACES else math.nan,
        blocks_published=state.blocks_published,
        blocks_recorded=vibration.blocks,
        blocks_late=state.blocks_late,
        blocks_dropped=state.blocks_dropped,
        samples_lost_by_diagnosis=lost_by_diagnosis,
        samples_lost_by_recorder=vibration.samples_missing,
        sent_before_recorder=sum(early.values()),
        lateness_max_ms=machine.worst_lateness * 1e3,
        files={
            str(path): path.stat().st_size
            for path in sorted(folder.rglob('*'))
            if path.suffix in ('.mcap', '.rrd')
        },
        open_with=f'{_command()} view {shlex.quote(str(folder))}',
    )


def _over_temperature(machine: Machine) -> tuple[dict[float, float], float]:
    """Return the amplitude by temperature, and its change from coldest to hottest third."""
    curve = next((c for c in machine.over_temperature.curves if c.key == 'amplitude'), None)
    if curve is None:
        return {}, math.nan
    temperatures, values = curve.temperatures, curve.values
    third = (temperatures[-1] - temperatures[0]) / 3.0
    cold = values[temperatures <= temperatures[0] + third].mean()
    hot = values[temperatures >= temperatures[-1] - third].mean()
    by_temperature = dict(zip(temperatures.tolist(), values.tolist(), strict=True))
    return by_temperature, float(hot / cold) - 1.0 if third > 0.0 else math.nan


def _command() -> str:
    """Return ``bearing-twin`` as it can be typed here."""
    found = shutil.which('bearing-twin')
    beside = Path(sys.executable).parent / 'bearing-twin'
    if found or not beside.exists():
        return 'bearing-twin'
    here = Path.cwd()
    return shlex.quote(str(beside.relative_to(here) if beside.is_relative_to(here) else beside))
