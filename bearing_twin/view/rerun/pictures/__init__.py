# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""What is drawn of each kind of message, and the bearing itself in three dimensions."""
