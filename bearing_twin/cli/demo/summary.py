# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Table at the end of the demo, read from the recording of the run."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
import math
from pathlib import Path
import shlex
import shutil
import sys
from typing import Any, TYPE_CHECKING

from bearing_twin.bearing import PLACES
from bearing_twin.cli.terminal import lined_up
from bearing_twin.dynamics.presets import PRESETS
from bearing_twin.dynamics.trend import mean_of_largest
from bearing_twin.errors import BearingTwinError
from bearing_twin.paper.figures.style import COLOURS, label, new_figure, save, TEMPERATURE_LABEL
from bearing_twin.recording.health import sent_before
from bearing_twin.recording.reader import read_messages
from bearing_twin.recording.topics import LEVEL_FAULT
from bearing_twin.streams.vibration_input import GapCounter
from bearing_twin.view.verdict import impacts
import numpy as np

if TYPE_CHECKING:
    from bearing_twin.recording.mcap.catalogue import RecordedMessage
    import numpy.typing as npt


STEP = 10.0
"""Width of a temperature class, K: the distance of the paper's nodes."""


class AmplitudeByTemperature:
    """
    Collect one maximum per ball passage, with its temperature.

    Blocks and states may come in any order; only a few numbers of each are kept.
    """

    def __init__(self) -> None:
        self._maxima: dict[int, npt.NDArray[np.float64]] = {}
        self._states: dict[int, tuple[float, float]] = {}
        self._waiting: dict[int, tuple[npt.NDArray[np.float32], float]] = {}

    def add_vibration(self, message: Any) -> None:
        """Take a ``Vibration``."""
        samples = np.asarray(message.y)
        self._waiting[message.first_sample] = samples, message.sample_rate
        self._match(message.first_sample)

    def add_state(self, message: Any) -> None:
        """Take a ``TwinState``."""
        self._states[message.first_sample] = message.temperature_used, message.bpfi
        self._match(message.first_sample)

    def _match(self, first: int) -> None:
        if first not in self._waiting or first not in self._states:
            return
        samples, rate = self._waiting.pop(first)
        bpfi = self._states[first][1]
        period = max(1, min(len(samples), round(rate / bpfi) if bpfi > 0.0 else len(samples)))
        whole = len(samples) // period * period
        self._maxima[first] = np.abs(samples[:whole]).reshape(-1, period).max(axis=1)

    def by_temperature(self) -> dict[float, float]:
        """Return the amplitude, m/s^2, by the closest multiple of `STEP` in degC."""
        bars: dict[float, list[npt.NDArray[np.float64]]] = defaultdict(list)
        for first, maxima in self._maxima.items():
            temperature = self._states[first][0]
            bars[STEP * round(temperature / STEP)].append(maxima)
        return {t: mean_of_largest(np.concatenate(bars[t])) for t in sorted(bars)}

    def change(self) -> float:
        """Return the relative change from coldest to hottest third; NaN if they are too close."""
        points = [(self._states[first][0], maxima) for first, maxima in self._maxima.items()]
        temperatures = np.array([temperature for temperature, _ in points])
        if not points or np.ptp(temperatures) < STEP:
            return math.nan
        low, high = temperatures.min(), temperatures.max()
        third = (high - low) / 3.0
        cold = np.concatenate([m for t, m in points if t <= low + third])
        hot = np.concatenate([m for t, m in points if t >= high - third])
        return mean_of_largest(hot) / mean_of_largest(cold) - 1.0

    def draw(self, path: Path, preset: str) -> None:
        """Write a picture of the amplitude over temperature."""
        bars = self.by_temperature()
        figure = new_figure(f'Impact amplitude over temperature, preset {preset}')
        axes = figure.subplots()
        axes.plot(list(bars), list(bars.values()), 'o-', color=COLOURS[0])
        axes.set_ylim(0.0, 1.2 * max(bars.values(), default=1.0))
        label(
            axes,
            f'{100.0 * self.change():+.1f} % from the coldest to the hottest third; the paper '
            'states a decrease',
            TEMPERATURE_LABEL,
            'acceleration |a| / m s⁻²',
        )
        save(figure, path)


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
            text += (
                f'; {100.0 * self.amplitude_change:+.1f} % from the coldest to the hottest third'
            )
        return f'{text}; the paper states a decrease'

    def to_text(self) -> str:
        """Return the table."""
        found = self.result
        if math.isfinite(self.fault_hz):
            found += f' at {self.fault_hz:.2f} Hz'
            if math.isfinite(self.fault_hz_twin):
                error = 100.0 * (self.fault_hz / self.fault_hz_twin - 1.0)
                found += f', the twin with its slip {self.fault_hz_twin:.2f} Hz ({error:+.2f} %)'
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


class _Collected:
    """What the messages of a run say."""

    def __init__(self, defect: str) -> None:
        self._places = defect.split('+')
        self._takers = {
            '/vibration': self._take_block,
            '/twin_state': self._take_state,
            '/diagnosis': self._take_verdict,
            '/diagnostics': self._take_diagnostics,
        }
        self.low, self.high, self.worst = math.inf, -math.inf, 0.0
        """Lowest and highest temperature, degC, and the largest lateness, s."""
        self.state: Any = None
        """The last TwinState."""
        self.verdict: Any = None
        """The last Diagnosis."""
        self.verdicts: Counter[str] = Counter()
        self.false_alarms = self.recorded = self.lost_by_diagnosis = 0
        self.gaps = GapCounter()
        self.amplitude = AmplitudeByTemperature()
        self.early: dict[str, int] = {}

    def take(self, message: RecordedMessage) -> None:
        """Take one message of the recording."""
        if taker := self._takers.get(message.topic):
            taker(message.decode())

    def _take_block(self, block: Any) -> None:
        self.gaps.count(block.first_sample, block.y.size)
        self.amplitude.add_vibration(block)
        self.recorded += 1

    def _take_state(self, state: Any) -> None:
        self.state = state
        self.amplitude.add_state(state)
        self.low = min(self.low, state.temperature_used)
        self.high = max(self.high, state.temperature_used)
        self.worst = max(self.worst, state.lateness)

    def _take_verdict(self, verdict: Any) -> None:
        self.verdict = verdict
        self.verdicts[verdict.result_name] += 1
        alarm = verdict.level == LEVEL_FAULT and verdict.result_name in PLACES
        self.false_alarms += alarm and verdict.result_name not in self._places

    def _take_diagnostics(self, diagnostics: Any) -> None:
        self.early |= sent_before(diagnostics)
        for status in diagnostics.status:
            for item in status.values:
                if item.key == 'samples_lost':
                    self.lost_by_diagnosis = int(item.value)


def summarise(folder: Path, defect: str, preset: str) -> Summary:
    """Return the summary of a run; raise if it has no twin state or no verdict."""
    seen = _Collected(defect)
    for message in read_messages(folder / 'bag'):
        seen.take(message)
    state, verdict, amplitude = seen.state, seen.verdict, seen.amplitude
    if state is None or verdict is None:
        missing = 'twin state' if state is None else 'verdict'
        msg = f'the recording in {folder / "bag"} holds no {missing}; see {folder / "logs"}'
        raise BearingTwinError(msg)
    found = verdict.result_name
    amplitude.draw(folder / 'amplitude.png', preset)
    files = {
        str(path): path.stat().st_size
        for path in sorted(folder.rglob('*'))
        if path.suffix in ('.mcap', '.rrd', '.png')
    }
    return Summary(
        temperature_low=seen.low,
        temperature_high=seen.high,
        defect=defect,
        preset=preset,
        amplitude_by_temperature=amplitude.by_temperature(),
        amplitude_change=amplitude.change(),
        result=found,
        verdicts=dict(seen.verdicts),
        false_alarms=seen.false_alarms,
        confidence=verdict.confidence,
        fault_hz=verdict.fault_hz,
        fault_hz_expected=verdict.fault_hz_expected,
        fault_hz_twin=impacts(state, found) if found in PLACES else math.nan,
        blocks_published=state.blocks_published,
        blocks_recorded=seen.recorded,
        blocks_late=state.blocks_late,
        blocks_dropped=state.blocks_dropped,
        samples_lost_by_diagnosis=seen.lost_by_diagnosis,
        samples_lost_by_recorder=seen.gaps.lost,
        sent_before_recorder=sum(seen.early.values()),
        lateness_max_ms=seen.worst * 1e3,
        files=files,
        open_with=f'{_command()} view {shlex.quote(str(folder))}',
    )


def _command() -> str:
    """Return ``bearing-twin`` as it can be typed here."""
    found = shutil.which('bearing-twin')
    beside = Path(sys.executable).parent / 'bearing-twin'
    if found or not beside.exists():
        return 'bearing-twin'
    here = Path.cwd()
    return shlex.quote(str(beside.relative_to(here) if beside.is_relative_to(here) else beside))
