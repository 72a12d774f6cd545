# Generates the messages of a package for Python nodes, where no ROS is sourced: the generators are
# those of the ROS of PyPI (wsgen.ros.environment), whose CMake files name folders of the machine
# that they were built on, and packages that PyPI lacks.
#
# Variables of environment:
#   WSGEN_ROS     the prefixes of that ROS and of messages that were built for it, as a path
#   WSGEN_PYTHON  the Python that has wsgen

# Whether a package that is assumed, such as nav_msgs, finds another one, such as builtin_interfaces:
# the packages of the real one are in the ROS of PyPI, and name what they find.
function(wsgen_is_brought result package)
  get_property(bringing GLOBAL PROPERTY WSGEN_MISSING)
  string(REPLACE ":" ";" prefixes "$ENV{WSGEN_ROS}")
  set(seen ${bringing})
  while(bringing)
    list(POP_FRONT bringing one)
    foreach(prefix IN LISTS prefixes)
      set(file "${prefix}/share/${one}/cmake/ament_cmake_export_dependencies-extras.cmake")
      if(EXISTS "${file}")
        file(STRINGS "${file}" exported REGEX "^set\\(_exported_dependencies ")
        string(REGEX MATCHALL "[A-Za-z0-9_]+" exported "${exported}")
        list(REMOVE_ITEM exported ${seen})
        list(APPEND bringing ${exported})
        list(APPEND seen ${exported})
      endif()
    endforeach()
  endwhile()
  if("${package}" IN_LIST seen)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# Whether files of interfaces use one of the packages that are released and nobody has here: without
# a ROS, that is no mistake of the workspace.
function(wsgen_lacks_interfaces result)
  cmake_parse_arguments(arguments "" "" "PACKAGES;FILES" ${ARGN})
  get_property(missing GLOBAL PROPERTY WSGEN_MISSING)
  set(prefixes "$ENV{WSGEN_ROS}:$ENV{AMENT_PREFIX_PATH}")
  string(REPLACE ":" ";" prefixes "${prefixes}")
  set(lacks FALSE)
  foreach(package IN LISTS arguments_PACKAGES)
    list(TRANSFORM prefixes APPEND "/share/${package}" OUTPUT_VARIABLE shares)
    foreach(share IN LISTS shares)
      if(EXISTS "${share}")
        list(REMOVE_ITEM missing "${package}")
      endif()
    endforeach()
    if("${package}" IN_LIST missing)
      foreach(file IN LISTS arguments_FILES)
        file(STRINGS "${file}" uses REGEX "^[^#]*${package}/")
        if(uses)
          set(lacks TRUE)
        endif()
      endforeach()
    endif()
  endforeach()
  set(${result} ${lacks} PARENT_SCOPE)
endfunction()

function(rosidl_generate_interfaces target)
  cmake_parse_arguments(arguments
    "ADD_LINTER_TESTS;SKIP_INSTALL;SKIP_GROUP_MEMBERSHIP_CHECK" "LIBRARY_NAME" "DEPENDENCIES" ${ARGN})
  if(NOT arguments_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "rosidl_generate_interfaces() called without any interface files")
  endif()
  set(files "")
  set(names "")
  foreach(name IN LISTS arguments_UNPARSED_ARGUMENTS)
    set(base "${CMAKE_CURRENT_SOURCE_DIR}")
    if(name MATCHES "^(/.*):([^:]*)$")
      set(base "${CMAKE_MATCH_1}")
      set(name "${CMAKE_MATCH_2}")
    endif()
    if(IS_ABSOLUTE "${name}" OR NOT EXISTS "${base}/${name}")
      message(FATAL_ERROR "rosidl_generate_interfaces() the passed file '${name}' doesn't exist "
        "relative to the CMAKE_CURRENT_SOURCE_DIR '${CMAKE_CURRENT_SOURCE_DIR}'")
    endif()
    list(APPEND files "${base}/${name}")
    list(APPEND names "${base}:${name}")
  endforeach()
  foreach(package IN LISTS arguments_DEPENDENCIES)
    wsgen_is_brought(is_brought "${package}")
    if(NOT ${package}_FOUND AND NOT is_brought)
      message(FATAL_ERROR "rosidl_generate_interfaces() the passed dependency '${package}' has not "
        "been found before using find_package()")
    endif()
  endforeach()
  if(NOT arguments_SKIP_INSTALL AND NOT arguments_SKIP_GROUP_MEMBERSHIP_CHECK)
    if(NOT _AMENT_PACKAGE_NAME)
      ament_package_xml()
    endif()
    if(NOT "rosidl_interface_packages" IN_LIST ${_AMENT_PACKAGE_NAME}_MEMBER_OF_GROUPS)
      message(FATAL_ERROR "Packages installing interfaces must include "
        "'<member_of_group>rosidl_interface_packages</member_of_group>' in their package.xml")
    endif()
  endif()

  wsgen_lacks_interfaces(is_left_out PACKAGES ${arguments_DEPENDENCIES} FILES ${files})
  if(is_left_out)
    wsgen_left_out_call(rosidl_generate_interfaces ${ARGV})
    return()
  endif()

  # Those of another Python or ROS do not fit.
  string(MD5 digest "$ENV{WSGEN_ROS}$ENV{WSGEN_PYTHON}")
  set(output "${CMAKE_CURRENT_BINARY_DIR}/wsgen_interfaces/${target}")
  set(stamp "${output}-${digest}.stamp")
  list(JOIN arguments_DEPENDENCIES "," uses)
  add_custom_command(
    OUTPUT "${stamp}"
    COMMAND "$ENV{WSGEN_PYTHON}" -m wsgen.ros.environment.workspace_messages
      --package "${PROJECT_NAME}" --output "${output}" --dependencies "${uses}"
      --ros "$ENV{WSGEN_ROS}" ${names}
    COMMAND "${CMAKE_COMMAND}" -E touch "${stamp}"
    DEPENDS ${files}
    COMMENT "Generating messages of ${PROJECT_NAME} for Python"
    VERBATIM
  )
  add_custom_target("${target}" ALL DEPENDS "${stamp}")
  if(NOT arguments_SKIP_INSTALL)
    foreach(folder IN ITEMS include lib share)
      install(DIRECTORY "${output}/${folder}/" DESTINATION "${folder}" USE_SOURCE_PERMISSIONS)
    endforeach()
    foreach(file IN LISTS files)
      get_filename_component(kind "${file}" DIRECTORY)
      get_filename_component(kind "${kind}" NAME)
      install(FILES "${file}" DESTINATION "share/${PROJECT_NAME}/${kind}")
    endforeach()
  endif()
endfunction()
