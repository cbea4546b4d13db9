# Disables implicit fused multiply-add, because the same input must give the same bits at any optimisation level, and fixes the
# memory layout of Eigen's types for all target processors. osteomill_base passes both on to programs that link it.
set(OSTEOMILL_SAME_BITS_OPTIONS -ffp-contract=off)
set(OSTEOMILL_SAME_BITS_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=16)

# All targets of the project are compiled with these.
add_compile_options(-Wall -Wextra -Wpedantic -Wconversion -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>)
# Designated initialisers leave other members at their defaults on purpose.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-missing-field-initializers>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports `"literal" + std::string` as an overlapping copy (its bug 105651).
  add_compile_options(-Wno-restrict)
endif()
if(OSTEOMILL_SANITIZE)
  add_compile_options(-fsanitize=${OSTEOMILL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(OSTEOMILL_SANITIZE MATCHES "address")
    # Checks of every pointer double the build time. The address sanitizer also finds null pointers and accesses beyond an object;
    # misalignment and wrong dynamic types are not checked.
    add_compile_options(-fno-sanitize=null,object-size,vptr,alignment)
  endif()
  add_link_options(-fsanitize=${OSTEOMILL_SANITIZE})
  # The thread sanitizer does not support fences; spsc_queue.h, which uses them, annotates the ordering.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND OSTEOMILL_SANITIZE MATCHES "thread")
    add_compile_options(-Wno-tsan)
  endif()
endif()
