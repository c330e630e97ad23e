# Destinations of `cmake --install` and of the packages. There are four components, each of which is also a Debian
# package: server, client, view, python.
include(GNUInstallDirs)
find_program(GZIP_PROGRAM gzip REQUIRED)

# Debian separates the completions of packages from those that an administrator installs.
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(surfcast_zsh_folder ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
  set(surfcast_settings_folder ${CMAKE_INSTALL_FULL_SYSCONFDIR}/default) # /etc, not /usr/etc
  set(surfcast_models_folder ${CMAKE_INSTALL_FULL_LOCALSTATEDIR}/lib/surfcast/models)
else()
  set(surfcast_zsh_folder ${CMAKE_INSTALL_DATADIR}/zsh/site-functions)
  set(surfcast_settings_folder ${CMAKE_INSTALL_SYSCONFDIR}/default)
  set(surfcast_models_folder ${CMAKE_INSTALL_LOCALSTATEDIR}/lib/surfcast/models)
endif()

add_custom_target(program_documents ALL COMMENT "Manual pages and completions")

# surfcast_install_program(TARGET COMPONENT): installs the program, its manual page and the completions of three shells.
# The program itself prints these documents, so they are never out of date.
function(surfcast_install_program target component)
  set(folder ${PROJECT_BINARY_DIR}/documents)
  set(page ${folder}/${target}.1.gz)
  set(scripts ${folder}/${target}.bash ${folder}/${target}.zsh ${folder}/${target}.fish)
  file(MAKE_DIRECTORY ${folder})
  add_custom_command(OUTPUT ${page} ${scripts}
    COMMAND $<TARGET_FILE:${target}> --manual > ${folder}/${target}.1
    COMMAND ${GZIP_PROGRAM} -9 -n -f ${folder}/${target}.1
    COMMAND $<TARGET_FILE:${target}> --completion bash > ${folder}/${target}.bash
    COMMAND $<TARGET_FILE:${target}> --completion zsh > ${folder}/${target}.zsh
    COMMAND $<TARGET_FILE:${target}> --completion fish > ${folder}/${target}.fish
    DEPENDS ${target} COMMENT "Manual page and completions of ${target}" VERBATIM)
  add_custom_target(${target}_documents DEPENDS ${page} ${scripts})
  add_dependencies(program_documents ${target}_documents)

  install(TARGETS ${target} RUNTIME COMPONENT ${component})
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${folder}/${target}.bash RENAME ${target}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT ${component})
  install(FILES ${folder}/${target}.zsh RENAME _${target} DESTINATION ${surfcast_zsh_folder} COMPONENT ${component})
  install(FILES ${folder}/${target}.fish
    DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT ${component})
endfunction()

# surfcast_install_service(): installs the server's systemd unit, its settings, and the folder of the models that it
# serves.
function(surfcast_install_service)
  set(unit ${PROJECT_BINARY_DIR}/packaging/surfcastd.service)
  set(SURFCAST_MODELS_FOLDER ${surfcast_models_folder})
  set(SURFCAST_SETTINGS_FILE ${surfcast_settings_folder}/surfcastd)
  foreach(path SURFCAST_MODELS_FOLDER SURFCAST_SETTINGS_FILE)
    if(NOT IS_ABSOLUTE ${${path}})
      set(${path} ${CMAKE_INSTALL_PREFIX}/${${path}})
    endif()
  endforeach()
  configure_file(${PROJECT_SOURCE_DIR}/cmake/packaging/surfcastd.service.in ${unit} @ONLY)
  install(FILES ${unit} DESTINATION lib/systemd/system COMPONENT server)
  install(FILES ${PROJECT_SOURCE_DIR}/cmake/packaging/surfcastd.default RENAME surfcastd
    DESTINATION ${surfcast_settings_folder} COMPONENT server)
  install(DIRECTORY DESTINATION ${surfcast_models_folder} COMPONENT server)
endfunction()
