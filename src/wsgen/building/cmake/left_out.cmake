# Leaves out targets that need what is missing, with what links, installs and exports them.
#
# A target is compiled if it names nothing that is missing, and if every header that its sources
# include, and those headers in turn, is there. Any other is replaced by a library of the same name
# that is not built, so that commands about the target go on working.

get_property(wsgen_is_active GLOBAL PROPERTY WSGEN_ACTIVE)
if(wsgen_is_active)
  return()
endif()
set_property(GLOBAL PROPERTY WSGEN_ACTIVE TRUE)
cmake_language(DEFER DIRECTORY "${CMAKE_SOURCE_DIR}" CALL wsgen_write_report)

# Commands that packages define for others, and whose names begin as those of CMake and
# ament_cmake do, or that a file of another package calls.
set(wsgen_commands
  add_action_files add_message_files add_ros_isolated_gtest add_ros_test add_rostest
  add_service_files ament_add_gmock ament_add_google_benchmark ament_add_gtest
  ament_add_nose_test ament_add_pytest_test ament_auto_add_gtest ament_black
  ament_clang_format ament_copyright ament_cpplint ament_cppcheck ament_flake8
  ament_lint_auto_find_test_dependencies ament_lint_cmake ament_mypy ament_pep257
  ament_uncrustify ament_vendor ament_xmllint get_default_rmw_implementation get_rmw_typesupport
  rosidl_generate_interfaces
)

# ---- what is missing

# Whether one of the arguments stands for something that is missing or left out.
function(wsgen_names_missing result)
  get_property(missing GLOBAL PROPERTY WSGEN_MISSING)
  get_property(left_out GLOBAL PROPERTY WSGEN_LEFT_OUT)
  set(names_missing FALSE)
  foreach(word IN LISTS ARGN)
    if(word MATCHES "wsgen-missing|-NOTFOUND" OR word IN_LIST missing OR word IN_LIST left_out)
      set(names_missing TRUE)
    endif()
    string(REGEX MATCHALL "[A-Za-z0-9_.+-]+::[A-Za-z0-9_.:+-]+" names "${word}")
    foreach(name IN LISTS names)
      if(NOT TARGET "${name}")
        set(names_missing TRUE)
      endif()
    endforeach()
  endforeach()
  set(${result} ${names_missing} PARENT_SCOPE)
endfunction()

# Whether sources, or headers of the package that they include, include a header that is not there.
function(wsgen_lacks_header result)
  get_property(folders DIRECTORY PROPERTY INCLUDE_DIRECTORIES)
  get_property(found GLOBAL PROPERTY WSGEN_INCLUDE_FOLDERS)
  list(APPEND folders
    "${CMAKE_CURRENT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}/include" "${CMAKE_SOURCE_DIR}/include"
    ${found} ${CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES} ${CMAKE_C_IMPLICIT_INCLUDE_DIRECTORIES}
  )
  set(system ${CMAKE_CXX_IMPLICIT_INCLUDE_DIRECTORIES} ${CMAKE_C_IMPLICIT_INCLUDE_DIRECTORIES})
  set(${result} TRUE PARENT_SCOPE)
  set(files "")
  foreach(source IN LISTS ARGN)
    get_filename_component(source "${source}" ABSOLUTE)
    list(APPEND files "${source}")
  endforeach()
  set(seen "")
  while(files)
    list(POP_FRONT files file)
    if(file IN_LIST seen)
      continue()
    endif()
    list(APPEND seen "${file}")
    if(NOT EXISTS "${file}" OR IS_DIRECTORY "${file}")
      return()
    endif()
    get_filename_component(beside "${file}" DIRECTORY)
    file(STRINGS "${file}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[^<\"]*[<\"]([^>\"]*).*" "\\1" header "${line}")
      set(place "")
      foreach(folder IN LISTS beside folders)
        if(EXISTS "${folder}/${header}")
          set(place "${folder}")
          break()
        endif()
      endforeach()
      if(place STREQUAL "")
        return()
      elseif(NOT place IN_LIST system)
        list(APPEND files "${place}/${header}")
      endif()
    endforeach()
  endwhile()
  set(${result} FALSE PARENT_SCOPE)
endfunction()

# Stops for a source file that nobody writes, as CMake does when it generates.
function(wsgen_check_sources)
  foreach(source IN LISTS ARGN)
    if(NOT source MATCHES "\\$<|-NOTFOUND|^/wsgen-missing" AND source MATCHES "\\.(c|cc|cpp|cxx)$")
      get_source_file_property(is_generated "${source}" GENERATED)
      get_filename_component(file "${source}" ABSOLUTE)
      if(NOT is_generated AND NOT EXISTS "${file}" AND NOT file MATCHES "^${CMAKE_BINARY_DIR}/"
          AND NOT EXISTS "${CMAKE_CURRENT_BINARY_DIR}/${source}")
        message(SEND_ERROR "Cannot find source file: ${source}")
      endif()
    endif()
  endforeach()
endfunction()

# ---- what is left out

function(wsgen_is_left_out result target)
  get_property(left_out GLOBAL PROPERTY WSGEN_LEFT_OUT)
  if(target IN_LIST left_out)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# Leaves out a target, made already or not.
function(wsgen_leave_out target)
  wsgen_stand_in("${target}")
  set_target_properties("${target}" PROPERTIES EXCLUDE_FROM_ALL TRUE)
  wsgen_is_left_out(known "${target}")
  if(NOT known)
    set_property(GLOBAL APPEND PROPERTY WSGEN_LEFT_OUT "${target}")
    set_property(GLOBAL APPEND PROPERTY WSGEN_REPORT "target ${target}")
  endif()
endfunction()

# Makes a target that is not built, unless there is one of this name.
function(wsgen_stand_in name)
  if(TARGET "${name}")
    return()
  endif()
  get_property(languages GLOBAL PROPERTY ENABLED_LANGUAGES)
  get_property(folder GLOBAL PROPERTY WSGEN_FOLDER)
  if(CXX IN_LIST languages)
    _add_library("${name}" STATIC EXCLUDE_FROM_ALL "${folder}/unused.cpp")
  elseif(C IN_LIST languages)
    _add_library("${name}" STATIC EXCLUDE_FROM_ALL "${folder}/unused.c")
  else()
    add_custom_target("${name}")
    return()
  endif()
  set_target_properties("${name}" PROPERTIES
    AUTOMOC OFF AUTOUIC OFF AUTORCC OFF INCLUDE_DIRECTORIES "" LINK_LIBRARIES "")
endfunction()

# A call of a command whose package is missing; its first argument may name a target to come.
function(wsgen_left_out_call command)
  set(name "${ARGV1}")
  if(command STREQUAL "rosidl_generate_interfaces")
    set_property(GLOBAL APPEND PROPERTY WSGEN_REPORT "interfaces ${name}")
  elseif(command MATCHES "add_(executable|library|module)$" AND name MATCHES "^[A-Za-z0-9_.+-]+$")
    wsgen_leave_out("${name}")
  elseif(NOT command MATCHES
      "^(ament|export|gz|ign|ignition|pluginlib|qt[56]?|rclcpp_components|rosidl|set)_|test")
    set_property(GLOBAL APPEND PROPERTY WSGEN_REPORT "call ${command}()")
  endif()
  if(command MATCHES "generate" AND name MATCHES "^[A-Za-z0-9_.+-]+$")
    wsgen_stand_in("${name}")
    set_property(GLOBAL APPEND PROPERTY WSGEN_LEFT_OUT "${name}")
  endif()
endfunction()

function(wsgen_write_report)
  get_property(report GLOBAL PROPERTY WSGEN_REPORT)
  get_property(missing GLOBAL PROPERTY WSGEN_MISSING)
  if(report)
    list(REMOVE_DUPLICATES report)
    list(TRANSFORM missing PREPEND "missing ")
    list(JOIN report "\n" text)
    list(JOIN missing "\n" needs)
    file(WRITE "${CMAKE_BINARY_DIR}/wsgen_left_out.txt" "${needs}\n${text}\n")
  endif()
endfunction()

# ---- commands about targets

# Whether the target cannot be compiled from these sources here.
function(wsgen_is_uncompilable result)
  if(NOT WSGEN_HAS_COMPILER OR "${ARGN}" STREQUAL "")
    set(${result} TRUE PARENT_SCOPE)
    return()
  endif()
  wsgen_lacks_header(lacks_header ${ARGN})
  wsgen_names_missing(names_missing ${ARGN})
  if(lacks_header OR names_missing)
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

# Makes a target by CMake's own command, or leaves it out.
function(wsgen_make command target)
  set(sources "${ARGN}")
  list(REMOVE_ITEM sources
    STATIC SHARED MODULE OBJECT WIN32 MACOSX_BUNDLE EXCLUDE_FROM_ALL)
  wsgen_is_uncompilable(is_uncompilable ${sources})
  if(is_uncompilable)
    wsgen_check_sources(${sources})
    wsgen_leave_out("${target}")
  else()
    cmake_language(CALL ${command} "${target}" ${ARGN})
  endif()
endfunction()

function(add_executable target)
  if(ARGN MATCHES "^(IMPORTED|ALIAS)(;|$)")
    _add_executable("${target}" ${ARGN})
  else()
    wsgen_make(_add_executable "${target}" ${ARGN})
  endif()
endfunction()

function(add_library target)
  if(NOT ARGN MATCHES "(^|;)(IMPORTED|ALIAS|INTERFACE)(;|$)")
    wsgen_make(_add_library "${target}" ${ARGN})
    return()
  endif()
  _add_library("${target}" ${ARGN})
  wsgen_names_missing(names_missing ${ARGN})
  if(names_missing AND ARGN MATCHES "^ALIAS")
    set_property(GLOBAL APPEND PROPERTY WSGEN_LEFT_OUT "${target}")
  endif()
endfunction()

foreach(command IN ITEMS
    target_link_libraries target_include_directories ament_target_dependencies)
  if(COMMAND ${command})
    cmake_language(EVAL CODE "
function(${command} target)
  wsgen_needs_missing(needs_missing \"\${target}\" \${ARGN})
  if(NOT needs_missing)
    _${command}(\"\${target}\" \${ARGN})
  endif()
endfunction()")
  endif()
endforeach()

foreach(command IN ITEMS target_sources target_compile_features)
  cmake_language(EVAL CODE "
function(${command} target)
  wsgen_is_left_out(is_left_out \"\${target}\")
  if(NOT is_left_out)
    _${command}(\"\${target}\" \${ARGN})
  endif()
endfunction()")
endforeach()

# Whether the target is left out, for one of the arguments if not before.
function(wsgen_needs_missing result target)
  wsgen_names_missing(needs_missing "${target}" ${ARGN})
  if(needs_missing AND TARGET "${target}")
    wsgen_leave_out("${target}")
  endif()
  set(${result} ${needs_missing} PARENT_SCOPE)
endfunction()

# The messages that the package itself defines.
macro(rosidl_get_typesupport_target variable)
  set(${variable} "wsgen-missing::${variable}")
endmacro()

macro(rosidl_target_interfaces target)
  wsgen_leave_out("${target}")
endmacro()

function(add_dependencies target)
  wsgen_is_left_out(is_left_out "${target}")
  if(is_left_out)
    return()
  endif()
  foreach(name IN LISTS ARGN)
    if(TARGET "${name}")
      _add_dependencies("${target}" "${name}")
    endif()
  endforeach()
endfunction()

macro(get_target_property variable target)
  if(TARGET "${target}")
    _get_target_property(${variable} "${target}" ${ARGN})
  else()
    set(${variable} "${variable}-NOTFOUND")
  endif()
endmacro()

function(include_directories)
  list(FILTER ARGV EXCLUDE REGEX "wsgen-missing|-NOTFOUND$")
  _include_directories(${ARGV})
endfunction()

# find_library(), find_path() and their like: what is not found is missing, where they say REQUIRED
# or the file stops without it.
function(wsgen_is_required result variable)
  file(READ "${CMAKE_CURRENT_LIST_FILE}" text)
  set(stops "NOT +\"?[$]?[{]?${variable}[}]?\"?([^A-Za-z0-9_(][^()]*)?[)][ \t\r\n]*message *[(][ \t\r\n]*")
  if("REQUIRED" IN_LIST ARGN OR text MATCHES "${stops}(FATAL|SEND)_ERROR")
    set(${result} TRUE PARENT_SCOPE)
  else()
    set(${result} FALSE PARENT_SCOPE)
  endif()
endfunction()

foreach(command IN ITEMS find_library find_path find_file find_program)
  cmake_language(EVAL CODE "
macro(${command} variable)
  set(wsgen_request \"\${ARGN}\")
  list(REMOVE_ITEM wsgen_request REQUIRED)
  _${command}(\${variable} \${wsgen_request})
  if(NOT \${variable})
    wsgen_is_required(wsgen_required \${variable} \${ARGN})
    if(wsgen_required)
      set(wsgen_request \"\${ARGN}\")
      list(REMOVE_ITEM wsgen_request NAMES REQUIRED)
      list(GET wsgen_request 0 wsgen_request)
      set(\${variable} /wsgen-missing/\${variable})
      wsgen_is_missing(\"\${wsgen_request}\")
    endif()
  endif()
endmacro()")
endforeach()

# ---- commands that install and export

# To install links, ament_cmake replaces install(), before this file is included or after it; with
# both, CMake's own command is __install.
if(COMMAND _install)
  set(wsgen_name _install)
else()
  set(wsgen_name install)
endif()

function(${wsgen_name})
  set(words ${ARGV})
  if(ARGV0 STREQUAL "TARGETS")
    wsgen_keep_built(words ${words})
    if(words MATCHES "^TARGETS(;(EXPORT|ARCHIVE|LIBRARY|RUNTIME|OBJECTS|DESTINATION|INCLUDES)|$)")
      return()
    elseif(words MATCHES ";EXPORT;([^;]+)")
      set_property(GLOBAL APPEND PROPERTY WSGEN_EXPORTS "${CMAKE_MATCH_1}")
    endif()
    __install(${words})
  elseif(ARGV0 STREQUAL "EXPORT")
    get_property(exports GLOBAL PROPERTY WSGEN_EXPORTS)
    if(ARGV1 IN_LIST exports)
      __install(${words})
    endif()
  elseif(ARGV0 MATCHES "^(FILES|PROGRAMS|DIRECTORY)$"
      AND words MATCHES ";${CMAKE_BINARY_DIR}|TARGET_FILE" AND NOT "OPTIONAL" IN_LIST words)
    list(FIND words DESTINATION position)
    list(INSERT words ${position} OPTIONAL)  # what is left out may generate the file
    __install(${words})
  else()
    set(call "")
    math(EXPR last "${ARGC} - 1")
    foreach(number RANGE ${last})
      string(APPEND call " [==[${ARGV${number}}]==]")
    endforeach()
    cmake_language(EVAL CODE "__install(${call})")
  endif()
endfunction()

# For other projects of the build tree, what install() exports, or targets.
function(export)
  wsgen_keep_built(words ${ARGV})
  get_property(exports GLOBAL PROPERTY WSGEN_EXPORTS)
  if(ARGV0 STREQUAL "EXPORT" AND NOT ARGV1 IN_LIST exports
      OR words MATCHES "^TARGETS;(NAMESPACE|FILE|APPEND|EXPORT_LINK)")
    return()
  endif()
  _export(${words})
endfunction()

if(wsgen_name STREQUAL "install")
  macro(_install)
    __install(${ARGV})
  endmacro()
endif()

if(COMMAND ament_cmake_symlink_install_targets)
  function(ament_cmake_symlink_install_targets)
    wsgen_keep_built(words ${ARGV})
    if(NOT words MATCHES "^TARGETS(;(EXPORT|ARCHIVE|LIBRARY|RUNTIME|DESTINATION|INCLUDES)|$)")
      _ament_cmake_symlink_install_targets(${words})
    endif()
  endfunction()
endif()

function(wsgen_keep_built result)
  get_property(left_out GLOBAL PROPERTY WSGEN_LEFT_OUT)
  set(kept ${ARGN})
  list(REMOVE_ITEM kept "" ${left_out})  # no if(): a target may be called n, which means false
  list(FILTER kept EXCLUDE REGEX "wsgen-missing")
  set(${result} ${kept} PARENT_SCOPE)
endfunction()

# What ament_cmake writes into the files by which other packages find this one.
foreach(command IN ITEMS
    ament_export_include_directories ament_export_interfaces ament_export_libraries ament_export_targets)
  if(COMMAND ${command})
    cmake_language(EVAL CODE "
macro(${command})
  wsgen_keep_exported(wsgen_words ${command} \${ARGN})
  _${command}(\${wsgen_words})
endmacro()")
  endif()
endforeach()

function(wsgen_keep_exported result command)
  wsgen_keep_built(kept ${ARGN})
  if(command MATCHES "targets|interfaces")
    get_property(exports GLOBAL PROPERTY WSGEN_EXPORTS)
    set(named ${kept})
    list(FILTER named EXCLUDE REGEX "^(HAS_LIBRARY_TARGET|NAMESPACE)$")
    list(REMOVE_ITEM named "" ${exports})
    if(named AND kept)
      list(REMOVE_ITEM kept ${named})
    endif()
    if(kept STREQUAL "HAS_LIBRARY_TARGET")
      set(kept "")
    endif()
  endif()
  set(${result} ${kept} PARENT_SCOPE)
endfunction()

# ---- commands of missing packages

# ament_cmake_auto asks for what package.xml names.
if(NOT COMMAND ament_auto_package)
  macro(ament_auto_find_build_dependencies)
    if(NOT _AMENT_PACKAGE_NAME)
      ament_package_xml()
    endif()
    foreach(wsgen_dependency IN LISTS
        ${PROJECT_NAME}_BUILD_DEPENDS ${PROJECT_NAME}_BUILDTOOL_DEPENDS)
      find_package(${wsgen_dependency})
    endforeach()
  endmacro()

  macro(ament_auto_add_executable target)
    wsgen_leave_out(${target})
  endmacro()

  macro(ament_auto_add_library target)
    wsgen_leave_out(${target})
  endmacro()

  macro(ament_auto_generate_code)
  endmacro()

  macro(ament_auto_package)
    cmake_parse_arguments(wsgen_auto "INSTALL_TO_PATH" "" "INSTALL_TO_SHARE" ${ARGN})
    if(IS_DIRECTORY "${CMAKE_CURRENT_SOURCE_DIR}/include")
      install(DIRECTORY include/ DESTINATION include)
    endif()
    foreach(wsgen_folder IN LISTS wsgen_auto_INSTALL_TO_SHARE)
      install(DIRECTORY "${wsgen_folder}" DESTINATION "share/${PROJECT_NAME}")
    endforeach()
    ament_package()
  endmacro()
endif()

# gz-cmake asks for packages by its own commands.
foreach(command IN ITEMS gz_find_package ign_find_package)
  if(NOT COMMAND ${command})
    cmake_language(EVAL CODE "
macro(${command})
  find_package(\${ARGN})
endmacro()")
  endif()
endforeach()

# Commands of the package's files that nobody has defined so far do nothing; whoever defines one
# later replaces it. A name that begins as that of a command does, up to the second letter of its
# second word, is rather misspelled.
get_cmake_property(wsgen_defined COMMANDS)
file(GLOB_RECURSE wsgen_files "${CMAKE_SOURCE_DIR}/CMakeLists.txt" "${CMAKE_SOURCE_DIR}/*.cmake")
foreach(file IN LISTS wsgen_files)
  file(STRINGS "${file}" lines REGEX "^[ \t]*[A-Za-z0-9]+_[A-Za-z0-9_]*[ \t]*\\(")
  foreach(line IN LISTS lines)
    string(REGEX REPLACE "^[ \t]*([A-Za-z0-9_]+).*" "\\1" command "${line}")
    string(TOLOWER "${command}" command)
    string(REGEX MATCH "^[a-z0-9]+_.?.?" beginning "${command}")
    set(similar ${wsgen_defined})
    list(FILTER similar INCLUDE REGEX "^${beginning}")
    if(NOT similar)
      list(APPEND wsgen_commands "${command}")
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES wsgen_commands)
foreach(command IN LISTS wsgen_commands)
  if(NOT COMMAND ${command})
    cmake_language(EVAL CODE "
function(${command})
  wsgen_left_out_call(${command} \${ARGV})
endfunction()")
  endif()
endforeach()
