.DEFAULT_GOAL := help
.PHONY: help check static format lint types imports containers test

help:  ## show the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z]+):.*## /\1\t/' | expand -t 14

check: static test  ## everything that must pass before a change lands

static: format lint types imports containers  ## the checks that run nothing of the product

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

test:  ## the tests
	python -m pytest
