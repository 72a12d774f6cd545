# `make demo` and `make test` set up everything they need: Python 3.10 or newer with venv and pip is
# enough. No ROS, no root, no compiler, no activated environment.

PYTHON ?= python3
VENV := .venv
WSGEN := $(CURDIR)/$(VENV)/bin/wsgen

# Programs start thousands of times here: none is to compile all its modules again.
unexport PYTHONDONTWRITEBYTECODE
PIP := $(VENV)/bin/python -m pip --disable-pip-version-check --quiet

.PHONY: help demo quick test check lint benchmark clean
.DEFAULT_GOAL := help

help:
	@echo "make demo       write, build and validate the tutorial's robot in demo/"
	@echo "make quick      run the tests that take a moment: less than a minute"
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

# What to run while editing.
quick: $(VENV)/.installed-for-tests
	$(VENV)/bin/python -m pytest -q -m 'not slow' -n auto --dist loadfile $(PYTEST_ARGUMENTS)

# Twice as many processes as cores: a test waits for half of its time, for the network, for limits
# of time and for what it starts. The type checker needs one core for a minute and runs beside them;
# what it says comes at the end.
# A test that fails runs once more, as in ROS 2's own CI (`--retest-until-pass`): hundreds start
# processes that find each other by DDS. Why it failed first stands at the end of the output.
test: lint
	@$(VENV)/bin/mypy >$(VENV)/mypy.txt 2>&1 & mypy=$$!; \
	$(VENV)/bin/python -m pytest -n $$((5 * $$(nproc 2>/dev/null || echo 1) / 2)) \
	  --dist loadfile --no-loadscope-reorder --reruns 1 --rerun-except 'has grown to' $(PYTEST_ARGUMENTS); tests=$$?; \
	wait $$mypy; types=$$?; cat $(VENV)/mypy.txt; exit $$((tests || types))

check: lint
	$(VENV)/bin/mypy

lint: $(VENV)/.installed-for-tests
	$(VENV)/bin/ruff check
	$(VENV)/bin/ruff format --check

benchmark: $(VENV)/.installed-for-tests
	$(VENV)/bin/python -m benchmarks

clean:
	rm -rf $(VENV) demo

$(VENV)/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10) and "wsgen needs Python 3.10 or newer, $(PYTHON) is %d.%d: make PYTHON=python3.11 ..." % sys.version_info[:2])'
	@echo "wsgen and what it needs are installed into $(VENV): about a minute."
	@$(PYTHON) -m venv $(VENV)

# Python compiles what is imported; pip would compile everything, which takes a minute.
$(VENV)/.installed: $(VENV)/bin/python pyproject.toml
	@$(PIP) install --no-compile --editable .
	@touch $@

# Dependency groups need pip 25.1. The robots depend on nothing and come beside the rest. What pytest
# makes of the tests' modules is kept, or each of its processes would make it at once.
$(VENV)/.installed-for-tests: $(VENV)/bin/python pyproject.toml
	@echo "What the tests need is installed into $(VENV): about a minute."
	@$(PIP) install --no-compile --upgrade 'pip>=25.1'
	@$(PIP) install --no-compile --no-deps --group robots --group accessibility & robots=$$!; \
	$(PIP) install --no-compile --editable . --group test --group lint --group oracle --group extras \
	  && wait $$robots
	@$(VENV)/bin/python -m pytest --collect-only -q >/dev/null
	@touch $(VENV)/.installed $@
