.PHONY: build test

build:
	cmake --preset release
	cmake --build build

test: build
	ctest --test-dir build --output-on-failure -j2
