# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Temperature-aware digital twin and diagnosis of rolling element bearings for ROS 2."""

__version__ = '0.1.0'
