# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Take the pictures of docs/images: over temperature, a recording, two, live, fitted, the report.

Run by ``make screenshots``; needs a Vulkan device, in software or not, and Chromium. An hour of
fits takes most of its ten minutes.
"""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
import sys
import tempfile
import time
from typing import Any

from bearing_twin.assets.calibration.core import CalibrationCore
from bearing_twin.assets.calibration.task import fit_record
from bearing_twin.assets.parameters import calibration as calibration_parameters
from bearing_twin.assets.parameters import diagnosis as diagnosis_parameters
from bearing_twin.assets.parameters import twin as twin_parameters
from bearing_twin.assets.parameters.spec import read_values
from bearing_twin.assets.twin import Twin
from bearing_twin.assets.twin_messages import vibration_block, vibration_message
from bearing_twin.cli.demo.hidden import HIDDEN
from bearing_twin.offline.diagnosis_run import DiagnosisRun
from bearing_twin.offline.output import decode
from bearing_twin.offline.run import run_offline
from bearing_twin.recording.qos import sensor_qos
from bearing_twin.recording.writer import whole_recording
from bearing_twin.ros.processes.domain import own_domain, server_port
from bearing_twin.ros.processes.launching import local_environment, NodeProcesses
from bearing_twin.stamps import NANO, samples_ns
from bearing_twin.streams.pacer import Due
from bearing_twin.view.report.page import report_page
from bearing_twin.view.report.pdf import browse
from bearing_twin.view.rerun.opening import draw_recordings
from bearing_twin.view.rerun.viewer import HeadlessViewer, LOOPBACK
from PIL import Image
from rclpy.serialization import serialize_message
from sensor_msgs.msg import Temperature

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / 'docs' / 'images'
SCHEDULE = ROOT / 'recordings' / 'paper_schedule.mcap'
SIZE = (1366, 768)
"""A laptop's screen, pixels."""
BAR = 37
"""Height of the title bar, which warns of the machine that takes the picture, pixels."""
PANEL = 302
"""Width of the selection panel, pixels."""
LIVE_SECONDS = 30.0
MOMENT, HEALTHY, END = 24.0, 37.0, 39.9
START = 1_800_000_000 * NANO
MINUTES, SOUND, GROWTH = 66, 48, 0.12
"""Of the machine that is fitted: its life, the healthy part, and the growth of its defect, mm."""


def keep(target: Path, box: tuple[int, int, int, int]) -> None:
    """Keep what is in a box of a picture."""
    with Image.open(target) as picture:
        kept = picture.crop(box).convert('RGB')
    kept.save(target, optimize=True)
    print(f'{target.relative_to(ROOT)} {target.stat().st_size / 1e3:.0f} kB')


def take(
    sources: list[str], name: str, *, seconds: float | None = None, width: int = SIZE[0]
) -> list[str]:
    """Take a picture of the window, as wide as ``width``; return the names of its views."""
    target = IMAGES / f'{name}.png'
    with HeadlessViewer(sources, size=SIZE) as viewer:
        viewer.wait(seconds)
        viewer.screenshot(target)
        views = viewer.client.get_state().views
    keep(target, (0, BAR, width, SIZE[1]))
    return sorted({v.name for v in views if not v.name.endswith('_checkpoint')})


def live(folder: Path) -> None:
    """Take the picture of nodes that run, as a viewer that comes late sees them."""
    with (
        own_domain(os.getpid()) as domain,
        NodeProcesses(folder / 'logs', local_environment(domain)) as nodes,
    ):
        port = server_port(domain)
        nodes.start('recorder', {'output': str(folder / 'bag'), 'rerun_port': port})
        nodes.start('diagnosis', {'bearing': '6307'})
        nodes.start('twin', {'bearing': '6307', 'defect': 'outer'})
        nodes.start('replay', {'recording': str(SCHEDULE)})
        time.sleep(LIVE_SECONDS)
        nodes.check()
        take([f'rerun+http://{LOOPBACK}:{port}/proxy'], 'live')


def record_life(target: Path) -> None:
    """Record what nodes say of the demo's machine, 7 s each minute, until a defect has grown."""
    known = {name: HIDDEN[name] for name in ('bearing', 'shaft_hz')}
    windows = {'window': 4.0, 'memory': 4.0, 'update_interval': 1.0}
    diagnosis = DiagnosisRun(read_values(diagnosis_parameters.SPECS, known | windows))
    calibration = CalibrationCore(read_values(calibration_parameters.SPECS, known))
    machine = read_values(twin_parameters.SPECS, HIDDEN | {'defect': 'none'})
    now, rate, length = 0.0, machine['sample_rate'], machine['block_size']
    twin = Twin(machine, clock=lambda: now)
    with whole_recording(target) as writer:

        def put(topic: str, message: Any) -> None:
            writer.write(
                topic, f'{type(message).__module__.split(".")[0]}/msg/{type(message).__name__}',
                serialize_message(message), log_time=at, qos=sensor_qos(),
            )  # fmt: skip

        for minute in range(MINUTES):
            if minute >= SOUND:
                width = 1e-3 * min(0.6 + GROWTH * (minute - SOUND), 2.4)
                machine = machine | {'defect': 'inner', 'defect_width': width}
                twin.apply(machine)
            degrees = 45.0 + 10.0 * math.sin(2.0 * math.pi * minute / 20.0)
            begin = round(60.0 * minute * rate / length)
            for block in range(begin, begin + round(7.0 * rate / length)):
                due = Due(block * length, START + samples_ns(block * length, rate), 0.0)
                at = START + samples_ns((block + 1) * length, rate)
                now = at / NANO
                if block == begin:
                    heat = Temperature(temperature=degrees)
                    twin.take_temperature(heat)
                    put('/temperature', heat)
                made = twin.advance()
                vibration = vibration_message(made, due, machine)
                put('/vibration', vibration)
                for said in diagnosis.push(vibration, temperature=degrees):
                    writer.write(
                        said.topic, said.type_name, said.cdr, log_time=at,
                        qos=sensor_qos(),
                    )  # fmt: skip
                    if said.topic == '/diagnosis':
                        calibration.verdict(decode(said))
                task = calibration.take(
                    vibration_block(made, due, machine, 'y'), temperature=degrees,
                    shaft_hz=machine['shaft_hz'], now=now,
                )  # fmt: skip
                if task is not None:
                    put('/calibration', calibration.conclude(task, fit_record(task), now))


def report(run: Path) -> None:
    """Take the picture of the head of a report, as a browser shows it."""
    target = IMAGES / 'report.png'
    browse(report_page(run), f'--window-size={SIZE[0]},{SIZE[1]}', f'--screenshot={target}')
    keep(target, (0, 0, *SIZE))


def main() -> int:
    """Take them all."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs = [folder / 'runs' / 'healthy', folder / 'runs' / 'inner']
        for run, defect in zip(runs, ('none', 'inner'), strict=True):
            run_offline(SCHEDULE, run, twin={'defect': defect})
        draw_recordings(runs[1:], folder / 'inner.rrd')
        draw_recordings(runs[1:], folder / 'temperature.rrd', page='Temperature')
        draw_recordings(runs, folder / 'both.rrd')
        take([str(folder / 'temperature.rrd')], 'over_temperature', seconds=END)
        views = take([str(folder / 'inner.rrd')], 'recording', seconds=MOMENT)
        take([str(folder / 'both.rrd')], 'comparison', seconds=HEALTHY)
        # Without the selection panel, which shows the path of a temporary file.
        bare = str(next(runs[1].glob('*.mcap')))
        take([bare], 'unmodified_rerun', width=SIZE[0] - PANEL)
        report(runs[1])
        live(folder)
        record_life(folder / 'runs' / 'life')
        draw_recordings([folder / 'runs' / 'life'], folder / 'life.rrd', page='Calibration')
        take([str(folder / 'life.rrd')], 'calibration')
    # By these a test tells whether the pictures are older than the views.
    shown = json.dumps(views, ensure_ascii=False, indent=1)
    (IMAGES / 'views.json').write_text(f'{shown}\n', encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
