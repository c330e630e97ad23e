# Finds OpenImageIO::OpenImageIO with pkg-config. The CMake package in Debian 12 refers to programs, Python modules and
# an include folder of OpenCV that it does not depend on, and CMake rejects targets whose files do not exist.
find_package(PkgConfig REQUIRED)
if(NOT TARGET OpenImageIO::OpenImageIO)
  pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)
  add_library(OpenImageIO::OpenImageIO INTERFACE IMPORTED)
  target_link_libraries(OpenImageIO::OpenImageIO INTERFACE PkgConfig::OpenImageIO)
endif()
