# Configures a package of ROS without ROS: wsgen build names this file in
# CMAKE_PROJECT_TOP_LEVEL_INCLUDES, and CMake includes it in the first call of project().
#
# A package that is asked for and not installed counts as found if its name is known. From the
# first such package on, left_out.cmake replaces the commands that make, link and install targets.
# Until then every command is CMake's own.
#
# CMake's cache keeps the name of this file, so it does nothing without the variables of
# environment that wsgen build sets for one build:
#   WSGEN_NAMES   files with the names of packages, a list; lines that begin with # are comments
#   WSGEN_FAILED  the packages of the workspace whose build failed, a list
#   WSGEN_PYTHON  the Python with the modules that ament_cmake imports
#   WSGEN_ROS     see interfaces.cmake; empty if messages are left out
# WSGEN_HAS_COMPILER is an argument, so that colcon configures again when it changes.

set(wsgen_stand_in_file "${CMAKE_BINARY_DIR}/wsgen_without_compiler.txt")
if(WSGEN_HAS_COMPILER AND EXISTS "${wsgen_stand_in_file}")
  # CMake keeps the compiler that stood in.
  file(REMOVE "${wsgen_stand_in_file}"
    "${CMAKE_PLATFORM_INFO_DIR}/CMakeCCompiler.cmake"
    "${CMAKE_PLATFORM_INFO_DIR}/CMakeCXXCompiler.cmake")
endif()
if("$ENV{WSGEN_NAMES}" STREQUAL "")
  return()
endif()

set(wsgen_name_files "$ENV{WSGEN_NAMES}")
set(wsgen_failed "$ENV{WSGEN_FAILED}")
foreach(policy IN ITEMS CMP0144 CMP0146 CMP0167)  # whose warnings would name this file
  if(POLICY ${policy})
    cmake_policy(GET ${policy} value)
    if(NOT value)
      cmake_policy(SET ${policy} NEW)
    endif()
  endif()
endforeach()
set_property(GLOBAL PROPERTY WSGEN_FOLDER "${CMAKE_CURRENT_LIST_DIR}")
set_property(GLOBAL PROPERTY WSGEN_MISSING "")
set_property(GLOBAL PROPERTY WSGEN_LEFT_OUT "")
file(REMOVE "${CMAKE_BINARY_DIR}/wsgen_left_out.txt")

# Who knows a package of this name: "ROS", with the workspace itself, "others" (CMake, the package itself,
# rosdep, the list of well-known libraries), or FALSE.
function(wsgen_is_known result package)
  get_property(packages GLOBAL PROPERTY WSGEN_KNOWN_PACKAGES)
  get_property(others GLOBAL PROPERTY WSGEN_KNOWN_OTHERS)
  if(NOT packages)
    set(text "")
    foreach(file IN LISTS wsgen_name_files)
      file(STRINGS "${file}" lines REGEX "^[^#]")
      string(APPEND text ";${lines}")
    endforeach()
    string(REGEX REPLACE "[ ;]+" ";" others "${text}")
    list(FIND others "rosdep:" position)  # the heading of what is no package of ROS
    list(SUBLIST others 0 ${position} packages)
    set_property(GLOBAL PROPERTY WSGEN_KNOWN_PACKAGES "${packages}")
    set_property(GLOBAL PROPERTY WSGEN_KNOWN_OTHERS "${others}")
  endif()
  string(TOLOWER "${package}" lower)
  set(${result} FALSE PARENT_SCOPE)
  if(package IN_LIST packages OR package IN_LIST wsgen_failed)
    set(${result} ROS PARENT_SCOPE)
  elseif(package IN_LIST others OR lower IN_LIST others)
    set(${result} others PARENT_SCOPE)
  else()
    foreach(folder IN LISTS CMAKE_MODULE_PATH ITEMS "${CMAKE_ROOT}/Modules")
      if(EXISTS "${folder}/Find${package}.cmake")
        set(${result} others PARENT_SCOPE)
      endif()
    endforeach()
  endif()
endfunction()

# Keeps the name for the report, and replaces the commands that need to know of it.
macro(wsgen_is_missing package)
  get_property(wsgen_missing GLOBAL PROPERTY WSGEN_MISSING)
  if(NOT "${package}" IN_LIST wsgen_missing)
    set_property(GLOBAL APPEND PROPERTY WSGEN_MISSING "${package}")
  endif()
  get_property(wsgen_folder GLOBAL PROPERTY WSGEN_FOLDER)
  # Some packages of ROS bring ament_cmake with them.
  if(NOT ament_cmake_FOUND)
    find_package(ament_cmake QUIET BYPASS_PROVIDER)
  endif()
  include("${wsgen_folder}/left_out.cmake")
endmacro()

# Sets what a package sets that is found. The values of variables with its libraries and folders
# tell targets that use them from others.
macro(wsgen_assume package)
  string(TOUPPER "${package}" wsgen_upper)
  get_property(wsgen_folder GLOBAL PROPERTY WSGEN_FOLDER)
  string(REGEX MATCH "[0-9]+$" wsgen_version "${package}")
  if(NOT wsgen_version)
    set(wsgen_version 99)  # no package is too old for those that ask
  endif()
  foreach(wsgen_prefix IN ITEMS "${package}" "${wsgen_upper}")
    set(${wsgen_prefix}_FOUND TRUE)
    set(${wsgen_prefix}_VERSION "${wsgen_version}.0.0")
    set(${wsgen_prefix}_VERSION_MAJOR "${wsgen_version}")
    set(${wsgen_prefix}_VERSION_MINOR 0)
    set(${wsgen_prefix}_VERSION_PATCH 0)
    set(${wsgen_prefix}_USE_FILE "${wsgen_folder}/nothing.cmake")
    foreach(wsgen_suffix IN ITEMS LIBRARIES LIBRARY LIBS TARGETS)
      set(${wsgen_prefix}_${wsgen_suffix} "wsgen-missing::${package}")
    endforeach()
    foreach(wsgen_suffix IN ITEMS INCLUDE_DIRS INCLUDE_DIR)
      set(${wsgen_prefix}_${wsgen_suffix} "/wsgen-missing/${package}")
    endforeach()
    foreach(wsgen_component IN ITEMS ${ARGN})
      set(${wsgen_prefix}_${wsgen_component}_FOUND TRUE)
    endforeach()
  endforeach()
  wsgen_is_missing("${package}")
endmacro()

# A package may name the Python of the machine, which has the modules of ROS where ROS is installed.
# Later the variable is that of the Python which CMake has found.
function(wsgen_choose_python)
  get_property(has_chosen GLOBAL PROPERTY WSGEN_HAS_CHOSEN_PYTHON)
  if(has_chosen)
    return()
  endif()
  set_property(GLOBAL PROPERTY WSGEN_HAS_CHOSEN_PYTHON TRUE)
  get_property(origin CACHE Python3_EXECUTABLE PROPERTY HELPSTRING)
  if(Python3_EXECUTABLE AND NOT Python3_EXECUTABLE STREQUAL "$ENV{WSGEN_PYTHON}"
      AND NOT origin MATCHES "command line")
    execute_process(
      COMMAND "${Python3_EXECUTABLE}" -c "import ament_package, catkin_pkg"
      RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(failed)
      set(Python3_EXECUTABLE "$ENV{WSGEN_PYTHON}" CACHE FILEPATH "" FORCE)
      set(Python3_EXECUTABLE "$ENV{WSGEN_PYTHON}" PARENT_SCOPE)
    endif()
  endif()
endfunction()

# The provider of find_package(). It is a macro, because find_package() sets variables of the
# caller, and it uses no variable of its own after find_package(), which may call it again.
macro(wsgen_find_package method package)
  if("${package}" MATCHES "^(ament_cmake.*|Python3)$")
    wsgen_choose_python()
  endif()
  string(FIND "${CMAKE_CURRENT_LIST_FILE}" "${CMAKE_SOURCE_DIR}/" wsgen_position)
  # The module for Python heeds policies, and those of the caller do not reach into a macro: where
  # ament_cmake asks for it, CMake goes on by itself.
  if(wsgen_position EQUAL 0 OR NOT "${package}" MATCHES "^Python3?$")
    wsgen_find_or_assume("${package}" ${ARGN})
  endif()
endmacro()

macro(wsgen_find_or_assume package)
  set(wsgen_request "${ARGN}")
  # Names of components may follow REQUIRED. What this call does not find, and what is not assumed
  # below, CMake looks for again as the caller asks, and says what is wrong.
  list(TRANSFORM wsgen_request REPLACE "^REQUIRED$" COMPONENTS)
  list(REMOVE_ITEM wsgen_request QUIET)
  find_package("${package}" ${wsgen_request} QUIET BYPASS_PROVIDER)
  if("${package}" STREQUAL "PkgConfig")
    get_property(wsgen_folder GLOBAL PROPERTY WSGEN_FOLDER)
    include("${wsgen_folder}/pkg_config.cmake")
    set(PkgConfig_FOUND TRUE)  # pkg_check_modules() tells what is missing
  endif()
  if(NOT WSGEN_HAS_COMPILER AND "${package}" STREQUAL "ament_cmake")
    wsgen_is_missing("a C++ compiler")
  endif()
  set(wsgen_request "${ARGN}")
  if(${package}_FOUND)
    set_property(GLOBAL APPEND PROPERTY WSGEN_INCLUDE_FOLDERS ${${package}_INCLUDE_DIRS})
    if(EXISTS "${CMAKE_BINARY_DIR}/../${package}/wsgen_left_out.txt"
        AND NOT "${package}" STREQUAL "${PROJECT_NAME}")
      wsgen_is_missing("${package}")  # in part
    endif()
  else()
    wsgen_is_known(wsgen_known "${package}")
    if("${package}" MATCHES "^ament_cmake(_core)?$")
      set(wsgen_known FALSE)  # without it nothing is installed
    endif()
    if(wsgen_known AND REQUIRED IN_LIST wsgen_request
        OR wsgen_known STREQUAL "ROS")  # some packages install nothing without it
      wsgen_assume("${package}" ${ARGN})
    elseif(wsgen_known)
      wsgen_is_missing("${package}")  # a target may need it without asking for it
    endif()
  endif()
endmacro()

# Those of the real generators replace it, if they are found. The argument of the same name makes
# colcon configure again when the ROS is another one; CMake warns of arguments that nobody reads.
set(wsgen_ros "${WSGEN_ROS}")
if(NOT "$ENV{WSGEN_ROS}" STREQUAL "")
  include("${CMAKE_CURRENT_LIST_DIR}/interfaces.cmake")
endif()

cmake_language(
  SET_DEPENDENCY_PROVIDER wsgen_find_package SUPPORTED_METHODS FIND_PACKAGE
)

if(NOT WSGEN_HAS_COMPILER)
  # project() goes on without a compiler, as nothing is compiled.
  file(WRITE "${wsgen_stand_in_file}" "")
  foreach(language IN ITEMS C CXX)
    set(CMAKE_${language}_COMPILER "${CMAKE_COMMAND}")
    set(CMAKE_${language}_COMPILER_ID_RUN TRUE)
    set(CMAKE_${language}_COMPILER_FORCED TRUE)
    set(CMAKE_${language}_COMPILER_WORKS TRUE)
  endforeach()
endif()
