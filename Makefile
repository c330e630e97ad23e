# The two commands of the README, on a bare Debian 12: make demo, make test. They install what is missing.
.PHONY: build demo test bench asan tidy format-check configure packages lint-packages

build: configure
	cmake --build --preset release

demo: configure
	cmake --build --preset release --target surfcastd surfcast viewer
	cmake/demo.sh build/bin demo

test: build
	ctest --preset release -j2

# Time against error of every way to draw, written into docs/laboratory.md. SCANS are more scans or models to measure,
# BENCH_FLAGS what `laboratory --help` lists.
bench: configure
	cmake --build --preset release --target laboratory
	build/bin/laboratory --docs docs $(BENCH_FLAGS) tests/data/lion.drc $(SCANS)

# The tests of the modules that need no GL and little time, and the hard cases of numerics, under the address and
# undefined behaviour sanitizers. They alone are built: a sanitizer doubles what compiling takes.
asan: packages
	cmake --preset asan-ubsan
	cmake --build --preset asan-ubsan
	ctest --preset asan-ubsan -j2 --label-exclude 'gl|slow|programs|web' --exclude-regex _NOT_BUILT
	ctest --preset asan-ubsan -j2 --label-regex numerics --label-exclude slow

tidy: build lint-packages
	run-clang-tidy -quiet -p build '^$(CURDIR)/(server|client|protocol|tests|bench)/'

format-check: lint-packages
	git ls-files '*.h' '*.cpp' | xargs clang-format --dry-run --Werror

configure: packages
	cmake --preset release

packages:
	@cmake/install_packages.sh build run test

lint-packages:
	@cmake/install_packages.sh lint
