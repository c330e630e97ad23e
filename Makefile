# The two commands of the README for a bare Debian 12: make demo, make test. They install missing packages.
.PHONY: build demo test check nightly benchmarks bench bench-volumes bench-meshes peers peers-volumes peers-tensors \
  asan asan-all tsan tsan-all package release-check tidy format-check fuzz configure packages lint-packages \
  sanitizer-packages

build: configure
	cmake --build --preset release

# Installs and builds what a picture needs, and nothing for tests. A build folder that is there already is used as it is.
demo:
	@echo 'demo 1/4: packages of Debian'
	@cmake/install_packages.sh build run
	@echo 'demo 2/4: programs and viewer'
	@[ -e build/build.ninja ] || cmake --preset demo >build-demo.log || { cat build-demo.log; exit 1; }
	@rm -f build-demo.log
	@NINJA_STATUS='[%p] ' cmake --build --preset demo
	@cmake/demo.sh build/bin demo

# ALL=1: also the cases that otherwise run in `make nightly` alone.
# Eight at a time on two processors: the browser's and the sockets' tests wait more than they compute, and pictures count
# for two.
TEST_JOBS = $(shell expr $$(nproc) \* 4)
test: build
	$(if $(ALL),cmake --build --preset release --target nightly_tests)
	cmake/run_tests.sh release build -j$(TEST_JOBS) $(if $(ALL),,--label-exclude nightly)

# CHANGED=1: builds, and runs the tests that can see what differs from BASE (the last commit), as many as take
# CHECK_SECONDS, nearest first. Without: the check of a change, part by part.
CHECK_SECONDS = 60
check:
ifdef CHANGED
	@$(MAKE) --no-print-directory build
	cmake/affected_tests.py build --seconds $(CHECK_SECONDS) $(if $(BASE),--base $(BASE))
else
	.ci/run
endif

# Measures time and error of every drawing method and writes the results into docs/laboratory.md. SCANS: additional
# scans or models to measure. BENCH_FLAGS: further options, see `laboratory --help`.
bench: configure
	cmake --build --preset release --target laboratory
	build/bin/laboratory --docs docs $(BENCH_FLAGS) object:tests/data/lion.drc $(SCANS)

# The same for volumes and Gaussian models. GRIDS: files to measure, as PRESET:PATH, for example ct-bone:chest.nrrd.
bench-volumes: configure
	cmake --build --preset release --target volume_laboratory
	build/bin/volume_laboratory --docs docs $(BENCH_FLAGS) $(GRIDS)

# Textured meshes as surfels and as GL draws them, against ray casting, into docs/textured-models.md.
bench-meshes: configure
	cmake --build --preset release --target mesh_laboratory
	build/bin/mesh_laboratory --docs docs

# The same scenes by other programs of Debian, into docs/peers.md. PEERS_FLAGS: see bench/peers/peers.py.
peers: configure
	@cmake/install_packages.sh peers
	cmake --build --preset release --target laboratory
	/usr/bin/python3 bench/peers/peers.py build/bin/laboratory --docs docs $(PEERS_FLAGS) tests/data/lion.drc $(SCANS)

# The grids GRIDS by Surfcast and by VTK's ray casters, into docs/peers.md.
peers-volumes: configure
	@cmake/install_packages.sh peers
	cmake --build --preset release --target volume_laboratory
	/usr/bin/python3 bench/peers/volumes.py build/bin/volume_laboratory --docs docs $(PEERS_FLAGS) $(GRIDS)

# The tensor fields FIELDS by Surfcast and by vtkTensorGlyph, into docs/peers.md.
peers-tensors: configure
	@cmake/install_packages.sh peers
	cmake --build --preset release --target glyph_bench
	/usr/bin/python3 bench/peers/glyphs.py build/bin/glyph_bench --docs docs $(PEERS_FLAGS) $(FIELDS)

# The address and undefined behaviour sanitizers. BASE=REVISION: the tests that read bytes of strangers and can see what
# differs from it. Without BASE: those that read damaged files and messages. asan-all: all unit tests and the numerics
# tests that are not slow. clang compiles them in about two thirds of the time of GCC.
# Its runtime takes some thread-local blocks for those of glibc 2.19 and crashes in the search for leaks
# (github.com/google/sanitizers/issues/1322). The preset therefore sets intercept_tls_get_addr=0.
SEEN = $(if $(BASE),--base $(BASE))
asan: sanitizer-packages
	cmake/sanitize.sh asan-ubsan $(if $(BASE),input_tests 'bytes|hostile' $(SEEN),hostile_tests hostile)

asan-all: sanitizer-packages
	cmake/sanitize.sh asan-ubsan sanitized_tests '^unit|^gl-numerics|hostile' --nightly

# The tests that are about threads, under the thread sanitizer. BASE=REVISION: those that can see what differs from it.
# tsan-all: also those that use sockets.
tsan: sanitizer-packages
	cmake/sanitize.sh tsan thread_tests threads $(SEEN)

tsan-all: sanitizer-packages
	cmake/sanitize.sh tsan concurrent_tests 'threads|sockets' --nightly

sanitizer-packages: packages
	@cmake/install_packages.sh sanitize

# Everything: what .ci/run leaves out, and the whole suite 20 times under load. Takes a night.
nightly:
	cmake/nightly.sh

# libFuzzer on everything that reads bytes of strangers, so many seconds for each target.
FUZZ_SECONDS = 60
fuzz: packages
	@cmake/install_packages.sh sanitize
	cmake --preset fuzz
	cmake --build --preset fuzz
	tests/fuzz/run.sh build-fuzz $(FUZZ_SECONDS)

# Debian packages in build-package/: surfcast-server, surfcast-client, surfcast-view, python3-surfcast.
package:
	@cmake/install_packages.sh build window python package
	cmake --preset package
	cmake --build --preset package
	cpack --preset package

# What users will meet: the version and the tag, the packages on a bare Debian 12, and the container image. Parts of it:
# see the beginning of the script.
release-check:
	cmake/release_check.sh

# clang-tidy. Files without findings are not checked again until they change. TIDY_FLAGS="--minutes 8" limits its time.
tidy: build lint-packages
	cmake/tidy.py build $(TIDY_FLAGS)

format-check: lint-packages
	git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror

# Every benchmark and laboratory.
benchmarks: configure
	cmake --build --preset release --target bench/all

# An editor finds the compile commands of all sources in compile_commands.json.
configure: packages
	cmake --preset release
	@! command -v python3 >/dev/null || cmake/compile_commands.py build

packages:
	@cmake/install_packages.sh build window python run test

lint-packages:
	@cmake/install_packages.sh lint
