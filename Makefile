# `make demo` and `make test` set up everything they need: Python 3.10 or newer with venv and pip is
# enough. No ROS, no root, no compiler, no activated environment.

PYTHON ?= python3
VENV := .venv
WSGEN := $(CURDIR)/$(VENV)/bin/wsgen

.PHONY: help demo quick test check benchmark clean
.DEFAULT_GOAL := help

help:
	@echo "make demo       write, build and validate the tutorial's robot in demo/"
	@echo "make quick      run the tests that take a moment: within a minute"
	@echo "make test       run all tests"
	@echo "make check      run the linters and the type checker"
	@echo "make benchmark  measure against doing it by hand"
	@echo "make clean      remove what these commands made"

# The demo's folder is made anew each time.
demo: $(VENV)/.installed
	@rm -rf demo && mkdir demo
	cd demo && "$(WSGEN)" new gazebo_test
	cd demo && "$(WSGEN)" build
	cd demo && "$(WSGEN)" validate --picture .

# What to run while editing. In one process: collecting alone takes ten seconds in each.
quick: $(VENV)/.installed-for-tests
	$(VENV)/bin/python -m pytest -q -m 'not slow' $(PYTEST_ARGUMENTS)

# One process more than cores: some tests wait for the network, or for limits of time.
test: check
	$(VENV)/bin/python -m pytest -n $$(($$(nproc 2>/dev/null || echo 1) + 1)) --dist worksteal $(PYTEST_ARGUMENTS)

check: $(VENV)/.installed-for-tests
	$(VENV)/bin/ruff check
	$(VENV)/bin/ruff format --check
	$(VENV)/bin/mypy

benchmark: $(VENV)/.installed-for-tests
	$(VENV)/bin/python -m benchmarks

clean:
	rm -rf $(VENV) demo

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10) and "wsgen needs Python 3.10 or newer, $(PYTHON) is %d.%d: make PYTHON=python3.11 ..." % sys.version_info[:2])'
	@echo "wsgen and what it needs are installed into $(VENV): about a minute."
	@$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: $(VENV)/bin/python pyproject.toml
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --editable .
	@touch $@

# Dependency groups need pip 25.1.
$(VENV)/.installed-for-tests: $(VENV)/.installed
	@echo "What the tests need is installed into $(VENV): about two minutes."
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --group test --group lint --group oracle --group extras
	@$(VENV)/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --group robots --group accessibility
	@touch $@
