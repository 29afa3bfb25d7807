.DEFAULT_GOAL := help
.PHONY: blender packages help check static format lint types imports security audit containers viewer test image-check

# The root that replaces the base image of the Dockerfile, and the files of this machine that pip needs to find packages.
IMAGE_BASE ?= /var/tmp/cleave-image-base
IMAGE_CHECK_OPTIONS ?= $(foreach path,$(wildcard /etc/pip.conf /etc/ssl/certs),--bind $(path))

help:  ## show the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 14

check: static test  ## everything that must pass before a change is merged

static: format lint types imports security containers viewer  ## the checks that do not run the product

format:  ## formatting (`ruff format .` fixes it)
	ruff format --check .

lint:  ## likely mistakes
	ruff check .

types:  ## strict types
	mypy

imports:  ## the layers of the packages
	lint-imports

security:  ## insecure patterns in the code
	bandit --quiet --configfile pyproject.toml --recursive cleave segcore worker service

audit: security  ## also known vulnerabilities of the installed packages (needs the internet and the extra `audit`)
	pip freeze --exclude-editable --exclude cleave-mesh | pip-audit --strict --disable-pip --no-deps --requirement /dev/stdin

containers:  ## Dockerfile and compose files, without a container engine
	hadolint Dockerfile
	check-jsonschema --builtin-schema vendor.compose-spec docker-compose.yml deploy/compose/tls.yml

viewer:  ## types of the viewer, and if service/viewer is up to date (`npm run build` in viewer/ updates it)
	cd viewer && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error && npm run --silent check

packages:  ## dist/: the npm packages cleave-client and cleave-viewer
	mkdir -p dist
	for folder in integrations/client-js viewer; do (cd $$folder && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error && npm pack --loglevel=error --pack-destination $(CURDIR)/dist) || exit 1; done

blender:  ## dist/: the extension for Blender
	python -m integrations.blender_package dist

image-check:  ## build the Dockerfile in a clean Debian and segment a mesh in the image (needs root and debootstrap; minutes)
	test -x $(IMAGE_BASE)/usr/bin/python3 || debootstrap --variant=minbase --include=python3,python3-venv,ca-certificates bookworm $(IMAGE_BASE)
	test -e $(IMAGE_BASE)/usr/local/bin/python || ln -s /usr/bin/python3 $(IMAGE_BASE)/usr/local/bin/python
	python -m deploy.image_check $(IMAGE_BASE) $(IMAGE_CHECK_OPTIONS)

test:  ## the tests
	python -m pytest
