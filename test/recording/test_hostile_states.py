# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Saved states that are mutated and sealed again: refused, or a state that can be gone on from."""

from __future__ import annotations

from collections import Counter
import contextlib
import math
import random
import struct
import time
import zlib

from bearing_twin.bearing import find_bearing
from bearing_twin.diagnosis import DiagnosisSettings, StreamingDiagnoser
from bearing_twin.dynamics import preset, Simulator
from bearing_twin.errors import BearingTwinError
from fuzzing import at_most, LONGEST, mutate, SECONDS, until
import numpy as np
import pytest

RATE = 128.0
"""So low that the state of a window of one second is short, Hz."""


def push(diagnoser: StreamingDiagnoser, blocks: range) -> None:
    for block in blocks:
        samples = np.sin(np.arange(block * 64, block * 64 + 64) * 0.3)
        for verdict in diagnoser.push(64 * block, samples, RATE, 2.0, unit='m/s^2'):
            assert 0.0 <= verdict.confidence <= 1.0
            assert verdict.reasons


def resealed(body: bytes, head: bytes) -> bytes:
    """Return the state of a simulator with the checksum of its body."""
    return head[:8] + struct.pack('<I', zlib.crc32(body)) + body


def repacked(body: bytes, head: bytes) -> bytes:
    """Return a packed state whose length and checksum are those of its body."""
    length = struct.unpack_from('<I', head, 10)[0]
    return head[:6] + struct.pack('<IIQ', zlib.crc32(body), length, len(body)) + body


def with_other_digits(body: bytes, rng: random.Random) -> bytes:
    """Return the body with up to four digits changed."""
    changed = bytearray(body)
    digits = [at for at, byte in enumerate(body) if byte in b'0123456789']
    for at in rng.choices(digits, k=rng.randint(1, 4)):
        changed[at] = rng.choice(b'0123456789')
    return bytes(changed)


def attack(count: int, seed: int, seconds: float = math.inf) -> None:
    settings = DiagnosisSettings(window=1.0, memory=1.0, update_interval=0.5)
    simulator = Simulator(preset('incipient', defect='outer'))
    simulator.advance(1024, 40.0, 25.4)
    diagnoser = StreamingDiagnoser(find_bearing('6307'), settings)
    push(diagnoser, range(6))
    of_twin, of_diagnosis = simulator.save(), diagnoser.save()
    rng, told = random.Random(seed), Counter()
    for _ in until(time.monotonic() + seconds, count):
        told['tried'] += 1
        with at_most(LONGEST), contextlib.suppress(BearingTwinError):
            body = mutate(of_twin[12:], rng)
            simulator.load(resealed(body, of_twin))
            assert np.all(np.isfinite(simulator.advance(64, 40.0, 25.4).y))
            told['twin'] += 1
        other = StreamingDiagnoser(find_bearing('6307'), settings)
        with at_most(LONGEST), contextlib.suppress(BearingTwinError):
            change = rng.choice((mutate, with_other_digits))
            other.load(repacked(change(of_diagnosis[22:], rng), of_diagnosis[:22]))
            push(other, range(4))
            told['diagnosis'] += 1
    print(f'seed {seed}: {told}')
    # Not all end at the checksum or at the first field.
    assert told['twin'] and told['diagnosis']


@pytest.mark.parametrize('step', [1e-300, -1e-5, 1e-4])
def test_a_step_that_no_simulation_takes_is_refused(step: float) -> None:
    simulator = Simulator(preset('incipient'))
    simulator.advance(1024, 40.0, 25.4)
    state = simulator.save()
    predicted = struct.pack('<d', simulator.state['next_step'][0])
    assert state.count(predicted) == 1
    wrong = state.replace(predicted, struct.pack('<d', step))
    with pytest.raises(BearingTwinError, match='no simulation reaches'):
        simulator.load(resealed(wrong[12:], state))
    assert simulator.save() == state


def test_mutated_states() -> None:
    attack(300, 1)


@pytest.mark.fuzz
def test_ten_thousand_mutated_states() -> None:
    attack(10_000, random.SystemRandom().randrange(2**32), SECONDS)
