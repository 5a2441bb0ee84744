# What is installed, in three components: `program` (orbifit), `development` (its libraries, their headers and what
# find_package needs) and, where they are built, `baselines` (orbifit-compare, orbifit-benchmark and orbifit::baselines).
# The first two link nothing under the GPL; the third does.
include(CMakePackageConfigHelpers)

set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/orbifit)
configure_file(${CMAKE_CURRENT_LIST_DIR}/orbifitConfig.cmake.in orbifitConfig.cmake @ONLY)
write_basic_package_version_file(orbifitConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/orbifitConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/orbifitConfigVersion.cmake
        DESTINATION ${config_dir} COMPONENT development)
install(EXPORT orbifit_development NAMESPACE orbifit:: FILE orbifitTargets.cmake DESTINATION ${config_dir}
        COMPONENT development)
foreach(library pcl openmesh) # the adapters, each of which is loaded where it is asked for
  install(EXPORT orbifit_interop_${library} NAMESPACE orbifit:: FILE orbifit_${library}.cmake DESTINATION ${config_dir}
          COMPONENT development)
endforeach()
set(components program development)
if(ORBIFIT_BUILD_BASELINES)
  install(EXPORT orbifit_baselines NAMESPACE orbifit:: FILE orbifit_baselines.cmake DESTINATION ${config_dir}
          COMPONENT baselines)
  list(APPEND components baselines)
endif()

# The licence, where Debian looks for that of each package.
set(package_of_program orbifit)
set(package_of_development liborbifit-dev)
set(package_of_baselines orbifit-compare)
foreach(component IN LISTS components)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package_of_${component}}
          RENAME copyright COMPONENT ${component})
endforeach()

if(NOT PROJECT_IS_TOP_LEVEL)
  return()
endif()

# cpack: a .deb of each component, and one .tar.gz of program and libraries.
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_PACKAGE_VENDOR "Orbifit")
set(CPACK_PACKAGE_CONTACT "The authors of Orbifit <orbifit@localhost>")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_PACKAGE_FILE_NAME orbifit-${PROJECT_VERSION}-${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL ${components})
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_LIST_DIR}/cpack_generator.cmake)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME ${package_of_program})
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "finds, keeps and fits the symmetries of 3D shapes")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS orbifit-compare)

# What orbifitConfig.cmake looks for; static libraries have no dependencies that could be found by themselves.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME ${package_of_development})
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "finds, keeps and fits the symmetries of 3D shapes: libraries and headers")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libembree-dev (>= 3.13), libtbb-dev, liblz4-dev, \
libdraco-dev, lib3mf-dev, libzip-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "libpcl-dev, libopenmesh-dev")

set(CPACK_DEBIAN_BASELINES_PACKAGE_NAME ${package_of_baselines})
set(CPACK_DEBIAN_BASELINES_DESCRIPTION "compares Orbifit with least-squares methods; links libraries under the GPL")
set(CPACK_DEBIAN_BASELINES_PACKAGE_DEPENDS "orbifit (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_BASELINES_PACKAGE_SUGGESTS "liborbifit-dev (= ${PROJECT_VERSION}), libceres-dev")

include(CPack)
