# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Real time without ROS: pacing, timing, sample index, shaft speed, checks of the inputs."""
