# `make package`: four Debian packages, one for each component.
set(SURFCAST_MAINTAINER "The Surfcast authors <authors@surfcast.example>" CACHE STRING
  "Whom the packages name as their maintainer")
set(packaging ${PROJECT_SOURCE_DIR}/cmake/packaging/debian)
set(documents ${PROJECT_BINARY_DIR}/packaging)

file(READ ${PROJECT_SOURCE_DIR}/LICENSE SURFCAST_LICENSE)
configure_file(${packaging}/copyright.in ${documents}/copyright @ONLY)
configure_file(${packaging}/changelog.in ${documents}/changelog @ONLY)
execute_process(COMMAND ${GZIP_PROGRAM} -9 -n -f -k ${documents}/changelog COMMAND_ERROR_IS_FATAL ANY)

set(components server client)
if(SURFCAST_WINDOW)
  list(APPEND components view)
endif()
list(APPEND components ${surfcast_python_component})
foreach(component IN LISTS components)
  set(folder ${CMAKE_INSTALL_DATADIR}/doc/surfcast-${component})
  if(component STREQUAL "python")
    set(folder ${CMAKE_INSTALL_DATADIR}/doc/python3-surfcast)
  endif()
  install(FILES ${documents}/changelog.gz DESTINATION ${folder} COMPONENT ${component})
  if(component STREQUAL "server") # it contains the viewer, which includes third-party code
    install(FILES ${documents}/copyright DESTINATION ${folder} COMPONENT ${component})
  else()
    install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright DESTINATION ${folder} COMPONENT ${component})
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME surfcast)
set(CPACK_PACKAGE_VENDOR "The Surfcast authors")
set(CPACK_PACKAGE_CONTACT "${SURFCAST_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME surfcast-server)
set(CPACK_COMPONENT_SERVER_DESCRIPTION "server that draws large point scans
Builds models of scans, draws them without a display on OpenGL 4.5, and sends
the pictures to browsers and thin clients. Without a GPU it draws in software.")
# Libraries that the program loads by name at run time. Mesa's software driver is required, so pictures can be drawn on
# every machine; NVIDIA's driver is used as well if it is installed.
set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS "libegl1, libopengl0, libegl-mesa0, libgl1-mesa-dri, ca-certificates")
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS surfcast-client)
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA
  ${packaging}/conffiles ${packaging}/postinst ${packaging}/prerm ${packaging}/postrm)

set(CPACK_DEBIAN_CLIENT_PACKAGE_NAME surfcast-client)
set(CPACK_COMPONENT_CLIENT_DESCRIPTION "thin client of the Surfcast server
Fetches pictures of large point scans from a server that draws them, picks
points in them, and measures the connection.")
set(CPACK_DEBIAN_CLIENT_PACKAGE_SUGGESTS surfcast-view)

set(CPACK_DEBIAN_VIEW_PACKAGE_NAME surfcast-view)
set(CPACK_COMPONENT_VIEW_DESCRIPTION "window onto the models of a Surfcast server
Moves through large point scans that a server draws. It is started by
`surfcast view`.")
set(CPACK_DEBIAN_VIEW_PACKAGE_RECOMMENDS surfcast-client)

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-surfcast)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Python client of the Surfcast server
Fetches pictures, views, picks and profiles of large point scans as arrays of
numpy, shows them in notebooks, and compares pictures in tests.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy, python3-protobuf")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS python3-pil)
# They compile the modules, because users may not write beside them.
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${packaging}/python/postinst ${packaging}/python/prerm)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-websockets, python3-pytest, python3-ipykernel")

# Executed by cpack.
set(SURFCAST_VIEWER_PAGE ${surfcast_viewer_page})
configure_file(${PROJECT_SOURCE_DIR}/cmake/check_package.cmake.in ${documents}/check_package.cmake @ONLY)
set(CPACK_PROJECT_CONFIG_FILE ${documents}/check_package.cmake)
include(CPack)
