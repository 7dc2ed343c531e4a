# `make` or `make help` lists the targets.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# The installer's options, for example PIP_OPTIONS="--index-url <CPU build of torch>" (README, "Two commands").
PIP_OPTIONS ?=
OMP_NUM_THREADS ?= 1
export OMP_NUM_THREADS
# On every core, each test on whichever is free.
PYTEST := $(BIN)/python -m pytest -n auto --dist worksteal
ARGS ?=

.DEFAULT_GOAL := help
.PHONY: help setup run test test-sweeps test-slurm test-pages check bench estimators limit window coverage alarm plan-check blind second-rig real power p-values fuzz docs clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## /{printf "  make %-11s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

# The environment is remade whenever what it should hold has changed.
$(VENV)/.installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check $(PIP_OPTIONS) -c constraints.txt -e ".[dev,joblib,slurm,formats]"
	@touch $@

setup: $(VENV)/.installed  ## create .venv with everything that development needs

run: setup  ## the main experiment: learn damping from simulated gear vibration with backlash
	$(BIN)/python -m gear_damping experiment=backlash $(ARGS)

test: setup  ## style, import contracts and the test suite
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(PYTEST) -m "not slow" $(ARGS)

test-sweeps: setup  ## a sweep of 60 jobs whose launcher is killed three times, beside one that is left alone (12 minutes)
	$(BIN)/python -m tests.cluster.disturbed $(ARGS)

test-slurm: setup  ## the same through a real SLURM, installed and started here (Debian, root), and a job requeued
	$(BIN)/python -m tests.cluster.slurm $(ARGS)

# The browser's driver has an environment of its own.
PAGES_VENV := .venv-pages
$(PAGES_VENV)/.installed: tests/pages/requirements.txt
	$(PYTHON) -m venv $(PAGES_VENV)
	$(PAGES_VENV)/bin/pip install --quiet --disable-pip-version-check $(PIP_OPTIONS) -r tests/pages/requirements.txt
	@touch $@

test-pages: setup $(PAGES_VENV)/.installed  ## short runs, their pages and TensorBoard in a headless Chromium (Debian: chromium, chromium-driver)
	$(BIN)/python -m tests.pages.material outputs/pages
	$(PAGES_VENV)/bin/python -m pytest -c tests/pages/pytest.ini --rootdir . --confcutdir tests/pages tests/pages $(ARGS)

check: setup  ## everything `make test` runs and the slow tests
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(PYTEST) $(ARGS)

# The site has an environment of its own: it reads the package and runs nothing of it.
DOCS_VENV := .venv-docs
$(DOCS_VENV)/.installed: docs/requirements.txt
	$(PYTHON) -m venv $(DOCS_VENV)
	$(DOCS_VENV)/bin/pip install --quiet --disable-pip-version-check $(PIP_OPTIONS) -r docs/requirements.txt
	@touch $@

docs: setup $(DOCS_VENV)/.installed  ## write the pages that follow from the code, and build the site (outputs/site)
	$(BIN)/python -m gear_damping.reporting.effects_page $(ARGS)
	$(BIN)/python -m gear_damping.reporting.measurement_page
	$(BIN)/python -m gear_damping.reporting.explanation_page
	NO_MKDOCS_2_WARNING=1 $(DOCS_VENV)/bin/mkdocs build --quiet --strict

# The peers have an environment of their own; the package needs none of them.
BENCH_VENV := .venv-bench
$(BENCH_VENV)/.installed: benchmarks/requirements.txt
	$(PYTHON) -m venv $(BENCH_VENV)
	$(BENCH_VENV)/bin/pip install --quiet --disable-pip-version-check $(PIP_OPTIONS) -r benchmarks/requirements.txt
	@touch $@

bench-setup: $(BENCH_VENV)/.installed  ## create .venv-bench with the libraries that `make bench` compares with

estimators: setup  ## measure the estimators of records into docs/estimators.md (about 4 minutes)
	$(BIN)/python -m benchmarks.record_estimators $(ARGS)

limit: setup  ## train and evaluate beside the bound, into outputs/limit and docs/limit.md (85 minutes a call at most, resumes)
	$(BIN)/python -m benchmarks.limit $(ARGS)

window: setup  ## what one window of 30 samples tells, exactly, beside the networks of windows, into docs/limit.md (40 minutes)
	$(BIN)/python -m benchmarks.window $(ARGS)

coverage: setup  ## whether the damping's interval holds the truth before and after explain, into docs/coverage.md (resumes)
	$(BIN)/python -m benchmarks.coverage $(ARGS)

alarm: setup  ## how often a network's alarm sounds on hidden effects and other rigs, into docs/limit.md (resumes)
	$(BIN)/python -m benchmarks.alarm $(ARGS)

plan-check: setup  ## what test plans promise beside what 1000 simulated tests show, into docs/plan.md (about 15 minutes)
	$(BIN)/python -m benchmarks.test_plan $(ARGS)

bench: setup  ## time simulation, transforms and training beside other libraries (about 15 minutes)
	$(BIN)/python -m benchmarks $(ARGS)

blind: setup  ## hide effects in measurements, have them explained, write outputs/blind (resumes; 85 minutes at most)
	$(BIN)/python -m tests.blind $(ARGS)

second-rig: setup  ## have 30 measurements of a second generator explained, into outputs/second_rig (resumes; --drawn 600 40 draws others)
	$(BIN)/python -m tests.second_rig $(ARGS)

real: setup  ## what explain says of real records whose answer is known, into docs/real_records.md (10 minutes)
	$(BIN)/python -m benchmarks.real_records $(ARGS)

power: setup  ## how small an effect is found, beside how small anybody could find it (85 minutes at most, resumes)
	$(BIN)/python -m tests.blind.power $(ARGS)

p-values: setup  ## draw noise in the place of residuals and count how often something is called visible (resumes)
	$(BIN)/python -m tests.blind.p_values $(ARGS)

fuzz: setup  ## damage files, declarations and commands, 10 000 of each, and see that each is read or refused (1 hour)
	$(BIN)/python -m tests.fuzz $(ARGS)

clean:  ## remove the environment and caches; outputs/ stays
	rm -rf $(VENV) .pytest_cache .ruff_cache .import_linter_cache build dist *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
