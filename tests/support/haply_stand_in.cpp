// Replaces Haply's service in tests without a device: haply_stand_in PORT

#include "tests/support/haply_stand_in.h"

#include <cstdio>
#include <cstdlib>

#include <unistd.h>

int main(int count, char** words) {
  const osteomill::testing_support::HaplyStandIn service(count > 1 ? std::atoi(words[1]) : 0);
  if (service.port() == 0) return 1;
  std::puts("listens");
  std::fflush(stdout);
  pause();
}
