# make setup   everything a fresh Debian machine needs: system packages, .venv, the native module
# make demo    show a real STEP file in the window; without a display, render it to a picture
# make test    setup, then lint, types, formatting and all tests
# make build   rebuild the native module after a change in src/native (incremental)
# make oracle  every model and camera against OpenCascade, ray by ray (long)
# make bench   the benchmarks (long)
# make format  rewrite Python and C++ sources in the project's format

PYTHON3 ?= python3
VENV := .venv
PYTHON := $(VENV)/bin/python
PIP := $(PYTHON) -m pip --disable-pip-version-check --quiet
CXX_SOURCES := $(shell find src/native -name '*.cpp' -o -name '*.h')
DEMO_MODEL := cad_models/flange.step
DEMO_PICTURE := build/demo.png

.PHONY: setup build demo test lint pytest format oracle bench clean
.DELETE_ON_ERROR:

setup: $(VENV)/.native
	@:

build: setup

$(VENV)/.created: .ci/system_packages
	.ci/system_packages $(PYTHON3)
	@$(PYTHON3) -c 'import sys; sys.exit(sys.version_info < (3, 10) and "nofacet needs Python 3.10 or newer")'
	test -x $(PYTHON) || $(PYTHON3) -m venv $(VENV)
	@touch $@

# cadquery and build123d bring two builds of the same OCP module (with and without VTK), and the one
# installed last wins. cadquery needs the one with VTK, so it is written again if it lost.
$(VENV)/.packages: pyproject.toml $(VENV)/.created
	$(PIP) install --upgrade pip scikit-build-core nanobind cmake ninja
	$(PIP) install --no-build-isolation --editable '.[dev]'
	@$(PYTHON) -c 'from OCP.IVtkOCC import IVtkOCC_Shape' >/dev/null 2>&1 || \
	    { echo "writing the OCP module with VTK over the one without"; \
	      $(PIP) install --force-reinstall --no-deps "$$($(PYTHON) -m pip freeze | grep '^cadquery-ocp==')"; }
	@$(PYTHON) -c 'import cadquery, build123d'
	@touch $@

$(VENV)/.native: $(VENV)/.packages CMakeLists.txt $(CXX_SOURCES)
	$(PIP) install --no-build-isolation --no-deps --editable .
	@touch $@

demo: setup
	@mkdir -p $(dir $(DEMO_PICTURE))
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then \
	    $(VENV)/bin/nofacet view $(DEMO_MODEL); \
	else \
	    $(VENV)/bin/nofacet render $(DEMO_MODEL) --output=$(DEMO_PICTURE) --camera-direction=iso --edges && \
	    echo "the picture: $(DEMO_PICTURE)"; \
	fi

test: lint pytest

lint: setup
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/mypy
	$(VENV)/bin/clang-format --dry-run -Werror $(CXX_SOURCES)

pytest: setup
	$(PYTHON) -m pytest

format: setup
	$(VENV)/bin/ruff check --fix .
	$(VENV)/bin/ruff format .
	$(VENV)/bin/clang-format -i $(CXX_SOURCES)

oracle: setup
	$(PYTHON) tests/oracle_all.py

bench: setup
	$(VENV)/bin/nofacet bench --output=benchmarks/results
	$(PYTHON) benchmarks/run.py

clean:
	rm -rf build $(VENV)/.native
