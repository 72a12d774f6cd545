# pkg_check_modules() and pkg_search_module() whose modules count as found; after find_package(PkgConfig).
# No list has the names of all modules, so none is taken for a mistake.

macro(wsgen_pkg_config command prefix)
  set(wsgen_modules ${ARGN})
  list(REMOVE_ITEM wsgen_modules REQUIRED)
  if(command STREQUAL "pkg_check_modules")
    _pkg_check_modules(${prefix} QUIET ${wsgen_modules})
  else()
    _pkg_search_module(${prefix} QUIET ${wsgen_modules})
  endif()
  if(NOT ${prefix}_FOUND)
    set(wsgen_modules ${ARGN})
    if(REQUIRED IN_LIST wsgen_modules)
      list(REMOVE_ITEM wsgen_modules REQUIRED QUIET IMPORTED_TARGET GLOBAL NO_CMAKE_PATH NO_CMAKE_ENVIRONMENT_PATH)
      list(GET wsgen_modules 0 wsgen_module)
      string(REGEX REPLACE "[<>=].*" "" wsgen_module "${wsgen_module}")
      wsgen_assume(${prefix})
    endif()
  endif()
endmacro()

macro(pkg_check_modules prefix)
  wsgen_pkg_config(pkg_check_modules ${prefix} ${ARGN})
endmacro()

macro(pkg_search_module prefix)
  wsgen_pkg_config(pkg_search_module ${prefix} ${ARGN})
endmacro()
