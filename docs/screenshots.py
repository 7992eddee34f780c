# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Take the pictures of docs/images: live, a recording, a comparison, the bearing.

Run by ``make screenshots``; needs a Vulkan device, in software or not.
"""

from __future__ import annotations

import os
from pathlib import Path
import sys
import tempfile
import time

from bearing_twin.offline.run import run_offline
from bearing_twin.ros.launching import local_environment, NodeProcesses
from bearing_twin.view.rerun.opening import draw_recordings
from bearing_twin.view.rerun.viewer import free_port, HeadlessViewer, LOOPBACK
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / 'docs' / 'images'
SCHEDULE = ROOT / 'recordings' / 'paper_schedule.mcap'
SIZE = (1600, 1000)
LIVE_SECONDS = 30.0
MOMENT = 24.0


def take(
    sources: list[str],
    name: str,
    *,
    seconds: float | None = None,
    view: str = '',
    width: int = SIZE[0],
) -> None:
    """Take one picture of the window's left part, or of the view whose name begins so."""
    target = IMAGES / f'{name}.png'
    with HeadlessViewer(sources, size=SIZE) as viewer:
        viewer.wait(seconds)
        views = [v for v in viewer.client.get_state().views if view and v.name.startswith(view)]
        viewer.client.save_screenshot(str(target), *(v.view_id for v in views[:1]))
    with Image.open(target) as picture:
        kept = picture.crop((0, 0, min(width, picture.width), picture.height))
        kept.convert('RGB').save(target, optimize=True)
    print(f'{target.relative_to(ROOT)} {target.stat().st_size / 1e3:.0f} kB')


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


def main() -> int:
    """Take them all."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs = [folder / 'healthy', folder / 'inner']
        for run, defect in zip(runs, ('none', 'inner'), strict=True):
            run_offline(SCHEDULE, run, twin={'defect': defect})
        draw_recordings(runs[1:], folder / 'inner.rrd')
        draw_recordings(runs, folder / 'both.rrd')
        take([str(folder / 'inner.rrd')], 'recording', seconds=MOMENT)
        take([str(folder / 'inner.rrd')], 'bearing', seconds=MOMENT, view='Bearing')
        take([str(folder / 'both.rrd')], 'comparison', seconds=MOMENT)
        # Without the selection panel, which shows the path of a temporary file.
        take([str(next(runs[1].glob('*.mcap')))], 'unmodified_rerun', width=1298)
        live(folder)
    return 0


if __name__ == '__main__':
    sys.exit(main())
