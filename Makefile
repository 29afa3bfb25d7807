.DEFAULT_GOAL := help
.PHONY: help check static format lint types imports security audit containers viewer test image-check

# What stands for the image that the Dockerfile begins with, and what pip needs of this machine to find packages.
IMAGE_BASE ?= /var/tmp/cleave-image-base
IMAGE_CHECK_OPTIONS ?= $(foreach path,$(wildcard /etc/pip.conf /etc/ssl/certs),--bind $(path))

help:  ## show the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 14

check: static test  ## everything that must pass before a change lands

static: format lint types imports security containers viewer  ## the checks that run nothing of the product

format:  ## formatting (`ruff format .` mends it)
	ruff format --check .

lint:  ## likely mistakes
	ruff check .

types:  ## strict types
	mypy

imports:  ## service -> worker -> segcore, one way
	lint-imports

security:  ## patterns in the code that let attackers in
	bandit --quiet --configfile pyproject.toml --recursive cleave segcore worker service

audit: security  ## known vulnerabilities of the installed packages, too (asks a service on the internet; extra `audit`)
	pip freeze --exclude-editable --exclude cleave-mesh | pip-audit --strict --disable-pip --no-deps --requirement /dev/stdin

containers:  ## Dockerfile and compose file, without a container engine
	hadolint Dockerfile
	check-jsonschema --builtin-schema vendor.compose-spec docker-compose.yml

viewer:  ## types of the viewer, and whether service/viewer is what its sources make (`npm run build` in viewer/ mends it)
	cd viewer && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error && npm run --silent check

image-check:  ## the Dockerfile's steps in a clean Debian, and a mesh through the result (root, debootstrap, minutes)
	test -x $(IMAGE_BASE)/usr/bin/python3 || debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates bookworm $(IMAGE_BASE)
	test -e $(IMAGE_BASE)/usr/local/bin/python || ln -s /usr/bin/python3 $(IMAGE_BASE)/usr/local/bin/python
	python -m deploy.image_check $(IMAGE_BASE) $(IMAGE_CHECK_OPTIONS)

test:  ## the tests
	python -m pytest
