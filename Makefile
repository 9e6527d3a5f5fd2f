# make play: install into .venv and run the app.
# make test: install into .venv and run every test but whole-world ones, which take many seconds each and tell of kernels
# and formats alone. make test-all: those too; minutes more. make whole-world: those alone, if kernels or formats differ
# from main, or from the commit that SINCE names.
# make quick: run the tests of what differs from main, without slow and whole-world ones; about a minute.
# make goldens: run the kept recordings whole, bit for bit; minutes. make goldens-record: record them again, after a
# change of a tick's arithmetic or of a shipped level; never to make a failing test pass. make goldens-everywhere: run
# them in WebAssembly and on an emulated arm64 too, where node and qemu-user with libc6-arm64-cross are installed, and
# in pages, where Chromium is.
# make seeds: random levels and commands, run several ways, bit for bit; half an hour. SEEDS=50: fewer than 1,000;
# ARGUMENTS="--jobs 2": in two processes.
# make bounds: run recordings, random levels and kernels alone with a look at each index; usual kernels do not look.
# make libraries: machine code of the kernels for all platforms, after a kernel was changed; minutes. CHECK=1 compares
# it with what is there, HERE=1 only this platform's.
# make abuse: stir, throw and drive bodies, and print figures; hours.
# make soak: random mouse and keyboard at the app for minutes, on a dummy driver and on a virtual screen; and ten minutes
# of random mouse and touch at pages, where Chromium is installed.
# make bundle: the script of pages, after one of their modules was changed; seconds. make node: what that, lint and tests of
# JavaScript need from npm, into .venv/npm. make lint: ruff and mypy, and for JavaScript TypeScript and eslint.
# make pictures: draw the pictures of the gallery and of docs/ again, after a level or the look was changed.
# make site: the levels, each at an address of its own, and the documents, as files for any web server, in the folder site.
PYTHON ?= python3
VENV := .venv
# Modules of pages, what checks and bundles them, and where npm puts that.
WEB := sandbox/page/web
NPM := $(VENV)/npm
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
# One more than two processors: tests spend a tenth of their time waiting for windows and processes.
WORKERS ?= 3
# Byte code is always kept: else each of many processes would compile the package again.
unexport PYTHONDONTWRITEBYTECODE
# pip shall not announce its newer versions here.
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# uv installs in a tenth of pip's time. pip installs where there is no uv, or where uv does not know pip's settings.
UV := $(BIN)/python -m uv pip install --quiet --python $(BIN)/python
PIP := $(BIN)/python -m pip install --quiet
ifdef PIP_CONSTRAINT
export UV_CONSTRAINT := $(PIP_CONSTRAINT)
endif
ifdef PIP_INDEX_URL
export UV_DEFAULT_INDEX := $(PIP_INDEX_URL)
endif

.PHONY: play install test test-all whole-world quick lint lint-pages bounds goldens goldens-everywhere goldens-record seeds libraries node bundle pictures site bench abuse soak clean

play: $(VENV)/installed
	$(BIN)/sandbox

install: $(VENV)/installed-dev

PYTEST := $(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

test: $(VENV)/collected
	$(PYTEST) -m "not whole_world"

test-all: $(VENV)/collected
	$(PYTEST)

whole-world: $(VENV)/collected
	$(BIN)/python -m tests.whole_world -n $(WORKERS) --dist worksteal

# Tests are collected once before: byte code of theirs is made then. The run itself reports broken tests.
$(VENV)/collected: $(VENV)/installed-dev
	-$(BIN)/python -m pytest --collect-only --quiet > $@

quick: $(VENV)/installed-dev
	$(BIN)/python -m tests.quick -n $(WORKERS)

lint: $(VENV)/installed-dev lint-pages
	$(BIN)/ruff check sandbox tests docs/examples
	$(BIN)/ruff format --check sandbox tests docs/examples
	$(BIN)/mypy
	$(BIN)/mypy --strict --follow-imports=silent docs/examples

lint-pages: $(VENV)/installed-node
	$(BIN)/node $(NPM)/node_modules/typescript/bin/tsc -p $(WEB)
	$(BIN)/node $(NPM)/node_modules/eslint/bin/eslint.js --config $(WEB)/eslint.config.mjs .

bounds: export SANDBOX_KERNELS := checked
bounds: $(VENV)/installed-dev
	$(BIN)/python -m tests.determinism.matrix --setting checked
	$(BIN)/python -m tests.determinism.twins --rounds 20
	$(BIN)/python -m tests.determinism.seeds --seeds 50 --ways checked
	$(PYTEST) tests/physics tests/level/test_shipped_levels.py

goldens: $(VENV)/installed-dev
	$(PYTEST) tests/determinism/goldens

goldens-everywhere: $(VENV)/installed-dev
	$(BIN)/python -m tests.determinism.elsewhere
	$(BIN)/python -m tests.page.goldens

goldens-record: $(VENV)/installed-dev
	$(BIN)/python -m tests.determinism.make_goldens --processes $(WORKERS)

seeds: $(VENV)/installed-dev
	$(BIN)/python -m tests.determinism.seeds $(if $(SEEDS),--seeds $(SEEDS)) $(ARGUMENTS)

libraries: $(VENV)/installed-dev
	$(BIN)/python -m sandbox.physics.jit.making.libraries $(if $(CHECK),--check) $(if $(HERE),--here)

node: $(VENV)/installed-node

bundle: $(VENV)/installed-node
	$(BIN)/python -m sandbox.app.site.shared_values
	$(BIN)/python -m sandbox.page.bundle

pictures: $(VENV)/installed-dev
	SDL_VIDEODRIVER=dummy $(BIN)/python -m sandbox.app.draw.picture_cache
	SDL_VIDEODRIVER=dummy $(BIN)/python -m sandbox.app.draw.app_icon
	$(BIN)/python -m tests.pictures

site: $(VENV)/installed-dev
	$(BIN)/sandbox site --document README.md -o site

bench: $(VENV)/installed-dev
	failed=0; for bench in tests/bench/*.py tests/bench/*/__main__.py; do echo "## $$bench"; PYTHONPATH=. $(BIN)/python "$$bench" || failed=1; \
	done; exit $$failed

abuse: $(VENV)/installed-dev
	$(BIN)/python -m tests.abuse

soak: $(VENV)/installed-dev
	SDL_VIDEODRIVER=dummy $(BIN)/python -m tests.abuse.soak
	$(BIN)/python -m tests.abuse.soak --seconds 120 --screen
	$(BIN)/python -m tests.page.soak

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)
	-$(PIP) uv

$(VENV)/installed: $(BIN)/python pyproject.toml
	$(UV) --compile-bytecode --editable ".[export]" 2> $(VENV)/uv.log || $(PIP) --editable ".[export]"
	$(BIN)/python -m compileall -q sandbox
	touch $@

# Byte code is made at the first import; most installed modules are never imported.
$(VENV)/installed-dev: $(BIN)/python pyproject.toml
	$(UV) --editable ".[dev]" 2> $(VENV)/uv.log || $(PIP) --no-compile --editable ".[dev]"
	touch $(VENV)/installed $@

# node comes with the packages for Python.
$(VENV)/installed-node: $(VENV)/installed-dev $(WEB)/package-lock.json
	mkdir -p $(NPM)
	cp $(WEB)/package.json $(WEB)/package-lock.json $(NPM)
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/npm ci --prefix $(NPM) --ignore-scripts --no-audit --no-fund --loglevel=error
	touch $@

clean:
	rm -rf $(VENV) dist build site .pytest_cache .mypy_cache .ruff_cache
