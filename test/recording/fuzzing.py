# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Mutated files in a process of their own, with its memory and time limited and measured."""

from __future__ import annotations

from collections.abc import Callable, Iterator
import contextlib
from functools import cache
import json
import os
from pathlib import Path
import random
import resource
import signal
import subprocess
import sys
import time
import traceback
from typing import Any

from bearing_twin.errors import BearingTwinError
from bearing_twin.recording.health import examine
from bearing_twin.recording.mcap.schema import message_schema
from bearing_twin.recording.reader import read_messages, recording_info
from bearing_twin.recording.recover import recover
from bearing_twin.recording.signals.signalfile import read_signal
from bearing_twin.recording.writer import WriterOptions
import h5py
from mcap.writer import CompressionType, Writer
import numpy as np
from recording_samples import QOS, START, VIBRATION, vibration_cdr, write_blocks
from scipy.io import savemat, wavfile

SECONDS = float(os.environ.get('FUZZ_SECONDS', '90'))
"""Time for each stage of make fuzz, s."""
KINDS = ('mcap', 'npz', 'mat', 'wav', 'csv')
LONGEST = 40.0
"""Longest processor time for one file, in loops of this machine; longer counts as hanging."""
INTERESTING = [0, 1, 2, 3, 4, 8, 16, 127, 128, 255, 256, 1023, 32767, 32768, 65535, 65536]
INTERESTING += [2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**53, 2**63 - 1, 2**63, 2**64 - 1]


class TooLong(BaseException):
    """What takes too long; not caught on the way as an error of the input is."""


@cache
def _loop() -> float:
    """Return the processor time of a loop of ten million turns, s."""
    began = time.process_time()
    for _ in range(10_000_000):
        pass
    return time.process_time() - began


@contextlib.contextmanager
def at_most(loops: float) -> Iterator[None]:
    """
    Raise TooLong after the processor time of so many loops of ten million turns.

    It hangs neither on how fast the machine is nor on what else runs there.
    """
    seconds = loops * _loop()
    signal.signal(signal.SIGPROF, _too_long)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def _too_long(*_: Any) -> None:
    raise TooLong


def until(end: float, count: int) -> Iterator[int]:
    """Count to ``count``, or as far as the time goes, s of the monotonic clock."""
    for number in range(count):
        if time.monotonic() > end:
            return
        yield number


def seeds(kind: str, folder: Path) -> list[bytes]:
    """Sound files of one kind."""
    x = np.sin(np.arange(600) * 0.1)
    found = []
    if kind == 'mcap':
        for compression in ('zstd', 'lz4', 'none'):
            path = folder / f'{compression}.mcap'
            write_blocks(path, 6, WriterOptions(compression=compression), flush_each=2)
            found.append(path.read_bytes())
        found += [_open_mcap(folder, chunked) for chunked in (True, False)]
    elif kind == 'npz':
        for save in (np.savez, np.savez_compressed):
            save(folder / 'a.npz', x=x, fs=1000.0, rpm=1500.0, label='inner', unit='g')
            found.append((folder / 'a.npz').read_bytes())
    elif kind == 'mat':
        values = {'X097_DE_time': x[:, None], 'bearing': {'sr': 1e3, 'gs': x}, 'X097RPM': 1797.0}
        for options in ({}, {'do_compression': True}, {'format': '4'}):
            flat = {k: v for k, v in values.items() if not isinstance(v, dict)}
            savemat(folder / 'a.mat', flat if options.get('format') else values, **options)
            found.append((folder / 'a.mat').read_bytes())
        with h5py.File(folder / 'a.mat', 'w', userblock_size=512) as file:
            file.create_dataset('bearing/gs', data=x[None, :], compression='gzip')
            file['bearing/sr'] = [[1e3]]
        found.append((folder / 'a.mat').read_bytes())
    elif kind == 'wav':
        for samples in ((x * 30000).astype(np.int16), x.astype(np.float32)):
            wavfile.write(folder / 'a.wav', 8000, samples.reshape(-1, 2))
            found.append((folder / 'a.wav').read_bytes())
    else:
        rows = '\n'.join(f'{k / 1000},{v:.6g},{-v:.6g}' for k, v in enumerate(x[:200]))
        found.append(f'rpm = 1500\ntime,a [g],b\n{rows}\n'.encode())
        found.append(rows.replace(',', ';').replace('.', ',').encode())
        dated = [
            f'4.3.2026 12:00:00,{k:03d};{v:.6f}'.replace('.0', ',0') for k, v in enumerate(x[:200])
        ]
        found.append('\n'.join(['Zeit;a', '[s];[m/s\xb2]', *dated]).encode('cp1252'))
    return found


def _open_mcap(folder: Path, chunked: bool) -> bytes:
    """Return a file without CRC or compression, in which every mutation reaches the parsers."""
    path = folder / f'open{chunked}.mcap'
    with path.open('wb') as file:
        writer = Writer(
            file, compression=CompressionType.NONE, enable_crcs=False, use_chunking=chunked
        )
        writer.start(profile='ros2')
        schema = writer.register_schema(
            VIBRATION, 'ros2msg', message_schema(VIBRATION).text.encode()
        )
        channel = writer.register_channel(
            '/vibration', 'cdr', schema, {'offered_qos_profiles': QOS}
        )
        for index in range(3):
            cdr = vibration_cdr(index, length=16)
            writer.add_message(channel, START + index, cdr, START + index)
        writer.add_metadata('m', {'a': 'b'})
        writer.add_attachment(1, 1, 'name', 'text/plain', b'data')
        writer.finish()
    return path.read_bytes()


def mutate(content: bytes, rng: random.Random) -> bytes:
    """Damage a file in one to eight places."""
    data = bytearray(content)
    for _ in range(rng.choice([1, 1, 1, 2, 4, 8])):
        if not data:
            break
        at = rng.randrange(len(data))
        action = rng.randrange(8)
        if action == 0:
            data[at] ^= 1 << rng.randrange(8)
        elif action == 1:
            data[at] = rng.randrange(256)
        elif action in (2, 3):
            size = rng.choice([1, 2, 4, 8])
            value = rng.choice(INTERESTING) % 2 ** (8 * size)
            order = rng.choice(['little', 'big'])
            data[at : at + size] = value.to_bytes(size, order)  # type: ignore[arg-type]
        elif action == 4:
            del data[at:]
        elif action == 5:
            del data[at : at + rng.choice([1, 4, 9, 64, 1000])]
        elif action == 6:
            piece = data[at : at + rng.choice([1, 8, 64, 512])]
            other = rng.randrange(len(data))
            data[other:other] = piece * rng.choice([1, 2, 100])
        else:
            data[at:at] = rng.randbytes(rng.choice([1, 4, 100]))
    return bytes(data)


def exercise(path: Path, folder: Path) -> None:
    """Do with a file what our commands do; each may refuse it with BearingTwinError."""
    attempts: list[Callable[[], Any]] = [
        lambda: read_signal(path),
        lambda: read_signal(path, channel='1', sample_rate=1000.0),
    ]
    if path.suffix == '.mcap':
        attempts = [
            lambda: read_signal(path),
            lambda: recording_info(path),
            lambda: examine(path)[1],
            lambda: [message.decode() for message in read_messages(path)],
            lambda: recover(path, folder / 'out' / 'saved'),
        ]
    for attempt in attempts:
        with contextlib.suppress(BearingTwinError):
            attempt()


def run_worker(kind: str, count: int, seed: int, folder: Path, seconds: float) -> dict[str, Any]:
    """Mutate and exercise files for a time; runs in the worker process."""
    rng = random.Random(seed)
    sound = seeds(kind, folder)
    for content in sound:
        # Load and warm everything up before memory is measured.
        (folder / f'a.{kind}').write_bytes(content)
        (folder / 'out').mkdir(exist_ok=True)
        exercise(folder / f'a.{kind}', folder)
        clean(folder / 'out')
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    found: list[str] = []
    longest = 0.0
    for index in until(time.monotonic() + seconds, count):
        content = mutate(rng.choice(sound), rng)
        path = folder / f'a.{kind}'
        path.write_bytes(content)
        began = time.process_time()
        try:
            with at_most(LONGEST):
                exercise(path, folder)
        except BaseException:
            (folder / f'failed_{index}.{kind}').write_bytes(content)
            found.append(traceback.format_exc(limit=-6))
        longest = max(longest, time.process_time() - began)
        clean(folder / 'out')
        if len(found) >= 5:
            break
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return {
        'count': index + 1,
        'failures': found,
        'longest': longest,
        'memory': (after - before) * 1024,
        'files': sorted(p.name for p in folder.iterdir()),
    }


def fuzz(kind: str, count: int, seed: int, folder: Path, seconds: float) -> dict[str, Any]:
    """Run a worker."""
    return run_script(__file__, kind, count, seed, folder, seconds)


def run_script(script: str, *words: object) -> dict[str, Any]:
    """Run a script that prints what it found as JSON; a crash of it is a failure too."""
    answer = subprocess.run(
        [sys.executable, script, *map(str, words)],
        capture_output=True,
        text=True,
        cwd=Path(__file__).parents[2],
        env={**os.environ, 'PYTHONPATH': str(Path(__file__).parents[2])},
        check=False,
    )
    if answer.returncode:
        return {'failures': [f'status {answer.returncode}: {answer.stderr[-2000:]}']}
    return json.loads(answer.stdout.splitlines()[-1])


def clean(folder: Path) -> None:
    """Empty a folder."""
    for path in sorted(folder.rglob('*'), reverse=True):
        if path.is_dir():
            path.rmdir()
        else:
            path.unlink()


if __name__ == '__main__':
    _, kind_, count_, seed_, folder_, seconds_ = sys.argv
    # A reader that believes what a file claims runs into this.
    resource.setrlimit(resource.RLIMIT_AS, (6 * 2**30, 6 * 2**30))
    found_ = run_worker(kind_, int(count_), int(seed_), Path(folder_), float(seconds_))
    print(json.dumps(found_))
