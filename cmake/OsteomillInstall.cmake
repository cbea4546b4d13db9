# The installed package: headers, libraries, and what find_package(osteomill) reads.
include(CMakePackageConfigHelpers)

get_property(stages GLOBAL PROPERTY OSTEOMILL_STAGES)
list(TRANSFORM stages PREPEND osteomill_ OUTPUT_VARIABLE stage_targets)
add_library(osteomill_all INTERFACE)
add_library(osteomill::osteomill ALIAS osteomill_all)
set_target_properties(osteomill_all PROPERTIES EXPORT_NAME osteomill)
target_link_libraries(osteomill_all INTERFACE ${stage_targets})

install(TARGETS ${stage_targets} osteomill_all EXPORT osteomillTargets)
install(DIRECTORY osteomill/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/osteomill FILES_MATCHING PATTERN "*.h"
  PATTERN "*_samples.h" EXCLUDE PATTERN "temporary_folder.h" EXCLUDE PATTERN "mesh_checks.h" EXCLUDE)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/osteomill)
install(EXPORT osteomillTargets NAMESPACE osteomill:: DESTINATION ${package_dir})
configure_package_config_file(cmake/osteomillConfig.cmake.in osteomillConfig.cmake
  INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(osteomillConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/osteomillConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/osteomillConfigVersion.cmake DESTINATION ${package_dir})
