// Replaces 3D Slicer in tests: igtl_stand_in PORT

#include "tests/support/igtl_stand_in.h"

#include <cstdio>
#include <cstdlib>

#include <unistd.h>

int main(int count, char** words) {
  const osteomill::testing_support::IgtlStandIn server(count > 1 ? std::atoi(words[1]) : 0);
  std::puts("listens");
  std::fflush(stdout);
  pause();
}
