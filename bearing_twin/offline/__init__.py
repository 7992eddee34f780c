# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Run twin and diagnosis offline from a recording or a vibration file, and re-run them."""

from bearing_twin import threads as threads
