# `cmake --install` as a library: headers, archives, and the package that find_package(Stillpoint) finds, wherever the tree is
# moved to. Components: program (app/CMakeLists.txt), library, dev.
include(CMakePackageConfigHelpers)

set(stillpoint_package lib/cmake/Stillpoint)
set_target_properties(stillpoint_core PROPERTIES EXPORT_NAME core)
set_target_properties(stillpoint_ui PROPERTIES EXPORT_NAME ui)
set_target_properties(stillpoint_options PROPERTIES EXPORT_NAME options)
foreach(room core ui)
  install(TARGETS stillpoint_${room} EXPORT stillpoint_${room} ARCHIVE DESTINATION lib COMPONENT library
          INCLUDES DESTINATION include/stillpoint)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${room} DESTINATION include/stillpoint COMPONENT dev
          FILES_MATCHING PATTERN "*.hpp" PATTERN cmake EXCLUDE)
endforeach()
# Warnings are this project's own affair; what sanitizers need at linking is not.
install(TARGETS stillpoint_options EXPORT stillpoint_core)
foreach(room core ui)
  install(EXPORT stillpoint_${room} FILE Stillpoint_${room}.cmake NAMESPACE Stillpoint:: DESTINATION ${stillpoint_package} COMPONENT dev)
endforeach()

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/StillpointConfig.cmake.in ${PROJECT_BINARY_DIR}/StillpointConfig.cmake
                              INSTALL_DESTINATION ${stillpoint_package})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/StillpointConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/StillpointConfig.cmake ${PROJECT_BINARY_DIR}/StillpointConfigVersion.cmake
        DESTINATION ${stillpoint_package} COMPONENT dev)
