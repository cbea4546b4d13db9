add_custom_target(tests)  # All test programs of OSTEOMILL_TESTS.

# osteomill_test(NAME SOURCES ... LINK ... [INSIDES modules...] [IN release] [THREADS filter]): a GoogleTest program, which may
# include private headers of those modules. ctest runs it in two shards, so that it reads its scans at most twice and not once per
# test. Each program belongs to one preset (OSTEOMILL_TESTS): the one with the address and undefined-behaviour sanitizers, or, with
# IN release, the release preset, for tests of targets that the sanitizer presets do not build and for tests of exact bits. Tests
# that match the THREADS filter also run under the thread sanitizer.
function(osteomill_test name)
  cmake_parse_arguments(TEST "" "" "SOURCES;LINK;INSIDES;IN;THREADS" ${ARGN})
  add_executable(${name} ${TEST_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  foreach(module IN LISTS TEST_INSIDES)
    target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/osteomill/${module}/src)
  endforeach()
  target_link_libraries(${name} PRIVATE ${TEST_LINK} GTest::gtest GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE
    OSTEOMILL_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  # The tested libraries are fully optimised; optimising the tests themselves only adds minutes of build time.
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
