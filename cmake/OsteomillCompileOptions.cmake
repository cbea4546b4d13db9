# No fused multiply-add by accident: the same input must give the same bits at any optimisation level. And Eigen's types
# lie in memory as here whatever processor the user's objects are for. osteomill_base hands both on to who links it.
set(OSTEOMILL_SAME_BITS_OPTIONS -ffp-contract=off)
set(OSTEOMILL_SAME_BITS_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=16)

# Every target of ours is compiled with these.
add_compile_options(-Wall -Wextra -Wpedantic -Wconversion -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor>)
# Initialisers leave the other members at their defaults on purpose.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-Wno-missing-field-initializers>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports `"literal" + std::string` as an overlapping copy (its bug 105651).
  add_compile_options(-Wno-restrict)
endif()
if(OSTEOMILL_SANITIZE)
  add_compile_options(-fsanitize=${OSTEOMILL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(OSTEOMILL_SANITIZE MATCHES "address")
    # Checks of every pointer double the building time. The address sanitizer finds null pointers and accesses beyond an
    # object too; misalignment and a wrong dynamic type are then not looked for.
    add_compile_options(-fno-sanitize=null,object-size,vptr,alignment)
  endif()
  add_link_options(-fsanitize=${OSTEOMILL_SANITIZE})
  # The thread sanitizer does not know fences; spsc_queue.h, where they are used, tells it what they order.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND OSTEOMILL_SANITIZE MATCHES "thread")
    add_compile_options(-Wno-tsan)
  endif()
endif()
