# All targets work from a fresh clone; they need Python 3.10 to 3.13 with pip, and make.

PYTHON ?= python3

# The tests of a file stay in one process.
PYTEST = -m pytest --numprocesses $(or $(WORKERS),2) --dist loadfile

VENV := .venv
BIN := $(VENV)/bin

# The tests of the method, which need neither ROS nor recordings.
ARRAY_TESTS := test/data_types test/camera test/body_parts test/numerics test/pose test/segmentation test/tracking test/estimation \
	test/training test/evaluation test/model_io

# The oldest releases that setup.py allows, on a Python that numba 0.59 has wheels for. numba 0.58
# has no wheels for Python 3.12.
FLOOR := .venv-floor
FLOOR_PACKAGES := 'numpy==1.26.*' 'numba==0.59.*' 'mcap==1.3.*' 'rosbags==0.10.*' 'pytest==7.4.*' \
	pytest-xdist
FLOOR_PYTHON = $(shell for python in '$(PYTHON)' python3.12 python3.11 python3.10; do \
	"$$python" -c 'import sys; sys.exit(not (3, 10) <= sys.version_info[:2] <= (3, 12))' \
	2>/dev/null && echo "$$python" && break; done)

# Other Pythons that are installed here. The newest one has the newest numpy, which an older Python
# may not have: numpy 2.5 needs Python 3.12. A seed gives the same people on all of them.
find_python = $(shell \
	for python in python$(1) "$${PYENV_ROOT:-$$HOME/.pyenv}"/versions/$(1).*/bin/python; do \
	"$$python" -c '' 2>/dev/null && echo "$$python" && break; done)
installed = $(foreach version,$(1),$(if $(call find_python,$(version)),$(version)))
NEWEST_VERSION := $(firstword $(call installed,3.14 3.13 3.12))
NEWEST := $(NEWEST_VERSION:%=.venv-%)
SEED_FOLDERS := $(addprefix .venv-,$(call installed,3.10) $(NEWEST_VERSION))

# colcon needs a setuptools older than the one that the other tests use.
COLCON := .venv-colcon
COLCON_PACKAGES := 'setuptools<80' colcon-core colcon-defaults colcon-library-path colcon-metadata \
	colcon-output colcon-package-selection colcon-python-setup-py colcon-recursive-crawl colcon-ros

# The ROS wheels set this for the Python that they belong to; the tests start others.
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE
ifneq ($(ROS_DISTRO),jazzy)
# The packages of another ROS distribution would hide the wheels' own.
unexport PYTHONPATH AMENT_PREFIX_PATH
endif

.NOTPARALLEL:
.DELETE_ON_ERROR:
.PHONY: help install settings test lint test-floor test-newest demo interrupts fuzz fuzz-guided model body-parts benchmarks benchmarks-live soak bounds clean

help:
	@echo 'make demo             start the live node and check its skeletons; train another model'
	@echo 'make test             linters, types, import contracts, tests on the oldest and newest numpy,'
	@echo '                      by WORKERS=2 processes'
	@echo 'make install          only the environment $(VENV), with ROS wheels unless Jazzy is sourced'
	@echo 'make interrupts       send Ctrl-C to each command at random moments, SIGNALS=300 in all'
	@echo 'make fuzz             change files and messages at random, MINUTES=10 for each reader of them'
	@echo 'make fuzz-guided      the same, guided by coverage, with Atheris'
	@echo 'make settings         write pose_node.yaml and docs/parameters.md from settings/table.py'
	@echo 'make model            train and measure the model of the package, in one or two hours;'
	@echo '                      MOCAP=DIR for motion capture, NAME=front for the other model'
	@echo 'make body-parts       train the network that finds people without a mask, in two hours;'
	@echo '                      MOCAP=DIR for motion capture'
	@echo 'make benchmarks       the curves of benchmarks/; nothing else may run meanwhile'
	@echo 'make benchmarks-live  the table of the live node, in seven minutes'
	@echo 'make soak MINUTES=30  the live node under faults; a report and a plot in the folder soak'
	@echo 'make bounds           the tests of the method, its readers and kernels, with all indices checked'
	@echo 'make clean            remove all that these targets made'

install: $(VENV)/installed

test: lint test-floor bounds test-newest

lint: $(VENV)/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	@if $(BIN)/python -c 'import sys, numpy; sys.exit(numpy.lib.NumpyVersion(numpy.__version__) < "2.3.0")'; \
	then echo $(BIN)/mypy; $(BIN)/mypy; \
	else echo 'mypy: skipped; the types are written for those of numpy 2.3 and newer'; fi
	$(BIN)/lint-imports --no-cache

test-newest: $(VENV)/installed $(COLCON)/installed $(SEED_FOLDERS:%=%/installed)
	LSC_POSE_PYTHONS='$(subst $() ,:,$(SEED_FOLDERS:%=%/bin/python))' \
	LSC_POSE_COLCON='$(COLCON)/bin/colcon' $(BIN)/python $(PYTEST)

test-floor: $(if $(FLOOR_PYTHON),$(FLOOR)/installed)
ifneq ($(FLOOR_PYTHON),)
	NUMBA_CACHE_DIR=$(FLOOR)/numba PYTHONPATH= $(FLOOR)/bin/python $(PYTEST) $(ARRAY_TESTS)
else
	@echo 'Skipped: numpy 1.26 with numba 0.59 needs Python 3.10, 3.11 or 3.12, and none is installed.'
endif

# Without checks of its indices, a kernel that leaves an array gives a wrong number, or ends the
# process. Here they are checked, on the newest numpy that is installed.
CHECKED := $(or $(NEWEST),$(VENV))
bounds: $(CHECKED)/installed
	NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(CHECKED)/numba-bounds PYTHONPATH= $(CHECKED)/bin/python \
	$(PYTEST) $(ARRAY_TESTS) test/test_absurd_input.py test/messages test/fuzz

demo: $(VENV)/installed
	$(BIN)/python -m lsc_pose_ros.demo --directory demo

interrupts: $(VENV)/installed
	$(BIN)/python test/cli/ctrl_c.py --signals $(or $(SIGNALS),300)

# The kernels are compiled first: that takes longer than an input may take.
CHECKED_FUZZ = NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(VENV)/numba-bounds $(BIN)/python
fuzz: $(VENV)/installed
	$(CHECKED_FUZZ) -m lsc_pose_ros.compile
	$(CHECKED_FUZZ) test/fuzz/fuzzing.py --minutes $(or $(MINUTES),10)

# Atheris has wheels for some Pythons only, so it is no part of the environment.
fuzz-guided: $(VENV)/installed
	$(BIN)/python -m pip install atheris
	$(CHECKED_FUZZ) -m lsc_pose_ros.compile
	$(CHECKED_FUZZ) test/fuzz/guided.py --minutes $(or $(MINUTES),10)

settings: $(VENV)/installed
	$(BIN)/python -m lsc_pose_ros.settings

model: $(VENV)/installed
	$(BIN)/python models/make.py $(NAME) $(if $(MOCAP),--mocap '$(MOCAP)')

body-parts: $(VENV)/installed
	$(BIN)/python -m pip install torch
	$(BIN)/python models/make_body_parts.py $(if $(MOCAP),--mocap '$(MOCAP)')

benchmarks: $(VENV)/installed
	$(BIN)/python benchmarks/curves.py

benchmarks-live: $(VENV)/installed
	$(BIN)/python benchmarks/live.py

soak: $(VENV)/installed
	$(BIN)/python benchmarks/soak.py --minutes $(or $(MINUTES),30)

clean:
	rm -rf $(VENV) $(FLOOR) $(COLCON) .venv-3.* demo soak build install log dist *.egg-info experiments/build experiments/*.egg-info
	rm -rf .mypy_cache .pytest_cache .ruff_cache .import_linter_cache
	find lsc_pose_ros test launch -name __pycache__ -type d -prune -exec rm -rf {} +

# A sourced Jazzy is used if the environment can import it; otherwise the wheels are installed.
$(VENV)/installed: setup.py pyproject.toml .ci/environment
ifeq ($(ROS_DISTRO),jazzy)
	.ci/environment $(VENV) '$(PYTHON)' --system-site-packages -- --editable '.[test]' --editable ./experiments
	$(BIN)/python -c 'import rclpy.node' 2>/dev/null || \
	    .ci/environment $(VENV) '$(PYTHON)' -- --editable '.[ros,test]' --editable ./experiments
else
	.ci/environment $(VENV) '$(PYTHON)' -- --editable '.[ros,test]' --editable ./experiments
endif
	@touch $@

.venv-3.%/installed: Makefile setup.py .ci/environment
	.ci/environment $(@D) '$(call find_python,3.$*)' -- --editable . pytest pytest-xdist hypothesis
	@touch $@

$(COLCON)/installed: Makefile .ci/environment
	.ci/environment $(COLCON) '$(PYTHON)' -- $(COLCON_PACKAGES)
	@touch $@

$(FLOOR)/installed: Makefile setup.py .ci/environment
	.ci/environment $(FLOOR) '$(FLOOR_PYTHON)' -- --editable . $(FLOOR_PACKAGES)
	@touch $@
