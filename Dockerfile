# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
#
#   docker build -t bearing_twin .
#   docker run --rm -v "$PWD/runs:/data" bearing_twin
#   docker run --rm --network host --ipc host -v "$PWD/runs:/data" bearing_twin run recorder
#
# What the README does on Ubuntu without ROS, in a venv of its own. The kernel is compiled at the
# first start, for the processor that it runs on, and kept in /data.
FROM ubuntu:24.04 AS build

# The distribution decides on the versions.
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --no-install-recommends -y python3-venv python3-dev build-essential \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /src
COPY . .
RUN python3 -m venv /opt/bearing_twin \
    && /opt/bearing_twin/bin/pip install --no-cache-dir ./msg_defs .

FROM ubuntu:24.04

# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --no-install-recommends -y python3 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --create-home --uid 1100 bearing \
    && install -d -o bearing /data

COPY --from=build /opt/bearing_twin /opt/bearing_twin

ENV PATH=/opt/bearing_twin/bin:$PATH \
    AMENT_PREFIX_PATH=/opt/bearing_twin \
    NUMBA_CACHE_DIR=/data/.numba
USER 1100
WORKDIR /data
VOLUME /data
ENTRYPOINT ["bearing-twin"]
CMD ["demo", "--out", "/data"]
