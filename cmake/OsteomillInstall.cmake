# The installed package: one component per module, with its public headers and library, and one pkg-config file.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/osteomill)
foreach(module IN LISTS OSTEOMILL_MODULES)
  set_target_properties(osteomill_${module} PROPERTIES EXPORT_NAME ${module})
  install(TARGETS osteomill_${module} EXPORT osteomill_${module} FILE_SET HEADERS)
  install(EXPORT osteomill_${module} NAMESPACE osteomill:: DESTINATION ${package_dir} FILE ${module}.cmake)
endforeach()
configure_package_config_file(cmake/osteomillConfig.cmake.in osteomillConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(osteomillConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/osteomillConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/osteomillConfigVersion.cmake
              cmake/FindHDF5C.cmake DESTINATION ${package_dir})

set(pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH prefix_from_pkgconfig_dir /${pkgconfig_dir} /)
list(REVERSE OSTEOMILL_LIBRARIES)
list(TRANSFORM OSTEOMILL_LIBRARIES PREPEND -l OUTPUT_VARIABLE pkgconfig_libraries)
list(JOIN pkgconfig_libraries " " pkgconfig_libraries)
if(OSTEOMILL_OPENIGTLINK)
  set(pkgconfig_openigtlink -lOpenIGTLink)
endif()
configure_file(cmake/osteomill.pc.in osteomill.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/osteomill.pc DESTINATION ${pkgconfig_dir})

install(FILES LICENSE README.md CHANGELOG.md CONTRIBUTING.md CODE_OF_CONDUCT.md SECURITY.md CITATION.cff
        DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY docs exercises studies DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT program)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR})
