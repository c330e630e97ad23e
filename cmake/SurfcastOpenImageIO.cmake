# OpenImageIO::OpenImageIO, usable. Debian 12's package names an include folder of OpenCV without depending on it, and
# CMake refuses targets with folders that do not exist.
find_package(OpenImageIO REQUIRED)
get_target_property(folders OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER folders EXCLUDE REGEX "opencv")
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${folders}")
