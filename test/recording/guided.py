# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""
Input from outside, mutated under the guidance of coverage (Atheris, libFuzzer).

The readers are instrumented; what reaches new code is kept and mutated further. Files go through
what our commands do with them, messages through what the nodes do with them between their
subscription and their publishers, saved states through those who load them, checksums put right.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path
import re
import subprocess
import sys
import tempfile
from typing import Any, NamedTuple, TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[2]
KINDS = ('mcap', 'npz', 'mat', 'wav', 'csv', 'message', 'state')
INSTRUMENTED = [
    'bearing_twin.diagnosis.signal.gate', 'bearing_twin.packed',
    'bearing_twin.diagnosis.streaming', 'bearing_twin.streams.shaft',
    'bearing_twin.streams.vibration_input', 'bearing_twin.recording', 'bearing_twin.thermal.gate',
    'mcap', 'rosbags', 'scipy.io.wavfile', 'zipfile',
]  # fmt: skip
LONGEST = 10
"""Longest time for one input, s."""
MOST_MEMORY = 1024
"""Most memory of the process, MiB; libraries take some 250."""
LONGEST_INPUT = 20_000


class Guided(NamedTuple):
    """What a run has shown."""

    runs: int
    edges_at_start: int
    """Edges of the instrumented code that the seeds reach."""
    edges: int
    corpus: int
    """Inputs that reach something of their own."""
    peak: int
    """Largest memory of the process, MiB."""


def guided(kind: str, seconds: int, corpus: Path) -> Guided:
    """
    Fuzz one kind for a time, in a process of its own; ``corpus`` is read and added to.

    Raises
    ------
    AssertionError
        If an input is answered with anything but a clear error; it is then in ``corpus``.

    """
    corpus.mkdir(parents=True, exist_ok=True)
    options = [
        f'-max_total_time={seconds}', f'-timeout={LONGEST}', f'-rss_limit_mb={MOST_MEMORY}',
        f'-max_len={LONGEST_INPUT}', f'-artifact_prefix={corpus}/', '-print_final_stats=1',
    ]  # fmt: skip
    words = [sys.executable, __file__, kind, str(corpus / 'inputs'), *options]
    ran = subprocess.run(
        words,
        capture_output=True,
        text=True,
        errors='replace',
        cwd=ROOT,
        env={**os.environ, 'PYTHONPATH': f'{ROOT}{os.pathsep}{os.environ.get("PYTHONPATH", "")}'},
        check=False,
    )
    assert ran.returncode == 0, f'{" ".join(words)}\n{ran.stdout[-3000:]}{ran.stderr[-3000:]}'
    steps = re.findall(r'#(\d+)\s+\w+\s+cov: (\d+) ft: \d+ corp: (\d+)', ran.stderr)
    peak = re.search(r'peak_rss_mb:\s+(\d+)', ran.stderr)
    assert steps and peak, ran.stderr[-3000:]
    first = re.search(r'INITED\s+cov: (\d+)', ran.stderr)
    return Guided(
        int(steps[-1][0]), int(first[1]) if first else 0, int(steps[-1][1]), int(steps[-1][2]),
        int(peak[1]),
    )  # fmt: skip


def _file_target(kind: str, folder: Path, fuzzing: Any) -> Callable[[bytes], None]:
    path, out = folder / f'a.{kind}', folder / 'out'

    def target(data: bytes) -> None:
        path.write_bytes(data)
        out.mkdir(exist_ok=True)
        fuzzing.exercise(path, folder)
        fuzzing.clean(out)
        extra = {p.name for p in folder.iterdir()} - {path.name, 'out'}
        assert not extra, f'{extra} were written outside the chosen folder'

    return target


def prepare(kind: str, folder: Path, inputs: Path) -> Callable[[bytes], None]:
    """Return what is done with an input, and write the seeds; imports what is instrumented."""
    import fuzzing

    if kind in fuzzing.KINDS:
        seeds = [seed for seed in fuzzing.seeds(kind, folder) if len(seed) <= LONGEST_INPUT]
        fuzzing.clean(folder)
        target = _file_target(kind, folder, fuzzing)
    else:
        import guided_messages

        seeds, target = getattr(guided_messages, kind)()
    inputs.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(seeds):
        (inputs / f'seed{number}').write_bytes(seed)
        target(seed)
    return target


def main() -> None:
    """Fuzz; the arguments after the folder of inputs are those of libFuzzer."""
    parser = argparse.ArgumentParser(description='Coverage-guided fuzzing of one kind of input.')
    parser.add_argument('kind', choices=KINDS)
    parser.add_argument('inputs', type=Path)
    args, options = parser.parse_known_args()
    if args.kind in ('message', 'state'):
        # Before anything is instrumented: numba compiles what it finds.
        from bearing_twin.dynamics import preset, Simulator

        Simulator(preset('incipient', defect='outer')).advance(64, 40.0, 25.4)
    import atheris

    with tempfile.TemporaryDirectory() as folder:
        with atheris.instrument_imports(include=INSTRUMENTED):
            target = prepare(args.kind, Path(folder), args.inputs)
        atheris.Setup([sys.argv[0], str(args.inputs), *options], target)
        atheris.Fuzz()


if __name__ == '__main__':
    main()
