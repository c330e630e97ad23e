# The two commands of the README for a bare Debian 12: make demo, make test. They install missing packages.
.PHONY: build demo test bench bench-volumes bench-meshes peers peers-volumes peers-tensors asan tsan package \
  release-check tidy format-check configure packages lint-packages fuzz

build: configure
	cmake --build --preset release

demo: configure
	cmake --build --preset release --target surfcastd surfcast viewer
	cmake/demo.sh build/bin demo

test: build
	ctest --preset release -j2

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

# Runs the fast tests without GL, the tests of damaged input and the fast numerics tests with the address and undefined
# behaviour sanitizers. Builds only these tests, because sanitizers double the compile time. clang compiles them in
# about two thirds of the time of GCC.
# Its runtime takes some thread-local blocks for those of glibc 2.19 and crashes in the search for leaks
# (github.com/google/sanitizers/issues/1322). The preset therefore sets intercept_tls_get_addr=0.
asan: packages
	@cmake/install_packages.sh sanitize
	cmake --preset asan-ubsan
	cmake --build --preset asan-ubsan
	ctest --preset asan-ubsan -j2 --label-exclude 'gl|slow|programs|web' --exclude-regex _NOT_BUILT
	ctest --preset asan-ubsan -j2 --label-regex hostile
	ctest --preset asan-ubsan -j2 --label-regex numerics --label-exclude slow

# The tests of the modules that use several threads, under the thread sanitizer. The runtime of GCC 12 fails on kernels
# that randomize more than 28 bits of addresses, so randomization is switched off where the system allows that.
FIXED_ADDRESSES = $(shell setarch --addr-no-randomize true 2>/dev/null && echo setarch --addr-no-randomize)
tsan: packages
	cmake --preset tsan
	$(FIXED_ADDRESSES) cmake --build --preset tsan
	$(FIXED_ADDRESSES) ctest --preset tsan -j2 --label-regex threads --exclude-regex _NOT_BUILT

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

configure: packages
	cmake --preset release

packages:
	@cmake/install_packages.sh build window python run test

lint-packages:
	@cmake/install_packages.sh lint
