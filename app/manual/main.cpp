#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "app/commands.h"
#include "app/manual/command_tree.h"
#include "app/manual/completions.h"
#include "app/manual/manual_pages.h"

namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  if (!(file << text).flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace

// Writes the manual pages and shell completions of osteomill:
//   osteomill_manual VERSION DATE FOLDER
int main(int argc, char** argv) {
  using namespace osteomill::app;
  if (argc != 4) {
    std::fputs("usage: osteomill_manual VERSION DATE FOLDER\n", stderr);
    return 2;
  }
  try {
    const Edition edition{argv[1], argv[2]};
    const std::filesystem::path folder = argv[3];
    const std::unique_ptr<CLI::App> program = make_program("osteomill");
    const std::vector<CommandText> commands = command_texts(*program);
    // Removes pages of commands that no longer exist.
    std::filesystem::remove_all(folder / "man1");
    write(folder / "man1/osteomill.1", program_page(commands, edition));
    for (std::size_t n = 1; n < commands.size(); ++n)
      write(folder / "man1" / ("osteomill-" + commands[n].name + ".1"), command_page(commands[n], edition));
    write(folder / "bash/osteomill", bash_completion(commands));
    write(folder / "zsh/_osteomill", zsh_completion(commands));
    write(folder / "fish/osteomill.fish", fish_completion(commands));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "osteomill_manual: %s\n", error.what());
    return 1;
  }
  return 0;
}
