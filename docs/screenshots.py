# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Take the pictures of docs/images: over temperature, a recording, two, live, the report.

Run by ``make screenshots``; needs a Vulkan device, in software or not, and Chromium.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
import sys
import tempfile
import time

from bearing_twin.offline.run import run_offline
from bearing_twin.ros.launching import local_environment, NodeProcesses
from bearing_twin.view.report.page import report_page
from bearing_twin.view.report.pdf import browse
from bearing_twin.view.rerun.opening import draw_recordings
from bearing_twin.view.rerun.viewer import free_port, HeadlessViewer, LOOPBACK
from PIL import Image

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
    port = free_port()
    environment = local_environment(1 + os.getpid() % 100)
    with NodeProcesses(folder / 'logs', environment) as nodes:
        nodes.start('recorder', {'output': str(folder / 'bag'), 'rerun_port': port})
        nodes.start('diagnosis', {'bearing': '6307'})
        nodes.start('twin', {'bearing': '6307', 'defect': 'outer'})
        nodes.start('replay', {'recording': str(SCHEDULE)})
        time.sleep(LIVE_SECONDS)
        nodes.check()
        take([f'rerun+http://{LOOPBACK}:{port}/proxy'], 'live')


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
    # By these a test tells whether the pictures are older than the views.
    shown = json.dumps(views, ensure_ascii=False, indent=1)
    (IMAGES / 'views.json').write_text(f'{shown}\n', encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
