# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""ROS 2 nodes: thin adapters around the core."""

from bearing_twin import threads as threads
