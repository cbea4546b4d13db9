# osteomill_stage(NAME
#   HEADERS what a user may include: installed, and all that app, verification and examples may use; the rest are insides
#   SOURCES ...
#   USES stages...
#   PACKAGES "HDF5 COMPONENTS C"...  what LINK and LINK_PRIVATE need, as find_package takes it; the installed package
#                                    looks for the same, component by component
#   LINK libraries in the headers; LINK_PRIVATE libraries in the sources alone
#   ALONE sources that share a name of their own with another and are not compiled in one piece with others
#   TESTS ... TEST_LINK ... TEST_IN ... TEST_THREADS ...  see osteomill_test)
# One folder, one library osteomill_NAME, one component osteomill::NAME, one test program osteomill_NAME_test.
macro(osteomill_stage name)
  cmake_parse_arguments(STAGE "" "" "HEADERS;SOURCES;ALONE;USES;PACKAGES;LINK;LINK_PRIVATE;TESTS;TEST_LINK;TEST_IN;TEST_THREADS"
    ${ARGN})
  # Packages are found in the folder's own scope, where its tests can link them too.
  foreach(package IN LISTS STAGE_PACKAGES)
    separate_arguments(package)
    find_package(${package} REQUIRED)
  endforeach()
  osteomill_add_stage(${name})
endmacro()

function(osteomill_add_stage name)
  set(target osteomill_${name})
  add_library(${target} STATIC ${STAGE_SOURCES})
  # Highway compiles a kernel's file several times.
  set(alone ${STAGE_SOURCES})
  list(FILTER alone INCLUDE REGEX "_kernel\\.cpp$")
  list(APPEND alone ${STAGE_ALONE})
  if(alone)
    set_source_files_properties(${alone} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  add_library(osteomill::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${STAGE_HEADERS})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} INTERFACE ${OSTEOMILL_SAME_BITS_OPTIONS})
  target_compile_definitions(${target} INTERFACE ${OSTEOMILL_SAME_BITS_DEFINITIONS})
  list(TRANSFORM STAGE_USES PREPEND osteomill_ OUTPUT_VARIABLE uses)
  target_link_libraries(${target} PUBLIC ${uses} ${STAGE_LINK}
    PRIVATE $<BUILD_INTERFACE:osteomill_compile_options> ${STAGE_LINK_PRIVATE})
  add_dependencies(libraries ${target})
  if(OSTEOMILL_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM osteomill_library_headers)
  else()
    osteomill_compile_alone(${target} ${STAGE_HEADERS})
  endif()
  # What the installed package tells of the stage (OsteomillInstall.cmake).
  set_property(GLOBAL APPEND PROPERTY OSTEOMILL_STAGES ${name})
  foreach(said USES PACKAGES LINK LINK_PRIVATE)
    set_property(GLOBAL PROPERTY OSTEOMILL_${name}_${said} "${STAGE_${said}}")
  endforeach()
  if(OSTEOMILL_BUILD_TESTS AND STAGE_TESTS)
    osteomill_test(${target}_test SOURCES ${STAGE_TESTS} LINK ${target} ${STAGE_TEST_LINK}
      IN ${STAGE_TEST_IN} THREADS ${STAGE_TEST_THREADS})
  endif()
endfunction()

# Every header is the first that a source includes, so that one which lives by another before it is found out; a source is
# made for those that none of the stage's own includes first.
function(osteomill_compile_alone target)
  foreach(header IN LISTS ARGN)
    file(RELATIVE_PATH included ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/${header})
    string(REGEX REPLACE "\\.h$" ".cpp" source ${header})
    set(first "")
    if(EXISTS ${CMAKE_CURRENT_SOURCE_DIR}/${source})
      file(STRINGS ${CMAKE_CURRENT_SOURCE_DIR}/${source} first REGEX "^#include" LIMIT_COUNT 1)
    endif()
    if(NOT first STREQUAL "#include \"${included}\"")
      file(CONFIGURE OUTPUT alone/${source} CONTENT "#include \"${included}\"\n")
      target_sources(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/alone/${source})
    endif()
  endforeach()
endfunction()

# osteomill_test(NAME SOURCES ... LINK ... [IN release] [THREADS filter]): a GoogleTest program. ctest runs it in two
# shards, so that a program reads its scans once or twice and not once a test. Each belongs to one preset (OSTEOMILL_TESTS):
# to that with the address and undefined-behaviour sanitizers, or to release where it says so, for what those do not build
# or what is held to the last bit. Tests that match the filter have threads and run under the thread sanitizer too.
function(osteomill_test name)
  cmake_parse_arguments(TEST "" "" "SOURCES;LINK;IN;THREADS" ${ARGN})
  add_executable(${name} ${TEST_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE osteomill_compile_options ${TEST_LINK} GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    OSTEOMILL_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  # What is tested is optimised as users run it; optimising the tests themselves only costs minutes of building.
  target_compile_options(${name} PRIVATE -O1)
  if(OSTEOMILL_PRECOMPILED_HEADERS)
    target_precompile_headers(${name} REUSE_FROM osteomill_test_headers)
  endif()
  if(OSTEOMILL_TESTS STREQUAL "threads" AND NOT TEST_THREADS OR OSTEOMILL_TESTS STREQUAL "memory" AND TEST_IN
     OR OSTEOMILL_TESTS STREQUAL "release" AND NOT TEST_IN STREQUAL "release")
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    return()
  endif()
  add_dependencies(tests ${name})
  if(NOT OSTEOMILL_TESTS STREQUAL "threads")
    set(TEST_THREADS "*")
  endif()
  foreach(shard 0 1)
    add_test(NAME ${name}.${shard} COMMAND ${name} --gtest_brief=1 "--gtest_filter=${TEST_THREADS}")
    set_tests_properties(${name}.${shard} PROPERTIES TIMEOUT 600
      ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()

# osteomill_use_openigtlink(TARGETS...): its headers for those that there are. Its own package would put compiler flags on
# everything.
function(osteomill_use_openigtlink)
  find_path(OPENIGTLINK_HEADERS igtlMessageBase.h PATH_SUFFIXES openigtlink REQUIRED)
  foreach(target IN LISTS ARGN)
    if(TARGET ${target})
      target_include_directories(${target} SYSTEM PRIVATE ${OPENIGTLINK_HEADERS})
    endif()
  endforeach()
endfunction()
