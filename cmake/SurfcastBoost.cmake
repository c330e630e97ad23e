# surfcast_boost: Asio and Beast, compiled once for all who speak TCP, HTTP or WebSocket. Their templates alone are left
# to those who include them. Boost itself is a package of headers.
find_package(Boost 1.81 CONFIG REQUIRED)

add_library(surfcast_boost STATIC ${CMAKE_CURRENT_LIST_DIR}/boost_asio.cpp ${CMAKE_CURRENT_LIST_DIR}/boost_beast.cpp)
target_compile_definitions(surfcast_boost PUBLIC
  BOOST_ASIO_NO_DEPRECATED BOOST_ASIO_SEPARATE_COMPILATION BOOST_BEAST_SEPARATE_COMPILATION)
# The thin client is to carry only what it calls of it.
target_compile_options(surfcast_boost PRIVATE ${SURFCAST_IO_BOUND_OPTIONS} -ffunction-sections -fdata-sections)
target_link_options(surfcast_boost INTERFACE LINKER:--gc-sections)
target_link_libraries(surfcast_boost PUBLIC Boost::headers Threads::Threads)
