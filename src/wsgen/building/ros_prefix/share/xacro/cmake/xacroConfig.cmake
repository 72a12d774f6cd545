# The commands that ROS's package xacro offers to CMakeLists.txt, for builds without ROS.
#
# They take the arguments that https://github.com/ros/xacro documents for ROS 2 and ROS 1, and run
# the xacro that wsgen depends on. INORDER and LEGACY have no effect since ROS 2 and are accepted.

set(xacro_PROGRAM "${CMAKE_CURRENT_LIST_DIR}/../../../bin/xacro")
set(xacro_VERSION 2)

# xacro_add_xacro_file(<input> [<output>] [REMAP <name:=value>...] [DEPENDS <file>...]
#                      [OUTPUT <variable>])
#
# Expand the file when a target asks for the output. Its absolute path is returned in XACRO_OUTPUT_FILE
# or the variable; a relative one is in the build folder. Without output it is the input without .xacro.
function(xacro_add_xacro_file input)
  cmake_parse_arguments(given "INORDER;LEGACY" "OUTPUT" "REMAP;DEPENDS" ${ARGN})
  if(given_UNPARSED_ARGUMENTS)
    list(GET given_UNPARSED_ARGUMENTS 0 output)
  elseif(input MATCHES "^(.+)[.]xacro$")
    set(output "${CMAKE_MATCH_1}")
  else()
    message(FATAL_ERROR "xacro_add_xacro_file(${input}) names no output, and the input does not end in .xacro")
  endif()
  get_filename_component(output "${output}" ABSOLUTE BASE_DIR "${CMAKE_CURRENT_BINARY_DIR}")

  # A mistake in the file is reported when it is expanded.
  execute_process(
    COMMAND "${xacro_PROGRAM}" --deps "${input}" ${given_REMAP}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    OUTPUT_VARIABLE included
    ERROR_QUIET)
  separate_arguments(included)
  add_custom_command(
    OUTPUT "${output}"
    COMMAND "${xacro_PROGRAM}" -o "${output}" "${input}" ${given_REMAP}
    DEPENDS "${input}" ${included} ${given_DEPENDS}
    WORKING_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}"
    COMMENT "xacro: ${input}"
    VERBATIM)

  if(NOT given_OUTPUT)
    set(given_OUTPUT XACRO_OUTPUT_FILE)
  endif()
  set(${given_OUTPUT} "${output}" PARENT_SCOPE)
endfunction()

# xacro_install(<target> <output>... [DESTINATION <folder>])
#
# Install expanded files into the folder of the share folder. The target is not used in ROS 2.
function(xacro_install target)
  cmake_parse_arguments(given "" "DESTINATION" "" ${ARGN})
  install(FILES ${given_UNPARSED_ARGUMENTS} DESTINATION "share/${PROJECT_NAME}/${given_DESTINATION}")
endfunction()

# xacro_add_files(<input>... [REMAP <name:=value>...] [DEPENDS <file>...] [OUTPUT <file>]
#                 [TARGET <name>] [INSTALL [DESTINATION <folder>]])
#
# Expand the files in every build, by a target <project>_<name>, and install them if asked to.
function(xacro_add_files)
  cmake_parse_arguments(
    given "INORDER;LEGACY;INSTALL" "OUTPUT;TARGET;DESTINATION" "REMAP;DEPENDS" ${ARGN})
  if(given_INSTALL AND NOT given_TARGET)
    set(given_TARGET _xacro_auto_generate)
  endif()
  set(outputs)
  foreach(input ${given_UNPARSED_ARGUMENTS})
    xacro_add_xacro_file(
      "${input}" ${given_OUTPUT} REMAP ${given_REMAP} DEPENDS ${given_DEPENDS} OUTPUT output)
    list(APPEND outputs "${output}")
    set(XACRO_OUTPUT_FILE "${output}" PARENT_SCOPE)
  endforeach()
  if(outputs)
    add_custom_target(${PROJECT_NAME}_${given_TARGET} ALL DEPENDS ${outputs})
    if(given_INSTALL)
      xacro_install(${given_TARGET} ${outputs} DESTINATION "${given_DESTINATION}")
    endif()
  endif()
endfunction()
