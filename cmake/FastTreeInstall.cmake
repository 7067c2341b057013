# SPDX-License-Identifier: Apache-2.0
# Installing the library: headers, the CMake package FastTree (target FastTree::fasttree), the
# pkg-config module fasttree, and the licence. All of it is the component `library`, so that
#   cmake --install build --component library --prefix /where
# needs nothing else to be built.
include(CMakePackageConfigHelpers)

set_target_properties(fasttree PROPERTIES
  VERSION ${PROJECT_VERSION}
  SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})  # before 1.0 a minor may break

if(NOT FASTTREE_INSTALL)
  return()
endif()

set(FASTTREE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/FastTree)

install(TARGETS fasttree EXPORT FastTreeTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT library NAMELINK_COMPONENT library
        RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT library)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/fasttree
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT library FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT library OPTIONAL)

# CMake package. A static library brings its own needs along; a shared one has them linked in.
get_target_property(fasttree_type fasttree TYPE)
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/FastTreeConfig.cmake.in
  ${PROJECT_BINARY_DIR}/FastTreeConfig.cmake
  INSTALL_DESTINATION ${FASTTREE_CMAKE_DIR})
write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/FastTreeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/FastTreeConfig.cmake
              ${PROJECT_BINARY_DIR}/FastTreeConfigVersion.cmake
        DESTINATION ${FASTTREE_CMAKE_DIR} COMPONENT library)
install(EXPORT FastTreeTargets NAMESPACE FastTree:: DESTINATION ${FASTTREE_CMAKE_DIR}
        COMPONENT library)

# pkg-config. Where the library is static, its needs are those of everybody who links it, so they
# are public and `pkg-config --libs` is enough; --static is right in both cases.
if(fasttree_type STREQUAL "SHARED_LIBRARY")
  set(FASTTREE_PC_NEEDS "Requires.private: tbb libhwy\nLibs.private: -lstdc++ -lm")
  set(FASTTREE_PC_LIBS "-lfasttree")
else()
  set(FASTTREE_PC_NEEDS "Requires: tbb libhwy")
  set(FASTTREE_PC_LIBS "-lfasttree -lstdc++ -lm")
endif()
# A prefix relative to the file lets the installed tree be moved.
file(RELATIVE_PATH FASTTREE_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(${PROJECT_SOURCE_DIR}/cmake/fasttree.pc.in ${PROJECT_BINARY_DIR}/fasttree.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/fasttree.pc
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
