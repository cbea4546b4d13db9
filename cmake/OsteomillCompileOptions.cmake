# What is exact to the bit stands in public headers too, most of it Eigen's, so this is a part of what the libraries ask
# of who links them. No fused multiply-add by accident: the same input must give the same bits at any optimisation level.
# And Eigen's types lie in memory as here whatever processor the user's objects are for.
set(OSTEOMILL_SAME_BITS_OPTIONS -ffp-contract=off)
set(OSTEOMILL_SAME_BITS_DEFINITIONS EIGEN_MAX_ALIGN_BYTES=16)

# What every target of ours is compiled with.
add_library(osteomill_compile_options INTERFACE)
target_compile_options(osteomill_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor ${OSTEOMILL_SAME_BITS_OPTIONS})
target_compile_definitions(osteomill_compile_options INTERFACE ${OSTEOMILL_SAME_BITS_DEFINITIONS})
# Initialisers leave the other members at their defaults on purpose.
target_compile_options(osteomill_compile_options INTERFACE -Wno-missing-field-initializers)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports `"literal" + std::string` as an overlapping copy (its bug 105651).
  target_compile_options(osteomill_compile_options INTERFACE -Wno-restrict)
endif()
if(OSTEOMILL_SANITIZE)
  target_compile_options(osteomill_compile_options INTERFACE
    -fsanitize=${OSTEOMILL_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(OSTEOMILL_SANITIZE MATCHES "address")
    # Checks of every pointer double the building time. The address sanitizer finds null pointers and accesses beyond an
    # object too; misalignment and a wrong dynamic type are then not looked for.
    target_compile_options(osteomill_compile_options INTERFACE -fno-sanitize=null,object-size,vptr,alignment)
  endif()
  target_link_options(osteomill_compile_options INTERFACE -fsanitize=${OSTEOMILL_SANITIZE})
  # The thread sanitizer does not know fences; spsc_queue.h, where they are used, tells it what they order.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND OSTEOMILL_SANITIZE MATCHES "thread")
    target_compile_options(osteomill_compile_options INTERFACE -Wno-tsan)
  endif()
endif()
