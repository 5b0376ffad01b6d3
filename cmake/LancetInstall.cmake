# find_package(lancet) for others: libraries, headers, and a package file that finds what the libraries need.

include(CMakePackageConfigHelpers)

get_property(libraries GLOBAL PROPERTY LANCET_LIBRARIES)
add_library(lancet INTERFACE)
add_library(lancet::lancet ALIAS lancet)
target_link_libraries(lancet INTERFACE ${libraries})

install(TARGETS lancet ${libraries} EXPORT lancet-targets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
install(EXPORT lancet-targets NAMESPACE lancet:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lancet")
set(folders kernels)
if(NOT LANCET_KERNELS_ONLY)
  list(APPEND folders mesh runtime)
endif()
foreach(folder IN LISTS folders)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/lancet"
          FILES_MATCHING PATTERN "*.hpp")
endforeach()

# The package file asks for what the installed libraries link, and for nothing else: what is wrapped in
# $<BUILD_INTERFACE:...> (headers that only our sources include) is left out.
set(lancet_find_dependencies "")
foreach(library IN LISTS libraries)
  get_target_property(linked ${library} INTERFACE_LINK_LIBRARIES)
  list(FILTER linked EXCLUDE REGEX "BUILD_INTERFACE")
  foreach(target package IN ZIP_LISTS lancet_external_targets lancet_external_packages)
    if("${linked}" MATCHES "${target}")
      list(APPEND lancet_find_dependencies "find_dependency(${package})")
    endif()
  endforeach()
endforeach()
list(REMOVE_DUPLICATES lancet_find_dependencies)
list(JOIN lancet_find_dependencies "\n" lancet_find_dependencies)

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/lancet-config.cmake.in" lancet-config.cmake
                              INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lancet")
write_basic_package_version_file(lancet-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES "${CMAKE_CURRENT_BINARY_DIR}/lancet-config.cmake" "${CMAKE_CURRENT_BINARY_DIR}/lancet-config-version.cmake"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/lancet")
