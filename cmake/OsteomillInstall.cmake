# The installed package: one component per room, with its public headers and library, and one pkg-config file.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/osteomill)
foreach(room IN LISTS OSTEOMILL_ROOMS)
  set_target_properties(osteomill_${room} PROPERTIES EXPORT_NAME ${room})
  install(TARGETS osteomill_${room} EXPORT osteomill_${room} FILE_SET HEADERS)
  install(EXPORT osteomill_${room} NAMESPACE osteomill:: DESTINATION ${package_dir} FILE ${room}.cmake)
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
