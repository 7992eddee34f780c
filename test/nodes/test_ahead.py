# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Work ahead in a thread: order, errors in their place, and an early end."""

import threading
import time

from bearing_twin.streams.ahead import ahead
import pytest


@pytest.mark.parametrize('count', [0, 1, 6, 7, 20])
def test_everything_comes_in_order(count):
    assert list(ahead(iter(range(count)), depth=12, batch=3)) == list(range(count))


def test_an_error_comes_after_what_was_before_it():
    def items():
        yield from range(5)
        raise KeyError('broken')

    results = ahead(items(), depth=4, batch=2)
    assert [next(results) for _ in range(5)] == [0, 1, 2, 3, 4]
    with pytest.raises(KeyError, match='broken'):
        next(results)


def test_it_is_no_further_ahead_than_told_and_ends_when_it_is_left():
    made = []

    def items():
        for item in range(1000):
            made.append(item)
            yield item

    results = ahead(items(), depth=10, batch=5)
    assert next(results) == 0
    time.sleep(0.3)
    # Those in hand, in the queue, and in the making.
    assert len(made) <= 5 + 10 + 5
    results.close()
    assert all(thread.name != 'ahead' for thread in threading.enumerate())
