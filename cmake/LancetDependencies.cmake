# Everything comes from the system: see the package list in cmake/debian-packages.txt.

include(LancetHostHeaders)

# Headers only: the same ones serve every processor.
lancet_find_header_package(xsimd 8.1 TARGET xsimd HEADER xsimd/xsimd.hpp)
lancet_find_header_package(Eigen3 3.4 TARGET Eigen3::Eigen HEADER Eigen/Core SUBFOLDER eigen3)
if(LANCET_BUILD_TESTS)
  lancet_find_googletest(1.12)
endif()
find_package(Threads REQUIRED)

if(NOT LANCET_KERNELS_ONLY)
  find_package(Boost 1.74 REQUIRED)  # headers only: Multiprecision
  find_package(pugixml REQUIRED)
  find_package(ZLIB REQUIRED)
  find_package(nlohmann_json 3.11 REQUIRED)

  # The default scheduler is required, the other ones are used where they are found.
  if(LANCET_SCHEDULER STREQUAL "tbb")
    find_package(TBB 2021 REQUIRED)
  else()
    find_package(TBB 2021 QUIET)
  endif()
  if(LANCET_SCHEDULER STREQUAL "openmp")
    find_package(OpenMP REQUIRED COMPONENTS CXX)
  else()
    find_package(OpenMP QUIET COMPONENTS CXX)
  endif()

  if(LANCET_BUILD_EXPERIMENTS OR LANCET_BUILD_BENCHMARKS)
    find_package(CLI11 2.1 REQUIRED)
    find_package(embree 3.13 REQUIRED)
  endif()
  if(LANCET_BUILD_BENCHMARKS)
    find_package(benchmark 1.7 REQUIRED)
  endif()
endif()

# What installed libraries may link, and what finds it; cmake/LancetInstall.cmake takes those that they do link.
set(lancet_external_targets Eigen3::Eigen xsimd pugixml::pugixml ZLIB::ZLIB nlohmann_json::nlohmann_json
                            Threads::Threads TBB::tbb OpenMP::OpenMP_CXX)
set(lancet_external_packages Eigen3 xsimd pugixml ZLIB nlohmann_json Threads TBB "OpenMP COMPONENTS CXX")
