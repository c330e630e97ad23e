# Puts the sources of the wheel together in PACKAGE: those of SOURCE, the messages of SCHEMA by PROTOC, the plain options of
# pictures in OPTIONS, and what was configured in CONFIGURED.
file(REMOVE_RECURSE ${PACKAGE})
file(COPY ${SOURCE}/surfcast DESTINATION ${PACKAGE} PATTERN __pycache__ EXCLUDE)
file(COPY ${SOURCE}/README.md ${CONFIGURED}/pyproject.toml ${LICENSE} DESTINATION ${PACKAGE})
configure_file(${OPTIONS} ${PACKAGE}/surfcast/_plain_options.py COPYONLY)
file(COPY ${CONFIGURED}/_build.py DESTINATION ${PACKAGE}/surfcast)
get_filename_component(schemas ${SCHEMA} DIRECTORY)
execute_process(COMMAND ${PROTOC} --proto_path=${schemas} --python_out=${PACKAGE}/surfcast/_wire
    --pyi_out=${PACKAGE}/surfcast/_wire ${SCHEMA}
  COMMAND_ERROR_IS_FATAL ANY)
