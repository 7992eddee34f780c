# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Base of all nodes: lifecycle, executor, parameters, QoS, health, real time, launching."""

from bearing_twin import threads as threads
