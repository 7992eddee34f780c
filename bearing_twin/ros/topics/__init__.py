# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
"""Topics of the nodes: quality of service, validation of messages, topics of any type."""
