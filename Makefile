# make         sets everything up, derives, emits and verifies the kernels, prints the paper's critical loads
# make test    runs the tests
# Other targets: docs, bench, mutants, lint, venv, clean. Choose an interpreter with PYTHON=/path/to/python3.

MAKEFLAGS += --no-builtin-rules
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all
.PHONY: all venv test docs bench mutants lint clean FORCE

# A user's own Python or pip settings must not reach into the environment made here; without bytecode each command of the
# tests would compile SymPy anew, which takes three times as long as it does.
unexport PYTHONPATH PYTHONHOME PYTHONSTARTUP VIRTUAL_ENV PIP_USER PIP_TARGET PIP_PREFIX PIP_REQUIRE_VIRTUALENV
unexport PYTHONDONTWRITEBYTECODE

# Of the tests: on two cores a third fills the time in which one waits for a browser (7 min 4 s, two take 7 min 45 s or more).
JOBS ?= 3
# CASES=--all-cases runs all cases of the laws in tests/sampled.py.
# Threads of BLAS in more processes than there are cores wait for one another: a minute of tests took more than ten.
export OMP_NUM_THREADS ?= 1
BIN := .venv/bin
PIP := $(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check --constraint constraints.txt \
    --no-build-isolation --editable
STAMP := .venv/installed-for

all: venv
	$(BIN)/freebeam generate
	$(BIN)/freebeam generate --check
	$(BIN)/freebeam validate --loads

venv: $(STAMP)

# The stamp holds the folder that the environment was made for: a moved or copied clone makes its own.
ifneq ($(shell cat $(STAMP) 2>/dev/null),$(CURDIR))
$(STAMP): FORCE
endif
$(STAMP): pyproject.toml constraints.txt
	@[ "$$(cat $@ 2>/dev/null)" = "$(CURDIR)" ] && $(BIN)/python -c '' 2>/dev/null || rm -rf .venv
	@rm -f $@
	@[ -x $(BIN)/python ] || { $(find_python) && { "$$python" -m venv .venv || { rm -rf .venv; false; }; }; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt setuptools
	$(PIP) '.[dev]'
	@printf '%s\n' "$(CURDIR)" > $@

# Sets the shell variable `python`: PYTHON where it is given, else the newest interpreter that will do.
define find_python
python=; lacking=; \
for candidate in $(if $(PYTHON),"$(PYTHON)",python3.14 python3.13 python3.12 python3.11 python3); do \
  "$$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || continue; \
  if "$$candidate" -c 'import ensurepip, venv' 2>/dev/null; then python=$$candidate; break; fi; \
  lacking=$${lacking:-$$candidate}; \
done; \
if [ -z "$$python" ]; then \
  if [ -n "$$lacking" ]; then \
    echo "freebeam: $$lacking has no venv module: install it (Debian, Ubuntu: apt install $${lacking##*/}-venv)," \
      "or name another interpreter: make PYTHON=/path/to/python3" >&2; \
  else \
    echo "freebeam: needs Python 3.11 or newer, $(if $(PYTHON),which $(PYTHON) is not,and none was found on the PATH):" \
      "install one, or name it: make PYTHON=/path/to/python3" >&2; \
  fi; false; \
fi
endef

# In the order of tests/conftest.py: xdist's own leaves files of few and long tests for the end, where one process has them.
test: venv
	$(BIN)/python -m pytest -n $(JOBS) --dist loadfile --no-loadscope-reorder $(CASES)

COLUMNS := free-free beck euler-pinned
MADE := docs/made

docs: venv
	$(PIP) '.[docs]'
	$(BIN)/freebeam figures --output $(MADE)/figures --force
	@mkdir -p $(MADE)/lessons
	for column in $(COLUMNS); do \
	  $(BIN)/freebeam lesson --column $$column --format html --output $(MADE)/lessons/$$column.html --force || exit 1; \
	done
	$(BIN)/python docs/pages.py
	$(BIN)/sphinx-build -q -W --keep-going docs build/docs
	@echo "open build/docs/index.html"

bench: venv
	$(PIP) '.[bench]'
	$(BIN)/python benchmarks/table.py

# An hour or two of one core: 300 small changes of the code, of which the tests should see nine in ten.
mutants: venv
	$(PIP) '.[mutants]'
	$(BIN)/python benchmarks/mutants.py 300 1 $(JOBS)

lint: venv
	$(BIN)/ruff check
	$(BIN)/mypy

clean:
	rm -rf .venv .mypy_cache .pytest_cache .ruff_cache .hypothesis .benchmarks build docs/made docs/gallery freebeam.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
