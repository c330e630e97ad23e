# Build settings and helper functions of the project.

option(SURFCAST_TESTS "Build the tests" ON)
option(SURFCAST_BENCH "Define the benchmarks, which the target `benchmarks` builds" ON)
option(SURFCAST_WINDOW "Build surfcast-view, which needs SDL" ON)
set(SURFCAST_VIEWER AUTO CACHE STRING
  "The viewer for browsers: ON (fails without it), AUTO (warns where npm cannot build it), OFF")
set_property(CACHE SURFCAST_VIEWER PROPERTY STRINGS ON AUTO OFF)
set(SURFCAST_PYTHON AUTO CACHE STRING
  "The wheel of the Python client: ON (fails without it), AUTO (where its tools are installed), OFF")
set_property(CACHE SURFCAST_PYTHON PROPERTY STRINGS ON AUTO OFF)
set(SURFCAST_SANITIZE "" CACHE STRING "Sanitizers to build with, as the compiler names them (address,undefined)")
option(SURFCAST_FUZZ "Build the targets of libFuzzer, which needs clang" OFF)
option(SURFCAST_PCH "Precompile the headers that most sources include" OFF)
option(SURFCAST_JOIN "Compile several sources of a target together" OFF)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# For the cache, paths below the checkout are relative to the build folder, so that all checkouts of a machine share it.
# CCACHE_DEPEND: it learns from the compiler which headers a source includes. Otherwise it preprocesses each source before
# it is compiled, which takes a tenth of the time.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(ccache_settings CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_PCH_EXTSUM=1 CCACHE_DEPEND=1)
  if(SURFCAST_PCH)
    # What ccache asks for before it caches compilations with precompiled headers.
    list(APPEND ccache_settings CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime)
    add_compile_options(-fpch-preprocess)
    # As with GCC: clang finds the precompiled header beside the header. CMake's own options have a path that ccache does
    # not make relative.
    set(CMAKE_CXX_COMPILE_OPTIONS_USE_PCH -include <PCH_HEADER>)
  endif()
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env ${ccache_settings} ${CCACHE_PROGRAM})
endif()

# mold links all programs in a quarter of the time of GNU ld. Modules are left to the latter: mold also takes members of
# archives that they do not need, which are not position-independent.
find_program(MOLD_PROGRAM mold)
if(MOLD_PROGRAM AND NOT SURFCAST_SANITIZE)
  string(APPEND CMAKE_EXE_LINKER_FLAGS " -fuse-ld=mold")
endif()

find_package(Threads REQUIRED)

# Warnings are errors in the project's code. Generated and third-party code does not link this target.
add_library(surfcast_warnings INTERFACE)
target_compile_options(surfcast_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor
  -Woverloaded-virtual -Wnull-dereference -Wimplicit-fallthrough -Werror)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports these inside inlined code of the standard library and of Asio that is correct.
  target_compile_options(surfcast_warnings INTERFACE -Wno-null-dereference -Wno-maybe-uninitialized
    -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread -Wno-mismatched-new-delete)
else()
  # Conditions without a branch are meant.
  target_compile_options(surfcast_warnings INTERFACE -Wno-bitwise-instead-of-logical)
endif()

if(SURFCAST_SANITIZE)
  add_compile_options(-fsanitize=${SURFCAST_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${SURFCAST_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND SURFCAST_SANITIZE MATCHES "undefined")
    # clang 14 cannot compile coroutines with this check (github.com/llvm/llvm-project/issues/49689). GCC does not have
    # it.
    add_compile_options(-fno-sanitize=function)
  endif()
  if(SURFCAST_SANITIZE MATCHES "thread")
    # The sanitizer does not support fences. Asio also passes work between threads under a mutex, so it needs none.
    add_compile_definitions(BOOST_ASIO_DISABLE_FENCED_BLOCK)
  endif()
endif()

# surfcast_precompiled_headers(NAME HEADERS header... [LIBS lib...] [OPTIONS option...]) precompiles headers once, if
# SURFCAST_PCH is on, for targets that are compiled with the same options. surfcast_use_precompiled_headers(TARGET NAME)
# uses them. clang-tidy does without: there, a source that lacks an include fails.
function(surfcast_precompiled_headers name)
  if(NOT SURFCAST_PCH)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "HEADERS;LIBS;OPTIONS" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "")
  add_library(${name} OBJECT ${source})
  target_link_libraries(${name} PRIVATE surfcast_warnings ${ARG_LIBS})
  target_compile_options(${name} PRIVATE ${ARG_OPTIONS})
  target_precompile_headers(${name} PRIVATE ${ARG_HEADERS})
  if(CCACHE_PROGRAM)
    set_target_properties(${name} PROPERTIES CXX_COMPILER_LAUNCHER
      "${CMAKE_COMMAND};-E;env;${ccache_settings};${PROJECT_SOURCE_DIR}/cmake/precompile.sh;${CCACHE_PROGRAM}")
  endif()
endfunction()

function(surfcast_use_precompiled_headers target name)
  if(SURFCAST_PCH)
    target_precompile_headers(${target} REUSE_FROM ${name})
  endif()
endfunction()

set(SURFCAST_COMMON_HEADERS
  <algorithm> <array> <atomic> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <map> <memory>
  <mutex> <optional> <span> <sstream> <string> <thread> <vector> <glm/glm.hpp> <tl/expected.hpp>)
surfcast_precompiled_headers(surfcast_module_headers HEADERS ${SURFCAST_COMMON_HEADERS})

# Sanitized builds do not optimize, which halves their compile time, but for modules that compute for most of the time
# of the tests that read bytes of strangers.
if(SURFCAST_SANITIZE)
  surfcast_precompiled_headers(surfcast_computing_module_headers HEADERS ${SURFCAST_COMMON_HEADERS} OPTIONS -O1)
endif()
function(surfcast_computing target)
  if(SURFCAST_SANITIZE)
    target_compile_options(${target} PRIVATE -O1)
    surfcast_use_precompiled_headers(${target} surfcast_computing_module_headers)
  else()
    surfcast_use_precompiled_headers(${target} surfcast_module_headers)
  endif()
endfunction()

# surfcast_io_bound(TARGET): TARGET waits for the network or for other threads rather than computes. -O1 compiles sources
# that instantiate Beast in two thirds of the time of -O3. Debug builds do not optimize it: with the sanitizers that
# halves the compile time.
set(SURFCAST_IO_BOUND_OPTIONS $<$<CONFIG:Debug>:-O0> $<$<CONFIG:Release>:-O1>)
surfcast_precompiled_headers(surfcast_io_bound_headers
  HEADERS ${SURFCAST_COMMON_HEADERS} OPTIONS ${SURFCAST_IO_BOUND_OPTIONS})
function(surfcast_io_bound target)
  target_compile_options(${target} PRIVATE ${SURFCAST_IO_BOUND_OPTIONS})
  surfcast_use_precompiled_headers(${target} surfcast_io_bound_headers)
endfunction()

# surfcast_commands(TARGET): TARGET reads options by CLI11 and calls what they ask for. It runs once, so that less
# optimization saves more compile time than it costs.
find_package(CLI11 REQUIRED)
find_package(nlohmann_json REQUIRED)
set(SURFCAST_COMMAND_OPTIONS $<$<CONFIG:Debug>:-O0> $<$<CONFIG:Release>:-O1>)
surfcast_precompiled_headers(surfcast_command_headers
  HEADERS ${SURFCAST_COMMON_HEADERS} <CLI/CLI.hpp> <nlohmann/json.hpp>
  LIBS CLI11::CLI11 nlohmann_json::nlohmann_json
  OPTIONS ${SURFCAST_COMMAND_OPTIONS})
function(surfcast_commands target)
  target_compile_options(${target} PRIVATE ${SURFCAST_COMMAND_OPTIONS})
  surfcast_use_precompiled_headers(${target} surfcast_command_headers)
endfunction()

# surfcast_headers(TARGET PUBLIC|INTERFACE NAME FOLDER)
# Lets TARGET and the targets that link it include the headers of FOLDER as "NAME/header.h", but no folders next to
# FOLDER: the include path is a folder of the build tree that contains only a link to FOLDER. A target therefore sees
# only the headers of the libraries that it links, and an include that docs/architecture.md does not allow fails to
# compile.
function(surfcast_headers target scope name folder)
  set(path ${CMAKE_BINARY_DIR}/include/${name})
  file(MAKE_DIRECTORY ${path})
  file(CREATE_LINK ${folder} ${path}/${name} SYMBOLIC)
  target_include_directories(${target} ${scope} ${path})
endfunction()

# surfcast_join_sources(TARGET): compiles several sources of TARGET together, if SURFCAST_JOIN is on. This halves the
# compile time, because each header is read and each template instantiated once for all of them. The presets release,
# asan-ubsan and tsan do so. The preset dev does not: in it, a change of one source compiles one source. Names in unnamed
# namespaces are therefore unique in a target.
# CMake's own UNITY_BUILD writes absolute paths, by which a compiler cache takes each checkout for another program.
function(surfcast_join_sources target)
  if(SURFCAST_JOIN)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # It takes the unnamed namespaces of joined sources for those of headers.
      target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
    endif()
    # Deferred to the end of the folder, where the properties of all its sources are known.
    cmake_language(EVAL CODE "cmake_language(DEFER CALL surfcast_join_sources_now ${target})")
  endif()
endfunction()

# Replaces the sources of TARGET by files that include up to SURFCAST_JOINED_SOURCES of them each, but for sources with
# definitions or the property SURFCAST_COMPILE_ALONE, such as generated ones.
set(SURFCAST_JOINED_SOURCES 32 CACHE STRING "The most sources of a target that are compiled together")
function(surfcast_join_sources_now target)
  get_target_property(sources ${target} SOURCES)
  set(joined)
  set(kept)
  foreach(source IN LISTS sources)
    get_source_file_property(alone ${source} SURFCAST_COMPILE_ALONE)
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    if(alone OR definitions OR NOT source MATCHES "\\.cpp$")
      list(APPEND kept ${source})
    else()
      list(APPEND joined ${source})
    endif()
  endforeach()

  # Parts of equal size, so that the last one is not short.
  list(LENGTH joined count)
  math(EXPR parts "(${count} + ${SURFCAST_JOINED_SOURCES} - 1) / ${SURFCAST_JOINED_SOURCES}")
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/${target}_joined)
  foreach(part RANGE 1 ${parts})
    if(parts EQUAL 0)
      break()
    endif()
    math(EXPR begin "${count} * (${part} - 1) / ${parts}")
    math(EXPR length "${count} * ${part} / ${parts} - ${begin}")
    list(SUBLIST joined ${begin} ${length} members)
    set(text)
    foreach(source IN LISTS members)
      cmake_path(ABSOLUTE_PATH source NORMALIZE)
      cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${folder})
      string(APPEND text "#include \"${source}\"\n")
    endforeach()
    file(CONFIGURE OUTPUT ${folder}/part_${part}.cpp CONTENT "${text}" @ONLY)
    list(APPEND kept ${folder}/part_${part}.cpp)
  endforeach()
  set_property(TARGET ${target} PROPERTY SOURCES ${kept})
endfunction()

# surfcast_module(NAME [COMPUTES|IO_BOUND|COMMANDS] [SOURCES file...] [PUBLIC lib...] [PRIVATE lib...])
# Each folder of server/ is one static library `surfcast_NAME` with the namespace surfcast::NAME, included as
# "NAME/header.h". Without sources it is a header-only library. COMPUTES, IO_BOUND, COMMANDS: see surfcast_computing,
# surfcast_io_bound and surfcast_commands.
function(surfcast_module name)
  cmake_parse_arguments(ARG "COMPUTES;IO_BOUND;COMMANDS" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  if(ARG_SOURCES)
    add_library(surfcast_${name} STATIC ${ARG_SOURCES})
    surfcast_headers(surfcast_${name} PUBLIC ${name} ${CMAKE_CURRENT_SOURCE_DIR})
    target_link_libraries(surfcast_${name} PUBLIC ${ARG_PUBLIC} PRIVATE surfcast_warnings ${ARG_PRIVATE})
    if(ARG_COMPUTES)
      surfcast_computing(surfcast_${name})
    elseif(ARG_IO_BOUND)
      surfcast_io_bound(surfcast_${name})
    elseif(ARG_COMMANDS)
      surfcast_commands(surfcast_${name})
    else()
      surfcast_use_precompiled_headers(surfcast_${name} surfcast_module_headers)
    endif()
    surfcast_join_sources(surfcast_${name})
  else()
    add_library(surfcast_${name} INTERFACE)
    surfcast_headers(surfcast_${name} INTERFACE ${name} ${CMAKE_CURRENT_SOURCE_DIR})
    target_link_libraries(surfcast_${name} INTERFACE ${ARG_PUBLIC})
  endif()
endfunction()

# The buffer layouts and constants that C++ and GLSL share.
add_library(surfcast_shared INTERFACE)
surfcast_headers(surfcast_shared INTERFACE shared ${PROJECT_SOURCE_DIR}/shaders/shared)
find_package(glm REQUIRED)
target_link_libraries(surfcast_shared INTERFACE glm::glm)

# surfcast_test_paths(TEST NAME...): the programs that the test starts, as targets, and the files and folders that it
# reads, relative to the checkout. path_of (tests/support/path_of.h) gives their paths by these names. A small source
# has them, and no other, so that a compiler cache can share all others between checkouts.
function(surfcast_test_paths test)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${test}_paths.cpp)
  set(cases)
  set(number 0)
  foreach(name IN LISTS ARGN)
    math(EXPR number "${number} + 1")
    string(APPEND cases "  if (name == \"${name}\") return SURFCAST_PATH_${number};\n")
    set(path ${PROJECT_SOURCE_DIR}/${name})
    if(NOT EXISTS ${path})
      set(path $<TARGET_FILE:${name}>)
      add_dependencies(${test} ${name})
    endif()
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS SURFCAST_PATH_${number}="${path}")
  endforeach()
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT "#include \"support/path_of.h\"

#include <cstdlib>

std::string surfcast::path_of(std::string_view name) {
${cases}  std::abort();
}
")
  set_property(SOURCE ${source} PROPERTY SKIP_PRECOMPILE_HEADERS ON)  # reading them takes longer
  target_sources(${test} PRIVATE ${source})
endfunction()

# Test code runs once, so less optimization saves more compile time than it costs. Tests that compare pictures compute
# long enough to be optimized a little. The tested libraries are built with the usual optimization.
set(SURFCAST_TEST_OPTIONS -O0)
set(SURFCAST_COMPUTING_TEST_OPTIONS $<$<CONFIG:Debug>:-O0> $<$<CONFIG:Release>:-O1>)

# surfcast_test_library(NAME [SOURCES file...] [PUBLIC lib...] [PRIVATE lib...])
# What several test programs share, included as "folder/header.h" relative to tests/.
function(surfcast_test_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name}
    PUBLIC ${ARG_PUBLIC}
    PRIVATE surfcast_warnings ${ARG_PRIVATE} GTest::gtest GTest::gmock)
  target_compile_options(${name} PRIVATE ${SURFCAST_COMPUTING_TEST_OPTIONS})
  surfcast_use_precompiled_headers(${name} surfcast_computing_test_headers)
  surfcast_join_sources(${name})
endfunction()

# surfcast_test(NAME [COMPUTES] [PARTS n] [NIGHTLY pattern...] [SANITIZED_NIGHTLY pattern...] SOURCES file...
#   [LIBS lib...] [LABELS label...])
# One GoogleTest program of one module, and one test of ctest: most cases take less time than a process needs to start.
# PARTS: the cases are dealt out to n tests, NAME_1 to NAME_n, which run beside each other. For programs that take more
# than half a minute and do not draw: processes that draw compile the same shaders, each of them where none is cached.
# A label is one word with parts that ctest can select (-L gl, -LE slow): first the requirements of a test, then its
# suite, as in gl-slow-numerics.
# Suites of the sanitizers: `hostile` reads damaged files and messages, `bytes` others of strangers, and both run under
# the address sanitizer; `threads` is about threads and runs under the thread sanitizer; `sockets` uses threads beside,
# and runs under it in `make nightly`, as all unit tests do under the address sanitizer.
# COMPUTES: optimized a little, as tests with the labels gl and slow are.
# NIGHTLY: patterns of cases, as in filters of GoogleTest. These cases run in `make nightly` alone, not in `make test`:
# they are a test of their own with the suite `nightly`. Sanitizers do not run them. NIGHTLY *: all cases. The program is
# not built by default either, but by the target nightly_tests.
# SANITIZED_NIGHTLY: patterns of cases of a program with the suite `bytes` that compute rather than read bytes of
# strangers. The sanitizers run them in `make nightly` alone.
function(surfcast_test name)
  cmake_parse_arguments(ARG "COMPUTES" "PARTS" "NIGHTLY;SANITIZED_NIGHTLY;SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_PARTS)
    set(ARG_PARTS 1)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name} PRIVATE surfcast_warnings ${ARG_LIBS} GTest::gtest_main GTest::gmock)
  if(ARG_COMPUTES OR ARG_LABELS MATCHES "gl|slow")
    target_compile_options(${name} PRIVATE ${SURFCAST_COMPUTING_TEST_OPTIONS})
    surfcast_use_precompiled_headers(${name} surfcast_computing_test_headers)
  else()
    target_compile_options(${name} PRIVATE ${SURFCAST_TEST_OPTIONS})
    surfcast_use_precompiled_headers(${name} surfcast_test_headers)
  endif()
  surfcast_join_sources(${name})
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  if(ARG_NIGHTLY STREQUAL "*")
    set_property(TARGET ${name} PROPERTY EXCLUDE_FROM_ALL ON)
    add_dependencies(nightly_tests ${name})
    if(NOT SURFCAST_SANITIZE)
      surfcast_add_cases(${name} ${name} ${ARG_PARTS} "*" "${ARG_LABELS}-nightly")
    endif()
    return()
  endif()
  if(ARG_LABELS MATCHES "^unit|^gl-numerics|hostile")
    add_dependencies(sanitized_tests ${name})
  endif()
  if(ARG_LABELS MATCHES "bytes|hostile")
    add_dependencies(input_tests ${name})
  endif()
  if(ARG_LABELS MATCHES "hostile")
    add_dependencies(hostile_tests ${name})
  endif()
  if(ARG_LABELS MATCHES "threads")
    add_dependencies(thread_tests ${name})
  endif()
  if(ARG_LABELS MATCHES "threads|sockets")
    add_dependencies(concurrent_tests ${name})
  endif()
  set(nightly ${ARG_NIGHTLY})
  set(left_out ${ARG_NIGHTLY})
  if(SURFCAST_SANITIZE)
    set(nightly ${ARG_SANITIZED_NIGHTLY})
    list(APPEND left_out ${ARG_SANITIZED_NIGHTLY})
  endif()
  list(JOIN left_out : left_out)
  list(JOIN nightly : nightly)
  set(filter "*")
  if(left_out)
    set(filter "-${left_out}")
  endif()
  surfcast_add_cases(${name} ${name} ${ARG_PARTS} "${filter}" "${ARG_LABELS}")
  if(nightly)
    surfcast_add_cases(${name} ${name}_nightly 1 "${nightly}" "${ARG_LABELS}-nightly")
  endif()
endfunction()

# surfcast_await_shaders(TEST...): the tests draw, in their own process or by a server. They begin after golden_gl_test:
# the shaders that it leaves in the cache are most of those that each of them would compile beside it.
function(surfcast_await_shaders)
  set_tests_properties(${ARGN} PROPERTIES DEPENDS golden_gl_test)
endfunction()

# Adds the cases of a program that the filter of GoogleTest selects, as `parts` tests. Long tests begin first, as long as
# ctest has not measured them, so that none of them is left over at the end.
function(surfcast_add_cases program name parts filter labels)
  set(arguments)
  if(NOT filter STREQUAL "*")
    set(arguments "--gtest_filter=${filter}")
  endif()
  foreach(part RANGE 1 ${parts})
    set(test ${name})
    set(environment)
    if(parts GREATER 1)
      set(test ${name}_${part})
      math(EXPR index "${part} - 1")
      set(environment GTEST_TOTAL_SHARDS=${parts} GTEST_SHARD_INDEX=${index})
    endif()
    add_test(NAME ${test} COMMAND ${program} ${arguments})
    set(cost 20)
    if(labels MATCHES "slow")
      set(cost 60)
    elseif(labels MATCHES "gl|hostile" OR parts GREATER 1)
      set(cost 40)
    endif()
    if(labels MATCHES "gl")
      set_tests_properties(${test} PROPERTIES PROCESSORS 2)  # software GL has several threads
      if(SURFCAST_SANITIZE)
        list(APPEND environment ASAN_OPTIONS=detect_leaks=0)  # Mesa leaks a little when its driver is unloaded
      endif()
    endif()
    if(labels MATCHES "gl|programs" AND NOT program STREQUAL "golden_gl_test")
      surfcast_await_shaders(${test})
    endif()
    set_tests_properties(${test} PROPERTIES
      LABELS "${labels}" TIMEOUT 1800 COST ${cost} ENVIRONMENT "${environment}")
  endforeach()
endfunction()
