# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin benchmark``."""

from bearing_twin.cli.benchmark.command import configure, run

__all__ = ['configure', 'run']
