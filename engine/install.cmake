# find_package(carom) for other projects: headers as they are, the library, the target carom::carom.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/carom)
install(TARGETS carom EXPORT carom-targets)
install(DIRECTORY include/carom DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(EXPORT carom-targets NAMESPACE carom:: DESTINATION ${package_folder})

# A static library does not carry OpenMP with it, so the package asks for it again.
set(needs_openmp FALSE)
get_target_property(library_type carom TYPE)
if(OpenMP_CXX_FOUND AND library_type STREQUAL "STATIC_LIBRARY")
    set(needs_openmp TRUE)
endif()
configure_package_config_file(carom-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/carom-config.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/carom-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/carom-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/carom-config-version.cmake
        DESTINATION ${package_folder})
