# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Twin and diagnosis driven from a recording."""

from bearing_twin import threads as threads
