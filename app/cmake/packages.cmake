# What a desktop and a shell look for beside the program, and four Debian packages by `cpack`: stillpoint, which needs none of
# the others; stillpoint-media, the module of codecs, with the 170 packages it brings along; libstillpoint, the archives; and
# libstillpoint-dev, with which programs are built on them.
set(desktop ${PROJECT_SOURCE_DIR}/assets/desktop)
install(FILES ${desktop}/stillpoint.desktop DESTINATION share/applications COMPONENT program)
install(FILES ${desktop}/stillpoint.svg DESTINATION share/icons/hicolor/scalable/apps COMPONENT program)
install(FILES ${desktop}/stillpoint-mime.xml DESTINATION share/mime/packages RENAME stillpoint.xml COMPONENT program)
install(FILES ${desktop}/org.stillpoint.Stillpoint.metainfo.xml DESTINATION share/metainfo COMPONENT program)
install(DIRECTORY ${stillpoint_manual}/man/ DESTINATION share/man/man1 COMPONENT program)
install(FILES ${stillpoint_manual}/completions/stillpoint DESTINATION share/bash-completion/completions COMPONENT program)
install(FILES ${stillpoint_manual}/completions/stillpoint.fish DESTINATION share/fish/vendor_completions.d COMPONENT program)
# zsh has one place for what a distribution brings, and another for the rest.
install(CODE "
  set(zsh site-functions)
  if(CMAKE_INSTALL_PREFIX STREQUAL \"/usr\")
    set(zsh vendor-completions)
  endif()
  file(INSTALL \"${stillpoint_manual}/completions/_stillpoint\" DESTINATION \"\${CMAKE_INSTALL_PREFIX}/share/zsh/\${zsh}\")"
        COMPONENT program)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME stillpoint)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_COMPONENTS_ALL program media library dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/app/cmake/finish_packages.cmake)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "The Stillpoint founders <founders@stillpoint.invalid>")
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME stillpoint)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
# Loaded by name, where dpkg-shlibdeps does not see them: the window's OpenGL, and its drivers.
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "libgl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS stillpoint-media)
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "visual debugger for visual odometry in dynamic scenes
Stillpoint runs RGB-D and stereo visual odometry on a sequence, takes out
what is dynamic before the camera's motion is estimated, and shows frame by
frame what was classified as dynamic, why, and whether removing it helped: in
a window, as images, tables and pages.")

set(CPACK_DEBIAN_MEDIA_PACKAGE_NAME stillpoint-media)
set(CPACK_DEBIAN_MEDIA_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MEDIA_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_MEDIA_PACKAGE_ENHANCES stillpoint)
set(CPACK_DEBIAN_MEDIA_DESCRIPTION "visual odometry in dynamic scenes - videos and more image formats
Stillpoint reads and writes PNG and JPEG by itself. This module has it write
videos, and read TIFF, BMP, WebP and what else OpenCV reads.")

set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libstillpoint)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_DESCRIPTION "visual odometry in dynamic scenes - static libraries
The archives of Stillpoint: motion methods, odometry engines and evaluation,
and the panels that show them.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libstillpoint-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
# What the archives are linked with is among what the project is built with.
file(STRINGS ${PROJECT_SOURCE_DIR}/app/setup build_packages REGEX "^  .*-dev")
string(REGEX MATCHALL "[a-z0-9-]+-dev" build_packages "${build_packages}")
list(FILTER build_packages EXCLUDE REGEX "gtest|gmock|benchmark|cli11|egl")
list(JOIN build_packages ", " build_packages)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libstillpoint (= ${PROJECT_VERSION}), stillpoint (= ${PROJECT_VERSION}), pkg-config, ${build_packages}")
set(CPACK_DEBIAN_DEV_DESCRIPTION "visual odometry in dynamic scenes - development files
Headers of Stillpoint, and its package for CMake: find_package(Stillpoint)
gives Stillpoint::core and Stillpoint::ui. A motion method of one's own is
run, measured and shown by them as any other.")
include(CPack)
