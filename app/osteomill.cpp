#include "app/commands.h"

int main(int argc, char** argv) {
  return osteomill::app::run_osteomill(argc, argv);
}
