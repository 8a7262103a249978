# Every task of the project, one command each: `make help` lists them.
#
# Set-up happens by itself, once, and again where what it depends on has changed: each step leaves a
# stamp in .venv. Python is read from src as it stands; a change in core/ builds the core anew.

PYTHON ?= python3

VENV := .venv
RUN := $(VENV)/bin/python
# For CMake, which is to find its own program, Python and nanobind in .venv.
WITH_VENV := PATH="$(CURDIR)/$(VENV)/bin:$$PATH" VIRTUAL_ENV="$(CURDIR)/$(VENV)"

# The core is compiled in Release mode for the editable install, the wheel and the library that programs in C link:
# where ccache is installed, each source once. CMake reads the launcher and the compiler, by the same name for all
# three, from the environment.
CCACHE := $(shell command -v ccache)
ifneq ($(CCACHE),)
$(VENV)/.core test-python test-install: export CMAKE_CXX_COMPILER_LAUNCHER ?= $(CCACHE)
$(VENV)/.core test-python test-install: export CXX := $(CXX)
$(VENV)/.core test-python test-install: export CCACHE_DIR ?= $(CURDIR)/build/ccache
$(VENV)/.core test-python test-install: export CCACHE_BASEDIR ?= $(CURDIR)
$(VENV)/.core test-python test-install: export CCACHE_NOHASHDIR ?= true
endif

EXAMPLE := examples/request_grant
CXX_FILES := find core tests/cpp tests/fuzz benchmarks -name

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help run setup test test-python test-cpp test-install lint lint-python lint-cpp format docs images paper bench bench-ros field costs budget peers conformance soak vsix vscode viewers fuzz clean

help: ## list the tasks
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-13s %s\n", $$1, $$2 }' Makefile

# `check` says 1 where a requirement is violated, as two of the four recordings do; 2 is an error.
run: $(VENV)/.core ## check the four recordings of the paper's Fig. 4: specification in, robustness and verdict out
	$(VENV)/bin/rtamt check $(EXAMPLE)/spec.stl $(EXAMPLE)/*.csv || [ $$? -eq 1 ]

setup: $(VENV)/.core $(VENV)/.group-test $(VENV)/.group-lint $(VENV)/.group-wheel $(VENV)/.apt ## install what tests and linters need

test: test-python test-cpp test-install ## everything that can be tested

# In the order of the folders: by default files with few tests come last, and some of these take long on one core alone.
test-python: $(VENV)/.core $(VENV)/.group-test $(VENV)/.apt ## Python: laws, units, messages, doctests
	$(RUN) -m pytest -n "$$(nproc)" --dist loadfile --no-loadscope-reorder

test-cpp: $(VENV)/.group-build ## C++: the core alone, under the address, undefined-behaviour and thread sanitizers
	$(WITH_VENV) cmake --preset asan
	$(WITH_VENV) cmake --build --preset asan
	$(WITH_VENV) ctest --preset asan --no-tests=error
	$(WITH_VENV) cmake --preset tsan
	$(WITH_VENV) cmake --build --preset tsan
	$(WITH_VENV) ctest --preset tsan --no-tests=error

# The steps of .github/workflows/wheels.yml that this machine can run. The wheel is built from the unpacked source
# distribution, in a folder as deep as the clone's: ccache compares paths relative to it.
test-install: $(VENV)/.group-wheel ## a source distribution and a wheel, installed in an empty environment, then the newcomer's path to an explained violation
	rm -rf build/install build/dist build/sdist
	mkdir -p build/sdist
	$(RUN) -m build --sdist --outdir build/dist . >build/dist.log || { cat build/dist.log; exit 1; }
	tar -xzf build/dist/*.tar.gz -C build/sdist --strip-components 1
	MAKEFLAGS= PATH="$(CURDIR)/$(VENV)/bin:$$PATH" $(RUN) -m build --wheel --config-setting=build-dir=build/wheel --outdir build/dist build/sdist >build/dist.log || { cat build/dist.log; exit 1; }
	[ "$$(uname)" != Linux ] || PATH="$(CURDIR)/$(VENV)/bin:$$PATH" $(RUN) -m auditwheel repair --wheel-dir build/dist/repaired build/dist/*.whl
	$(RUN) -m venv build/install
	build/install/bin/python -m pip install --quiet "$$(ls build/dist/repaired/*.whl build/dist/*.whl 2>/dev/null | head -n 1)"
	tools/newcomer "$(CURDIR)/build/install/bin/rtamt" build/install/newcomer

lint: lint-python lint-cpp ## every linter

lint-python: $(VENV)/.core $(VENV)/.group-test $(VENV)/.group-lint ## ruff, mypy, import contracts
	$(RUN) -m ruff check
	$(RUN) -m ruff format --check
	$(RUN) -m mypy
	$(RUN) -m mypy tests/unit/typed_program.py
	$(VENV)/bin/lint-imports

lint-cpp: $(VENV)/.group-build $(VENV)/.group-lint ## clang-format, clang-tidy
	$(CXX_FILES) '*.[ch]pp' | xargs $(VENV)/bin/clang-format --dry-run --Werror
	$(WITH_VENV) cmake --preset tidy --log-level=WARNING
	$(CXX_FILES) '*.cpp' | xargs -P "$$(nproc)" -n 1 $(VENV)/bin/clang-tidy -p build/tidy --quiet

format: $(VENV)/.group-lint ## format Python and C++
	$(RUN) -m ruff check --select I --fix
	$(RUN) -m ruff format
	$(CXX_FILES) '*.[ch]pp' | xargs $(VENV)/bin/clang-format -i

docs: $(VENV)/.core $(VENV)/.group-docs ## build the site into build/site: pages, reference and diagrams, links checked
	NO_MKDOCS_2_WARNING=1 $(VENV)/bin/mkdocs build --quiet

images: $(VENV)/.core $(VENV)/.extras ## draw docs/images anew
	$(RUN) tools/images.py

paper: $(VENV)/.core $(VENV)/.extras peers ## the paper's listings, tables and figures, run again beside its claims: build/paper
	$(RUN) examples/paper/reproduce.py

bench: $(VENV)/.core $(VENV)/.extras $(VENV)/.group-build peers ## every tool timed beside the others, five rounds: benchmarks/RESULTS.md and plots
	$(WITH_VENV) cmake -S . -B build/bench -G Ninja -DCMAKE_BUILD_TYPE=Release -DRTAMT_BUILD_BENCH=ON -DRTAMT_BUILD_TESTS=OFF
	$(WITH_VENV) cmake --build build/bench --target fused_bench
	$(RUN) benchmarks/run.py

bench-ros: $(VENV)/.core $(VENV)/.group-test $(VENV)/.apt ## 200 monitors in one ROS 1 node at 100 Hz, and rospy alone: benchmarks/ROS.md
	$(RUN) benchmarks/ros_bench.py --output benchmarks/ROS.md

field: $(VENV)/.core $(VENV)/.extras ## read, profile, plot and report every log in a folder: LOGS=FOLDER, output in build/field
	$(RUN) tools/field.py "$(LOGS)"

costs: $(VENV)/.core $(VENV)/.extras ## what a sample costs us, beside the figures to reach; memory of dense time and of streams
	$(RUN) benchmarks/costs.py
	$(RUN) benchmarks/dense_memory.py
	$(RUN) benchmarks/early.py
	$(RUN) benchmarks/early.py 100000 dense
	$(RUN) benchmarks/stream.py
	$(RUN) benchmarks/packs.py
	$(RUN) benchmarks/play.py
	$(RUN) benchmarks/instructions.py

budget: $(VENV)/.core ## record the instructions of the hot paths, which a test compares: benchmarks/budget.toml
	$(RUN) benchmarks/instructions.py --renew

peers: $(VENV)/.made ## install the tools that we are compared with, each into an environment of its own
	@tools/apt-packages flex bison libfl-dev || echo "A tool whose build needs them is left out."
	$(RUN) conformance/peers/peers.py

conformance: $(VENV)/.core peers ## ask every peer the conformance corpus: conformance/RESULTS.md
	$(RUN) conformance/table.py

soak: $(VENV)/.core $(VENV)/.group-test $(VENV)/.group-build ## watch 10^8 samples and hours of dense stamps, 10^6 cases of bounds and early verdicts, 10^4 formulas of the solver, ten times as many examples of every law; run 10^6 changed programs and states each
	$(RUN) benchmarks/soak.py
	$(RUN) -m tests.laws.early.soak 1000000
	$(RUN) -m tests.laws.analysis_soak 10000
	$(RUN) -m pytest tests/laws --hypothesis-profile=soak --timeout=0
	$(WITH_VENV) cmake --preset asan
	$(WITH_VENV) cmake --build --preset asan --target mutate_compiled mutate_forged
	build/asan/tests/fuzz/mutate_compiled 1000000 1000000 tests/fuzz/corpus/compiled
	build/asan/tests/fuzz/mutate_forged 1000000 1000000

vsix: ## build the extension for Visual Studio Code with npm: editors/vscode/rtamt.vsix
	cd editors/vscode && npm install --no-audit --no-fund && npm run package

vscode: $(VENV)/.core $(VENV)/.extras vsix ## use the extension in a real Visual Studio Code, which npm installs into build/vscode, and draw docs/images/editor*.png
	$(RUN) tools/vscode.py

viewers: $(VENV)/.core $(VENV)/.extras ## open files and views in Foxglove Studio (from npm, in build/foxglove), Rerun and JupyterLab, and draw their images; needs xvfb and mesa-vulkan-drivers
	$(RUN) -m pip install --quiet "rtamt[rerun]" jupyterlab
	$(RUN) tools/viewers.py

FUZZ_SECONDS ?= 60
FUZZ_CXX ?= clang++
# A window of 10^9 samples asks for its memory at once: where there is none, the core reports an error.
FUZZ_ENVIRONMENT := ASAN_OPTIONS=allocator_may_return_null=1:max_allocation_size_mb=512
fuzz: $(VENV)/.core $(VENV)/.group-test $(VENV)/.group-build ## look for input that breaks the core, the parser or the readers: FUZZ_SECONDS, then some minutes
	@echo 'static_assert(__clang_major__ >= 16);' | $(FUZZ_CXX) -x c++ -std=c++20 -fsyntax-only - 2>/dev/null || { echo "error: make fuzz needs Clang 16 or newer: on Debian 12, install clang-19 and libclang-rt-19-dev, then make fuzz FUZZ_CXX=clang++-19" >&2; exit 1; }
	$(WITH_VENV) cmake --preset fuzz -DCMAKE_CXX_COMPILER=$(FUZZ_CXX)
	$(WITH_VENV) cmake --build --preset fuzz
	for target in program state compiled forged; do \
	    mkdir -p build/fuzz/found/$$target && \
	    $(FUZZ_ENVIRONMENT) build/fuzz/tests/fuzz/fuzz_$$target build/fuzz/found/$$target tests/fuzz/corpus/$$target \
	        -artifact_prefix=build/fuzz/ -max_total_time=$(FUZZ_SECONDS) -timeout=10 -rss_limit_mb=1024 \
	        -malloc_limit_mb=0 -print_final_stats=1 || exit 1; \
	done
	$(RUN) -m pytest tests/fuzz --hypothesis-profile=fuzz --timeout=0

clean: ## remove all that was made here, .venv too
	rm -rf $(VENV) build dist
	find . \( -name __pycache__ -o -name .hypothesis -o -name '.*_cache' \) -type d -prune -exec rm -rf {} +

# ---- set-up: .made (an environment) -> .group-NAME (a group of pyproject.toml) -> .core (rtamt itself)

$(VENV)/.made: tools/make-venv
	tools/make-venv "$(PYTHON)" $(VENV)
	@touch $@

$(VENV)/.group-%: pyproject.toml $(VENV)/.made
	$(RUN) -m pip install --quiet --group $*
	@touch $@

# What readers and adapters need is tested as users install it: with the extras. Installed already, rtamt
# itself is left as it is.
EXTRAS := data,falsify,plot,report,ros,cli,completion,units,spark,ray,kafka,metrics,remote,analysis,play,notebook,lsp,learning,telemetry,mlflow
$(VENV)/.group-test: $(VENV)/.extras
$(VENV)/.extras: $(VENV)/.core
	$(RUN) -m pip install --quiet "rtamt[$(EXTRAS)]"
	@touch $@

# Debian's packages that some tests run against; where they cannot be had, those tests are skipped and say so.
# CI skips none: there it is an error.
PACKAGES := postgresql chromium zsh fish pkg-config
# ROS 1: master, rospy, bags, and what builds the workspace in ros/.
PACKAGES += ros-core catkin rosbash python3-rosbag python3-rospkg python3-genpy ros-message-generation
PACKAGES += ros-std-msgs python3-std-msgs python3-nav-msgs python3-geometry-msgs python3-diagnostic-msgs
# The hot paths' instructions are counted.
PACKAGES += valgrind
# Octave, in which the block for Simulink runs, and what builds its gateway.
PACKAGES += octave octave-dev
# Java, in which Spark runs.
PACKAGES += openjdk-17-jre-headless
$(VENV)/.apt: Makefile tools/apt-packages $(VENV)/.made
	@tools/apt-packages $(PACKAGES) && touch $@ || { echo "The tests that need it are skipped."; [ "$$CI" != true ]; }

# Written only when it differs: an editable install knows each module by its name.
MODULES := find src -name '*.py' | sort
$(VENV)/.modules: $(VENV)/.made FORCE
	@$(MODULES) | cmp -s - $@ || $(MODULES) > $@
FORCE:

$(VENV)/.core: pyproject.toml CMakeLists.txt $(shell find core -type f) $(VENV)/.modules $(VENV)/.group-build
	$(WITH_VENV) $(RUN) -m pip install --quiet --no-build-isolation --config-settings=build-dir=build/editable --editable .
	$(RUN) -c "import rtamt.engine._core"
	@touch $@
