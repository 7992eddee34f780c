# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Second part of the demo: a machine with a hidden defect is fitted and then followed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bearing_twin.cli.terminal import lined_up
from bearing_twin.ros.processes.launching import NodeProcesses

WIDTH_MM = 2.0
HIDDEN = {
    'bearing': '6205', 'preset': 'incipient', 'shaft_hz': 15.0, 'start_temperature': 40.0,
    'load': 150.0, 'defect': 'inner', 'defect_width': 1e-3 * WIDTH_MM, 'seed': 5,
    'resonance_hz': 3000.0, 'resonance_damping': 0.01,
}  # fmt: skip
"""Parameters of the machine: a twin with another load and sensor than the one that follows."""
KNOWN = ('bearing', 'shaft_hz', 'start_temperature')
"""Parameters of the machine that the other nodes are given."""
TIMEOUT = 300.0


@dataclass(frozen=True)
class Found:
    """Results on the hidden machine."""

    place: str
    """Place of the defect by the diagnosis."""
    confidence: float
    statement: str
    """Statement of the calibration."""
    width_q05: float
    """5 % quantile of the width by the calibration, mm."""
    width_median: float
    width_q95: float
    width_hidden: float
    followed: str
    """Status of the twin that has taken the calibration."""

    def to_text(self) -> str:
        """Return the results as a few lines."""
        rows = (
            ('machine', f'{HIDDEN["bearing"]} with a defect that no other node is told'),
            ('diagnosis', f'{self.place}, confidence {self.confidence:.2f}'),
            ('calibrated', f'{self.statement}; the hidden one is {self.width_hidden:g} mm'),
            ('twin', f'follows: {self.followed}'),
        )
        return '\n'.join(lined_up(rows))


def find_hidden(logs: Path, environment: Mapping[str, str], say: Callable[[str], object]) -> Found:
    """Run a hidden machine, its diagnosis and calibration, and a twin that follows it."""
    from bearing_twin.cli.demo.watch import Watcher
    from bearing_twin_msgs.msg import Calibration, Diagnosis
    from diagnostic_msgs.msg import DiagnosticArray

    known = {name: HIDDEN[name] for name in KNOWN}
    speed = {name: HIDDEN[name] for name in ('bearing', 'shaft_hz')}
    newest: dict[str, Any] = {}

    def on_calibration(message: Calibration) -> None:
        if message.defect == HIDDEN['defect']:
            newest['calibration'] = message

    def on_verdict(message: Diagnosis) -> None:
        if message.level == Diagnosis.LEVEL_FAULT:
            newest['verdict'] = message

    def on_health(message: DiagnosticArray) -> None:
        for status in message.status:
            values = {item.key: item.value for item in status.values}
            name = status.name.partition(':')[0]
            if name.endswith('twin') and 'level_over_machine_db' in values:
                newest['followed'] = status.message.partition(';')[0]

    with NodeProcesses(logs, environment) as nodes, Watcher() as watcher:
        watcher.listen(Calibration, '/machine/calibration', on_calibration)
        watcher.listen(Diagnosis, '/machine/diagnosis', on_verdict)
        watcher.listen(DiagnosticArray, '/diagnostics', on_health)
        there = ('-r', '__ns:=/machine')
        window = {'window': 4.0, 'memory': 4.0, 'update_interval': 1.0}
        nodes.start('diagnosis', speed | window, name='machine_diagnosis', ros=there)
        nodes.start('calibration', speed | {'period': 5.0}, name='calibration', ros=there)
        follower = known | {'preset': HIDDEN['preset'], 'follow_calibration': True}
        away = ('-r', '__ns:=/follower', '-r', 'calibration:=/machine/calibration')
        nodes.start('twin', follower, name='follower', ros=away)
        watcher.wait_for_listeners(2, nodes.check, TIMEOUT, '/machine/vibration')
        say('           a machine with a hidden defect runs; it is diagnosed and fitted')
        nodes.start('twin', HIDDEN, name='machine', ros=there)
        watcher.wait(
            lambda: newest.keys() >= {'calibration', 'verdict', 'followed'},
            nodes.check,
            TIMEOUT,
            'the hidden machine was not fitted and followed',
        )
    said, verdict = newest['calibration'], newest['verdict']
    return Found(
        place=verdict.result_name,
        confidence=verdict.confidence,
        statement=said.statement,
        width_q05=said.width_q05,
        width_median=said.width_median,
        width_q95=said.width_q95,
        width_hidden=WIDTH_MM,
        followed=newest['followed'],
    )
