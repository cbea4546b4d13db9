# What every target of ours is compiled with.
add_library(osteomill_compile_options INTERFACE)
# No fused multiply-add by accident: the same input must give the same bits at any optimisation level.
target_compile_options(osteomill_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wnon-virtual-dtor -Werror -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Designated initialisers leave the other members at their defaults on purpose.
  target_compile_options(osteomill_compile_options INTERFACE -Wno-missing-field-initializers)
  # GCC 12 reports `"literal" + std::string` as an overlapping copy (its bug 105651).
  target_compile_options(osteomill_compile_options INTERFACE -Wno-restrict)
endif()
if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  # It warns of other things than GCC, with which osteomill is built; only scripts/fuzz needs it.
  target_compile_options(osteomill_compile_options INTERFACE -Wno-error)
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
