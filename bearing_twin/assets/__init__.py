# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""One twin, one diagnosis, as a node or an offline run hosts it. No rclpy."""
