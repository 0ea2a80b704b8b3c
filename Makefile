# make serve    the dashboard, on this machine
# make test     everything that CI checks
# make bench    timings, each beside its yardstick
# make fuzz     five hundred random sequences of everything that can be done to the page
# make load     fifty visitors at once, two hundred who come and go, a thousand moves
# make verify   the program against independent programs: writes docs/verification.md
# make docs     the notebooks, run and written as HTML: docs/html/index.html
# make image    the web demo's container image, with a check of it (docker or podman)
# make demo     that container, running
# make lock     the newest versions for the image, with their hashes
#
#   PYTHON=/path/to/python3   the interpreter for the virtual environment (default: first >= 3.11)
#   VENV=.venv                where that environment is
#   PORT=5006                 where the dashboard answers
#   ENGINE=docker             what builds and runs containers (default: podman if there is no docker)

VENV ?= .venv
PORT ?= 5006
ENGINE ?= $(shell command -v docker || command -v podman || echo docker)
export VENV PYTHON PORT

python = $(VENV)/bin/python

.DEFAULT_GOAL := help
.PHONY: help serve test bench fuzz load verify docs lint image demo lock clean

help:
	@sed -n 's/^# \{0,1\}//p; /^$$/q' Makefile

serve:
	@sh tools/environment.sh run
	@sh tools/serve.sh

test: lint
	@$(python) tools/find_chromium.py
	@echo "==> pytest"
	@$(python) -m pytest

bench:
	@sh tools/environment.sh test
	@$(python) tools/find_chromium.py
	@echo "==> benchmarks"
	@$(python) -m pytest tests/benchmarks --ignore tests/benchmarks/test_load.py

fuzz:
	@sh tools/environment.sh test
	@FUZZ=500 $(python) -m pytest tests/app/test_fuzz.py

load:
	@sh tools/environment.sh test
	@$(python) tools/find_chromium.py
	@$(python) -m pytest tests/benchmarks/test_load.py

verify:
	@sh tools/environment.sh test
	@echo "==> verification"
	@$(python) -m verification

docs:
	@sh tools/environment.sh test
	@echo "==> notebooks"
	@$(python) tools/docs.py

lint:
	@sh tools/environment.sh test
	@echo "==> ruff check"
	@$(python) -m ruff check
	@echo "==> ruff format"
	@$(python) -m ruff format --check
	@echo "==> mypy"
	@$(python) -m mypy

image:
	@sh deploy/build.sh "$(ENGINE)"

demo: image
	@echo "==> serving the dashboard at http://localhost:$(PORT) (Ctrl+C stops it)"
	@$(ENGINE) run --rm --init --read-only --cap-drop ALL --security-opt no-new-privileges \
		--memory 512m --publish "$(PORT):5006" bogie-hunting

lock:
	@sh tools/lock.sh

clean:
	rm -rf $(VENV) build dist docs/html .mypy_cache .pytest_cache .ruff_cache .hypothesis .benchmarks test-results
