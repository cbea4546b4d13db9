# Headers of the libraries: precompiled if enabled, otherwise each compiled alone.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
set(OSTEOMILL_OFTEN_READ <algorithm> <array> <cmath> <filesystem> <functional> <memory> <optional> <string> <vector>
  <Eigen/Core> <Eigen/Geometry>)

# Precompiles common headers once for the libraries and once for the tests, which halves the build time.
function(osteomill_precompile name flags_from)
  file(CONFIGURE OUTPUT ${name}.cpp CONTENT "// Compiles the headers.\n")
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_link_libraries(${name} PRIVATE Eigen3::Eigen ${flags_from})
  target_compile_options(${name} PRIVATE ${OSTEOMILL_SAME_BITS_OPTIONS})
  target_compile_definitions(${name} PRIVATE ${OSTEOMILL_SAME_BITS_DEFINITIONS})
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

# Makes every public header the first include of some source, to detect headers that depend on earlier includes. Generates a source
# for headers that no source of the library includes first.
function(osteomill_compile_alone target)
  get_target_property(headers ${target} HEADER_SET)
  get_target_property(sources ${target} SOURCES)
  get_target_property(folder ${target} SOURCE_DIR)
  set(included_first "")
  foreach(source IN LISTS sources)
    file(STRINGS ${folder}/${source} first REGEX "^#include" LIMIT_COUNT 1)
    list(APPEND included_first ${first})
  endforeach()
  foreach(header IN LISTS headers)
    cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${folder}/include OUTPUT_VARIABLE included)
    if(NOT "#include \"${included}\"" IN_LIST included_first)
      file(CONFIGURE OUTPUT alone/${included}.cpp CONTENT "#include \"${included}\"\n")
      target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/alone/${included}.cpp)
    endif()
  endforeach()
endfunction()

if(OSTEOMILL_PRECOMPILED_HEADERS)
  osteomill_precompile(osteomill_library_headers "" ${OSTEOMILL_OFTEN_READ})
  set_target_properties(osteomill_library_headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
  if(OSTEOMILL_BUILD_TESTS)
    osteomill_precompile(osteomill_test_headers GTest::gtest ${OSTEOMILL_OFTEN_READ} <gtest/gtest.h>)
    target_compile_options(osteomill_test_headers PRIVATE -O1)
  endif()
endif()
