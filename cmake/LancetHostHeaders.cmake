# Dependencies that a cross build shares with the machine it runs on. Their packages are not installed for the other
# processor, and the machine's own /usr/include must not be searched as a whole: it holds headers of its C library.

# lancet_find_header_package(package version TARGET t HEADER h [SUBFOLDER s]): find_package, or, in a cross build, a
# target of the same name with the one folder of headers that it needs, reached through a link in the build tree.
function(lancet_find_header_package package version)
  cmake_parse_arguments(PARSE_ARGV 2 arg "" "TARGET;HEADER;SUBFOLDER" "")
  if(NOT CMAKE_CROSSCOMPILING)
    find_package(${package} ${version} REQUIRED CONFIG GLOBAL)
    return()
  endif()
  find_path(LANCET_${package}_HEADERS ${arg_HEADER} PATHS /usr/include /usr/local/include
            PATH_SUFFIXES ${arg_SUBFOLDER} NO_DEFAULT_PATH NO_CMAKE_FIND_ROOT_PATH)
  if(NOT LANCET_${package}_HEADERS)
    message(FATAL_ERROR "${arg_HEADER} (package ${package}) was not found on this machine")
  endif()
  get_filename_component(first "${arg_HEADER}" DIRECTORY)
  set(root "${PROJECT_BINARY_DIR}/host-headers/${package}")
  file(MAKE_DIRECTORY "${root}")
  file(CREATE_LINK "${LANCET_${package}_HEADERS}/${first}" "${root}/${first}" SYMBOLIC)
  add_library(${arg_TARGET} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${arg_TARGET} INTERFACE "${root}")
endfunction()

# lancet_find_googletest(version): the installed libraries, or, in a cross build, Debian's sources compiled for the
# other processor.
function(lancet_find_googletest version)
  if(NOT CMAKE_CROSSCOMPILING)
    find_package(GTest ${version} REQUIRED GLOBAL)
    return()
  endif()
  set(sources /usr/src/googletest)
  if(NOT EXISTS "${sources}/CMakeLists.txt")
    message(FATAL_ERROR "the sources of GoogleTest were not found in ${sources} (Debian package googletest)")
  endif()
  enable_language(C)
  set(INSTALL_GTEST OFF)
  add_subdirectory("${sources}" "${PROJECT_BINARY_DIR}/googletest" EXCLUDE_FROM_ALL)
endfunction()
