.DEFAULT_GOAL := help
.PHONY: help check static format lint types imports containers viewer test

help:  ## show the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## /\1\t/' | expand -t 14

check: static test  ## everything that must pass before a change lands

static: format lint types imports containers viewer  ## the checks that run nothing of the product

format:  ## formatting (`ruff format .` mends it)
	ruff format --check .

lint:  ## likely mistakes
	ruff check .

types:  ## strict types
	mypy

imports:  ## service -> worker -> segcore, one way
	lint-imports

containers:  ## Dockerfile and compose file, without a container engine
	hadolint Dockerfile
	check-jsonschema --builtin-schema vendor.compose-spec docker-compose.yml

viewer:  ## types of the viewer, and whether service/viewer is what its sources make (`npm run build` in viewer/ mends it)
	cd viewer && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error && npm run --silent check

test:  ## the tests
	python -m pytest
