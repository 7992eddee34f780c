# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""``bearing-twin diagnose``."""

from bearing_twin.cli.diagnose.command import configure, run

__all__ = ['configure', 'run']
