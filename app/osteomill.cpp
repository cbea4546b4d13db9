#include "app/commands.h"

int main(int argc, char** argv) {
  return osteomill::app::run_program(argc, argv);
}
