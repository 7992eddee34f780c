# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""A twin, a diagnosis or a calibration, as nodes and offline runs host it. Imports no rclpy."""
