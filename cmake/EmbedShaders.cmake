# surfcast_embed_shaders(TARGET): embeds every file of shaders/ into TARGET as text, so that a program does not need
# separate shader files. Defines surfcast::render::embedded_shaders() (see render/shader_library.cpp).
#
# As a script, with FOLDER and OUTPUT: writes that source. The build runs it, so that it knows which programs are made of
# a shader.
if(CMAKE_SCRIPT_MODE_FILE)
  file(GLOB_RECURSE files RELATIVE ${FOLDER} ${FOLDER}/*)
  set(text "#include \"render/embedded_shaders.h\"\n\nnamespace surfcast::render {\n\n")
  string(APPEND text "std::span<const EmbeddedShader> embedded_shaders() {\n")
  # Literals of this kind know their length: it is not counted while compiling, which has a limit of steps.
  string(APPEND text "  using namespace std::string_view_literals;\n")
  string(APPEND text "  static constexpr EmbeddedShader kShaders[] = {\n")
  foreach(file ${files})
    file(READ ${FOLDER}/${file} content)
    string(APPEND text "      {\"${file}\", R\"GLSL(${content})GLSL\"sv},\n")
  endforeach()
  string(APPEND text "  };\n  return kShaders;\n}\n\n}  // namespace surfcast::render\n")
  file(WRITE ${OUTPUT} "${text}")
  return()
endif()

set(surfcast_embed_shaders_script ${CMAKE_CURRENT_LIST_FILE})
function(surfcast_embed_shaders target)
  set(folder ${PROJECT_SOURCE_DIR}/shaders)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${folder}/*)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/embedded_shaders.cpp)
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${folder} -DOUTPUT=${output} -P ${surfcast_embed_shaders_script}
    DEPENDS ${files} ${surfcast_embed_shaders_script}
    COMMENT "Embedding the shaders" VERBATIM)
  target_sources(${target} PRIVATE ${output})
  set_source_files_properties(${output} PROPERTIES SURFCAST_COMPILE_ALONE ON)
endfunction()
