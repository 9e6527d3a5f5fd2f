# make play: install into .venv and run the app.    make test: install into .venv and run every test.
# make quick: run the tests of what differs from main, without slow ones; about a minute.
# make goldens: run the kept recordings whole, bit for bit; minutes. make goldens-anew: record them anew, which only a
# change of what a tick computes is a reason to.
# make bounds: every test, with kernels that look whether an index lies in its array, which they leave to us else.
# make abuse: what stirring, throwing and driving does to things, in figures; hours.
# make soak: random mouse and keyboard at the app for minutes, and a while in a window on a virtual screen.
# make pictures: draw the gallery's pictures of shipped levels anew, after one was changed, and those of docs/.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
# One more than two processors: tests wait for windows and processes a tenth of their time.
WORKERS ?= 3
# Byte code is kept whatever the environment says, or each of many processes would compile the package anew.
unexport PYTHONDONTWRITEBYTECODE
# What pip says of newer ones of itself is no concern of whoever plays or tests.
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# uv installs in a tenth of pip's time; pip does where there is no uv, or uv does not find what pip is set up to find.
UV := $(BIN)/python -m uv pip install --quiet --python $(BIN)/python
PIP := $(BIN)/python -m pip install --quiet
ifdef PIP_CONSTRAINT
export UV_CONSTRAINT := $(PIP_CONSTRAINT)
endif
ifdef PIP_INDEX_URL
export UV_DEFAULT_INDEX := $(PIP_INDEX_URL)
endif

.PHONY: play install test quick kernels byte-code lint bounds goldens goldens-anew pictures bench abuse soak clean

play: $(VENV)/installed
	$(BIN)/sandbox

install: $(VENV)/installed-dev

test: $(VENV)/installed-dev
	$(MAKE) --jobs=2 kernels byte-code
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal

quick: $(VENV)/installed-dev
	$(BIN)/python -m tests.quick -n $(WORKERS)

# Kernels are compiled before tests, or each worker would compile all of them.
kernels: $(VENV)/installed-dev
	-$(BIN)/python -m sandbox prepare

# As is the byte code of tests. What is wrong with them is for the run itself to say.
byte-code: $(VENV)/installed-dev
	-$(BIN)/python -m pytest --collect-only --quiet > $(VENV)/collected

lint: $(VENV)/installed-dev
	$(BIN)/ruff check sandbox tests examples
	$(BIN)/ruff format --check sandbox tests examples
	$(BIN)/mypy
	$(BIN)/mypy --strict --follow-imports=silent examples

bounds: export NUMBA_BOUNDSCHECK := 1
bounds: export NUMBA_CACHE_DIR := $(CURDIR)/$(VENV)/bounds
bounds: test

goldens: kernels
	$(BIN)/python -m pytest -n $(WORKERS) --dist worksteal tests/determinism/goldens

goldens-anew: kernels
	$(BIN)/python -m tests.determinism.make_goldens --processes $(WORKERS)

pictures: $(VENV)/installed-dev
	SDL_VIDEODRIVER=dummy $(BIN)/python -m sandbox.app.draw.picture_cache
	SDL_VIDEODRIVER=dummy $(BIN)/python -m sandbox.app.draw.app_icon
	$(BIN)/python -m tests.pictures

bench: $(VENV)/installed-dev
	failed=0; for bench in tests/bench/*.py; do echo "## $$bench"; PYTHONPATH=. $(BIN)/python "$$bench" || failed=1; \
	done; exit $$failed

abuse: $(VENV)/installed-dev
	$(BIN)/python -m tests.abuse

soak: $(VENV)/installed-dev
	SDL_VIDEODRIVER=dummy $(BIN)/python -m tests.abuse.soak
	$(BIN)/python -m tests.abuse.soak --seconds 120 --screen

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)
	-$(PIP) uv

$(VENV)/installed: $(BIN)/python pyproject.toml
	$(UV) --compile-bytecode --editable ".[export]" 2> $(VENV)/uv.log || $(PIP) --editable ".[export]"
	$(BIN)/python -m compileall -q sandbox
	touch $@

# Byte code is made of what is imported, when it is; most of what is installed here never is.
$(VENV)/installed-dev: $(BIN)/python pyproject.toml
	$(UV) --editable ".[dev]" 2> $(VENV)/uv.log || $(PIP) --no-compile --editable ".[dev]"
	touch $(VENV)/installed $@

clean:
	rm -rf $(VENV) dist build .pytest_cache .mypy_cache .ruff_cache
