# find_package(lancet) for others: libraries, headers, and a package file that finds what the libraries need.

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY LANCET_LIBRARIES)
add_library(lancet INTERFACE)
add_library(lancet::lancet ALIAS lancet)
target_link_libraries(lancet INTERFACE ${libraries})

install(TARGETS lancet ${libraries} EXPORT lancet-targets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(EXPORT lancet-targets NAMESPACE lancet:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lancet")
foreach(folder kernels mesh runtime)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lancet"
          FILES_MATCHING PATTERN "*.hpp")
endforeach()

configure_package_config_file(cmake/lancet-config.cmake.in lancet-config.cmake
                              INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lancet")
write_basic_package_version_file(lancet-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/lancet-config.cmake" "${CMAKE_CURRENT_BINARY_DIR}/lancet-config-version.cmake"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lancet")
