# Headers that nearly every file reads, compiled once for the libraries and once for the tests: half the building time.
# The dev preset goes without, so that a file that forgets an include is found out.
function(osteomill_precompile name flags_from)
  file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp.new "// Compiles the headers.\n")
  file(COPY_FILE ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp.new ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp ONLY_IF_DIFFERENT)
  add_library(${name} OBJECT ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  target_compile_features(${name} PRIVATE cxx_std_20)
  target_link_libraries(${name} PRIVATE osteomill_compile_options Eigen3::Eigen ${flags_from})
  target_precompile_headers(${name} PRIVATE ${ARGN})
endfunction()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
set(OSTEOMILL_OFTEN_READ <algorithm> <array> <cmath> <filesystem> <functional> <memory> <optional> <string> <vector>
  <Eigen/Core> <Eigen/Geometry>)
osteomill_precompile(osteomill_library_headers "" ${OSTEOMILL_OFTEN_READ})
set_target_properties(osteomill_library_headers PROPERTIES POSITION_INDEPENDENT_CODE ON)
if(OSTEOMILL_BUILD_TESTS)
  osteomill_precompile(osteomill_test_headers GTest::gtest ${OSTEOMILL_OFTEN_READ} <gtest/gtest.h>)
  target_compile_options(osteomill_test_headers PRIVATE -O1)
endif()
