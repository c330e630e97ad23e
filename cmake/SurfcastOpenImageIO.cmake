# OpenImageIO::OpenImageIO by way of pkg-config: Debian 12's package for CMake names programs, Python modules and an
# include folder of OpenCV without depending on them, and CMake refuses targets whose files do not exist.
find_package(PkgConfig REQUIRED)
if(NOT TARGET OpenImageIO::OpenImageIO)
  pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET OpenImageIO)
  add_library(OpenImageIO::OpenImageIO INTERFACE IMPORTED)
  target_link_libraries(OpenImageIO::OpenImageIO INTERFACE PkgConfig::OpenImageIO)
endif()
