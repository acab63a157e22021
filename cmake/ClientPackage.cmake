# The CMake package Strandcast, for clients in C++: `cmake --install BUILD --component client`. docs/client.md describes it.

# The public headers, listed only here. Each starts with the line "// Public API" and includes no other header of the project;
# the tests of tests/architecture check that, and that exactly these are installed.
set(STRANDCAST_PUBLIC_HEADERS
  core/contact_primitive.h
  core/distance_field.h
  core/error.h
  core/geometry.h
  core/parameters.h
  core/strand_set.h
  transport/codec/codec.h
  transport/dds.h
  transport/lcm.h
  transport/messages.h
  transport/pose_sender.h
  transport/subscriber.h)

foreach(name kernels core transport)
  add_library(Strandcast::${name} ALIAS strandcast_${name})
  set_target_properties(strandcast_${name} PROPERTIES EXPORT_NAME ${name})
endforeach()
if(NOT PROJECT_IS_TOP_LEVEL)
  return()  # a project that contains this one installs only its own files
endif()

foreach(header ${STRANDCAST_PUBLIC_HEADERS})
  string(REGEX MATCH "^[^/]+" name ${header})
  target_sources(strandcast_${name} PUBLIC
    FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${PROJECT_SOURCE_DIR}/${header})
endforeach()

include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/Strandcast)
install(TARGETS strandcast_kernels strandcast_core strandcast_transport EXPORT StrandcastTargets
  ARCHIVE COMPONENT client
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/strandcast COMPONENT client)
install(EXPORT StrandcastTargets NAMESPACE Strandcast:: DESTINATION ${package} COMPONENT client)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/StrandcastConfig.cmake.in
  ${PROJECT_BINARY_DIR}/StrandcastConfig.cmake INSTALL_DESTINATION ${package} NO_SET_AND_CHECK_MACRO)
# Until 1.0 a minor version may change the API.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/StrandcastConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/StrandcastConfig.cmake ${PROJECT_BINARY_DIR}/StrandcastConfigVersion.cmake
  DESTINATION ${package} COMPONENT client)
