# One environment, .venv. Each target first installs the pinned packages that it needs (requirements/*.txt, with hashes):
# runtime to run the study; development and documentation to change it; cluster for Dask.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUNTIME := $(VENV)/.runtime
DEVELOPMENT := $(VENV)/.development
DOCUMENTATION := $(VENV)/.documentation
CLUSTER := $(VENV)/.cluster
# pip compiles one module after the other, and tests as well: half of the time of an installation.
INSTALL := $(BIN)/python -m pip install --quiet --no-compile
COMPILE := $(BIN)/python -m compileall -q -j 0 -x /tests/ $(VENV)/lib
PAGES := README.md docs/index.md docs/explanation/results.md docs/reference/statements.md docs/explanation/other-codes.md \
	docs/explanation/verdicts.md docs/reference/columns.md

.PHONY: study full again faults seeds test dist tutorials pages codes codes-bounds codes-venv codes-check dist-debian certificates \
	certificates-check trials bench bench-growth bench-peers \
	bench-parallel lint docs paper film cluster lock clean help

study: $(RUNTIME)  ## quick study, results/quick, less than a minute on two cores
	$(BIN)/study run --quick --figures --undecided results/undecided-quick.csv --out results/quick

full: $(DEVELOPMENT) $(DOCUMENTATION) $(CLUSTER)  ## full study, results/, half an hour, and the tests marked slow
	$(BIN)/study run --full --undecided results/undecided-full.csv --out results
	$(BIN)/study faults --out results
	$(BIN)/study tables --out results
	$(BIN)/study figures --out results
	$(BIN)/python -m study.present.pages results $(PAGES)
	$(BIN)/pytest -m slow --numprocesses auto

again: $(RUNTIME)  ## measure 100 random rows of the committed results again and compare, a minute; ROWS=N, SEED=S; prints only
	$(BIN)/study check --undecided results/undecided-full.csv --out results --again $(or $(ROWS),100) $(if $(SEED),--seed $(SEED))

faults: $(RUNTIME)  ## which checks notice deliberate faults, and in which cases; results/quick, some minutes
	$(BIN)/study faults --out results/quick

seeds: $(RUNTIME)  ## false-alarm rate: judge fresh random meshes for an hour, added to results/data/seeds.csv
	$(BIN)/study seeds --out results || test $$? -eq 3  # 3: not enough seeds yet to decide
	$(BIN)/python -m study.present.pages results $(PAGES)

# The tests also start a Dask cluster and read the extensions of the documentation.
test: $(DEVELOPMENT) $(DOCUMENTATION) $(CLUSTER)  ## all tests except those marked slow, about four minutes on two cores; prints only
	$(BIN)/pytest --numprocesses auto

# As where others install it: from the source distributions, without extras, away from the repository.
dist: $(RUNTIME)  ## build sdist and wheel, install the wheel of the sdist with NumPy and SymPy alone and test it there, build/dist
	rm -rf build/dist
	mkdir -p build/dist
	for project in . convergence_orders; do (cd $$project && $(CURDIR)/$(BIN)/python -c \
		"import sys; from setuptools.build_meta import build_sdist; build_sdist(sys.argv[1])" $(CURDIR)/build/dist > /dev/null) || \
		exit 1; done
	tar -tzf build/dist/signorini_study-*.tar.gz > build/dist/files.txt
	for file in CITATION.cff Makefile docs/index.md examples/codes/contact_judge.py tests/conftest.py; do \
		grep -q "^[^/]*/$$file$$" build/dist/files.txt || \
		{ echo "$$file is not in the source distribution: add it to MANIFEST.in"; exit 1; }; done
	$(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation -w build/dist build/dist/*.tar.gz
	$(BIN)/python .ci/base.py requirements/runtime.txt > build/dist/base.txt
	$(BIN)/python -m venv build/dist/venv
	build/dist/venv/bin/python -m pip install --quiet --require-hashes -r build/dist/base.txt
	build/dist/venv/bin/python -m pip install --quiet --no-index build/dist/*.whl
	cp .ci/alone.py README.md build/dist && cd build/dist && venv/bin/python alone.py README.md
	if $(BIN)/python -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then $(MAKE) dist-debian; fi

# NumPy 1.24 has wheels up to Python 3.11.
dist-debian:  ## the same with NumPy and SymPy of Debian 12, from the wheel of make dist, build/dist/debian; Python 3.11
	$(BIN)/python -m venv --clear build/dist/debian
	build/dist/debian/bin/python -m pip install --quiet --only-binary :all: -r .ci/debian.txt
	build/dist/debian/bin/python -m pip install --quiet --no-index build/dist/*.whl
	cd build/dist && debian/bin/python alone.py README.md

tutorials: $(DEVELOPMENT) $(DOCUMENTATION)  ## run the notebooks, and the commands of the documentation pages that take minutes; prints only
	$(BIN)/pytest -m slow tests/project/test_pages.py

pages: $(RUNTIME)  ## write the tables of README.md and docs/ from results/, and results/badges
	$(BIN)/python -m study.present.pages results $(PAGES)

codes: $(RUNTIME)  ## run the installed contact codes of other projects, results/codes, half an hour
	OMP_NUM_THREADS=1 $(BIN)/python examples/codes/run_codes.py
	OMP_NUM_THREADS=1 $(BIN)/python examples/codes/run_codes.py --mode march
	$(BIN)/python -m study.present.pages results $(PAGES)

codes-bounds: $(RUNTIME)  ## bound the errors of the installed contact codes where nobody knows the solution, results/codes, an hour
	OMP_NUM_THREADS=1 $(BIN)/python examples/bounds/judge_codes.py
	OMP_NUM_THREADS=1 $(BIN)/python examples/bounds/certify_codes.py

codes-venv: build/codes-venv/.ready  ## install the codes that come as wheels, build/codes-venv

build/codes-venv/.ready: examples/codes/requirements.txt
	$(PYTHON) -m venv build/codes-venv
	build/codes-venv/bin/python -m pip install --quiet -r examples/codes/requirements.txt
	touch $@

codes-check: $(RUNTIME) build/codes-venv/.ready  ## run two codes on one case and compare with results/codes, build/codes-check, a minute
	OMP_NUM_THREADS=1 $(BIN)/python examples/codes/run_codes.py --only kratos_mortar ngsolve_penalty \
		--cases advance-recede --families one-diagonal --levels 8 16 32 \
		--tasks build/codes-check/tasks --out build/codes-check --check

certificates: $(RUNTIME)  ## certificates of error bounds for three problems, build/certificates, some minutes, 12 MB; LEVELS="4 8"
	for name in "square --family one-diagonal" wedge bracket; do \
		OMP_NUM_THREADS=1 $(BIN)/study certify examples/certificates/problems.py:$$name \
		--levels $(or $(LEVELS),4 8) --out build/certificates || exit 1; done

certificates-check:  ## check the committed certificates with the checker alone and Python without packages; prints only
	mkdir -p build && cp study/certify/checker.py build/checker.py
	for name in square wedge bracket; do \
		$(PYTHON) -I -S build/checker.py examples/certificates/$$name-4.json.gz || exit 1; done

trials: $(RUNTIME)  ## test the bounds on 400 random problems and on stiff materials, results/trials, half an hour
	OMP_NUM_THREADS=1 nice -n 10 $(BIN)/python -m benchmarks.trials.run

# Benchmarks are not tests: a slow machine or a missing peer is no failure.
WARNING ?= WARNING:
bench: $(DEVELOPMENT)  ## ratios of timings, results/benchmarks, some minutes; warns if one got worse
	mkdir -p build && rm -f build/timings.json
	-OMP_NUM_THREADS=1 $(BIN)/pytest -p no:xdist --benchmark-columns=median,iqr,rounds \
		--benchmark-json=build/timings.json benchmarks/bench_ratios.py $(BENCH)
	-OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.ratios build/timings.json | sed "s/^WARNING:/$(WARNING)/"

bench-growth: $(DEVELOPMENT)  ## time and memory on finer and finer meshes, results/benchmarks, some minutes, 10 GB of memory
	-OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.growth

bench-peers: $(DEVELOPMENT)  ## solve the same matrices with other programs, results/benchmarks, half an hour
	-OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.compare

bench-parallel: $(DEVELOPMENT)  ## the quick study with one and with two processes, results/benchmarks, four minutes; PLAN=--full, an hour
	-OMP_NUM_THREADS=1 $(BIN)/python -m benchmarks.parallel $(PLAN)

lint: $(DEVELOPMENT)  ## check style, types, the order of imports and the weight; prints only
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache
	$(BIN)/python .ci/weight.py

docs: $(DOCUMENTATION)  ## build the documentation with notebooks, gallery and API, build/docs/index.html; FILMS=no saves minutes
	$(BIN)/sphinx-build -q -W --keep-going -b html docs build/docs

# The figures of the papers, drawn for their width and with their letters.
FIGURES := body-hexagon codes collapsed contact-work convergence enclosure-ramp problem profiles-merging-patches rollers \
	zone-merging-patches
LATEX := latexmk -cd -pdf -halt-on-error -interaction=nonstopmode -outdir=build

# The study refers to tables of the supplement, and the supplement to the study: it is built before and after.
paper: $(RUNTIME)  ## both papers and the supplement from results/, paper/build; needs latexmk
	$(BIN)/study tables --out results
	$(BIN)/study figures --data results --out paper/build --style paper/figures.mplstyle --format pdf --only $(FIGURES)
	$(BIN)/python paper/formulas.py paper/build/formulas.tex
	$(BIN)/python paper/certified.py paper/build/certified.tex
	$(LATEX) paper/supplement.tex
	$(LATEX) -Werror paper/theory.tex paper/study.tex
	$(LATEX) -Werror -g paper/supplement.tex

film: $(VENV)/.film  ## add ffmpeg to .venv, 70 MB, for study show --mp4

cluster: $(CLUSTER)  ## add Dask to .venv, for study run --cluster

$(RUNTIME): requirements/runtime.txt pyproject.toml convergence_orders/pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python 3.11 or newer is needed, $$($(PYTHON) --version 2>&1) was found: set PYTHON=..."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(INSTALL) --require-hashes -r requirements/runtime.txt
	$(INSTALL) --no-deps --no-build-isolation --editable ./convergence_orders --editable .
	-$(COMPILE) study manufactured convergence_orders
	touch $@

$(VENV)/.%: requirements/%.txt $(RUNTIME)
	$(INSTALL) --require-hashes -r $<
	-$(COMPILE)
	touch $@

LOCK := $(VENV)-lock/bin/pip-compile --quiet --upgrade --generate-hashes --strip-extras --allow-unsafe \
	--no-emit-index-url --no-emit-find-links --no-emit-trusted-host --no-header

# In this order: a package of several files gets the version of the first one. runtime.txt has setuptools as well, which
# installs the packages of this repository.
lock:  ## renew the pins, requirements/
	$(PYTHON) -m venv $(VENV)-lock
	$(VENV)-lock/bin/python -m pip install --quiet dependency-groups pip-tools
	$(LOCK) --extra study --build-deps-for editable -o requirements/runtime.txt pyproject.toml
	$(VENV)-lock/bin/python -m dependency_groups dev | \
		$(LOCK) -c requirements/runtime.txt -o requirements/development.txt -
	$(VENV)-lock/bin/python -m dependency_groups docs | \
		$(LOCK) -c requirements/runtime.txt -c requirements/development.txt -o requirements/documentation.txt -
	$(LOCK) --extra cluster -c requirements/runtime.txt -c requirements/development.txt -c requirements/documentation.txt \
		-o requirements/cluster.txt pyproject.toml
	$(LOCK) --extra film -c requirements/runtime.txt -o requirements/film.txt pyproject.toml
	rm -rf $(VENV)-lock

help:  ## list these targets and where their output lies
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "%-20s %s\n", $$1, $$2 }' Makefile

clean:  ## remove the environment and everything that was built
	rm -rf $(VENV) results/quick paper/build docs/generated build
