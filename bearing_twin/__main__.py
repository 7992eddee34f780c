# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Run ``bearing-twin`` as ``python -m bearing_twin``."""

import sys

from bearing_twin.start import command

sys.exit(command())
