# cmake -D NPM=.. -D SOURCE=.. -D SCHEMA=.. -D OPTIONS=.. -D BINARY=.. -D REQUIRED=0|1 -P build_viewer.cmake: brings
# BINARY/dist up to date. Where npm's registry cannot be reached there is no viewer: an error if it is REQUIRED, as in a package; else
# a warning, and the next build tries again. Errors in the viewer's own code are errors in any case.
cmake_minimum_required(VERSION 3.25)
set(installed ${BINARY}/installed)
set(page ${BINARY}/dist/index.html)

function(install_packages)
  file(REMOVE ${installed})
  message(NOTICE "Installing what the viewer is built with")
  execute_process(
    COMMAND ${NPM} ci --no-audit --no-fund --loglevel=error --fetch-retries=1
    WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE errors)
  if(failed)
    string(REGEX MATCH "npm (error|ERR!)( code)? [^\n]*" reason "${errors}")
    if(REQUIRED)
      message(FATAL_ERROR "the viewer is not built: `npm ci` failed (${reason}); "
        "without the viewer: cmake -D SURFCAST_VIEWER=OFF")
    endif()
    message(NOTICE "warning: the viewer is not built: `npm ci` failed (${reason}); "
      "run `cmake --build build --target viewer` again once npm's registry is reachable")
    return()
  endif()
  file(TOUCH ${installed})
endfunction()

function(build_page)
  message(NOTICE "Building the viewer")
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E env SURFCAST_VIEWER_OUT=${BINARY}/dist SURFCAST_PLAIN_OPTIONS=${OPTIONS}
      ${NPM} run --silent build
    WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failed)
    file(REMOVE ${page})
    message(FATAL_ERROR "${output}")
  endif()
endfunction()

if(NOT EXISTS ${installed} OR NOT EXISTS ${SOURCE}/node_modules OR ${SOURCE}/package-lock.json IS_NEWER_THAN ${installed})
  install_packages()
endif()
if(NOT EXISTS ${installed})
  return()
endif()

file(GLOB_RECURSE inputs ${SOURCE}/src/* ${SOURCE}/public/*)
list(FILTER inputs EXCLUDE REGEX /generated/)
list(APPEND inputs ${installed} ${SCHEMA} ${OPTIONS} ${SOURCE}/index.html ${SOURCE}/tsconfig.json ${SOURCE}/vite.config.ts)
foreach(input IN LISTS inputs)
  if(NOT EXISTS ${page} OR ${input} IS_NEWER_THAN ${page})
    build_page()
    break()
  endif()
endforeach()
