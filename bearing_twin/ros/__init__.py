# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What every node needs: lifecycle, executor, parameters, QoS, health, real time, launching."""

from bearing_twin import threads as threads
