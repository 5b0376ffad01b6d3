# The language, the build type and the include root of every target.

if(NOT LANCET_SCHEDULER MATCHES "^(tbb|openmp|serial)$")
  message(FATAL_ERROR "LANCET_SCHEDULER is '${LANCET_SCHEDULER}'; expected tbb, openmp or serial")
endif()

include(GNUInstallDirs)

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Sources say #include "lancet/mesh/tet_mesh.hpp", in the build tree as in an installed one.
set(LANCET_INCLUDE_ROOT "${PROJECT_BINARY_DIR}/include")
file(MAKE_DIRECTORY "${LANCET_INCLUDE_ROOT}/lancet")
foreach(folder kernels mesh runtime experiments)
  file(CREATE_LINK "${PROJECT_SOURCE_DIR}/${folder}" "${LANCET_INCLUDE_ROOT}/lancet/${folder}" SYMBOLIC)
endforeach()
