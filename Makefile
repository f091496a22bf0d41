# Everything runs in .venv, which the first target that needs it installs.
# PYTHON chooses the interpreter that makes it: make test PYTHON=python3.12

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/ready

export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PIP_NO_INPUT := 1
# The problems are small and the processes several: threads inside BLAS only get in the way.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1

.PHONY: test demo slow thorough fuzz oldest package browser windows masters lint types layers docs all install clean

# a file at a time: what its tests share is made once
test: $(READY)
	$(BIN)/python -m pytest -q -n 2 --dist loadfile

demo: $(READY)
	$(BIN)/python studies/oscillator/demo.py

slow: $(READY)
	$(BIN)/python -m pytest -q -n 2 -m slow

# what a change of the search, of laws or of exports is tried on beside the slow tests, and a release
thorough: $(READY)
	$(BIN)/python -m pytest -q -n 2 -m thorough

# 20 000 inputs made to hurt for every reader; make fuzz COUNT=1000000 takes a night
COUNT ?= 20000
fuzz: $(READY)
	$(BIN)/python studies/reliability/fuzz.py --count $(COUNT)

# with the oldest versions that pyproject.toml allows, in an environment of its own: quick tests of
# all that calls a library, and of whole diagnoses
OLDEST := build/oldest
OF_OLDEST := data export imports laws model numeric optimisation report \
	cli/test_cli.py diagnosis/test_diagnosis.py test_learn.py
# but for those that need the tools of development, or look at the newest versions
NOT_OF_OLDEST := report/test_contract.py::test_the_schemas_are_those_of_the_types \
	laws/test_add_a_law.py::test_the_law_of_the_page_is_written_as_all_code_is
oldest: $(OLDEST)/ready
	$(OLDEST)/bin/python -m pytest -q -n 2 -p no:cacheprovider $(OF_OLDEST:%=tests/%) \
		$(NOT_OF_OLDEST:%=--deselect tests/%)

$(OLDEST)/ready: pyproject.toml constraints-oldest.txt
	@echo "installing the oldest versions into $(OLDEST) (about a minute, once)"
	@$(PYTHON) -m venv $(OLDEST)
	@$(OLDEST)/bin/python -m pip install --quiet --constraint constraints-oldest.txt --editable '.[test]'
	@touch $@

# a source distribution, and the wheel that is built from it
package: $(READY)
	rm -rf build/package
	$(BIN)/python -m build --outdir build/package .
	$(BIN)/python -m pytest -q -m package

# page and workbench in a browser; needs a Chromium on the PATH (Debian's chromium)
browser: $(READY)
	$(BIN)/python -m pytest -q -m browser

# needs mingw and wine
windows: $(READY)
	$(BIN)/python -m pytest -q -m windows

# needs Debian's libtbb12
masters: $(READY)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[masters]'
	$(BIN)/python -m pytest -q -m masters

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(READY)
	$(BIN)/mypy

layers: $(READY)
	$(BIN)/lint-imports --no-logo --no-cache

# the site, without the network: warnings are errors, every link and every public name is looked for
docs: $(READY)
	$(BIN)/python -m pytest -q tests/test_repository.py -k links
	$(BIN)/python -m sphinx -c docs -q -W --keep-going -d build/doctrees . build/site
	$(BIN)/python docs/_site/check_site.py build/site

all: test lint types layers docs slow demo

install: $(READY)

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "symhyb needs Python 3.11 or newer, $(PYTHON) is " + sys.version.split()[0])'
	@echo "installing symhyb and its tools into $(VENV) (about a minute, once)"
	@$(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable '.[dev]'
	@touch $@

clean:
	rm -rf $(VENV) build dist out *.egg-info .pytest_cache .mypy_cache .ruff_cache
	find symhyb tests studies -name __pycache__ -type d -prune -exec rm -rf {} +
