# What find_package(kervan) needs, and the data files that the program looks up.
include(CMakePackageConfigHelpers)

install(EXPORT kervanTargets NAMESPACE kervan:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kervan)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/kervan-config.cmake.in
  ${CMAKE_CURRENT_BINARY_DIR}/kervan-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kervan
  PATH_VARS CMAKE_INSTALL_LIBDIR CMAKE_INSTALL_DATADIR)
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/kervan-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES
  ${CMAKE_CURRENT_BINARY_DIR}/kervan-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/kervan-config-version.cmake
  ${PROJECT_SOURCE_DIR}/cmake/KervanComponent.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/kervan)

# The data that the program looks up in share/kervan.
install(DIRECTORY
  ${PROJECT_SOURCE_DIR}/deploy/compositions
  ${PROJECT_SOURCE_DIR}/deploy/lab/experiments
  ${PROJECT_SOURCE_DIR}/sim/worlds
  ${PROJECT_SOURCE_DIR}/sim/robots
  DESTINATION ${CMAKE_INSTALL_DATADIR}/kervan
  FILES_MATCHING PATTERN "*.yaml")
