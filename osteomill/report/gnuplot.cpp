#include "osteomill/report/gnuplot.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/files/input_error.h"
#include "osteomill/report/valid_utf8.h"

extern char** environ;

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScript = "script.gp";
constexpr const char* kLog = "gnuplot.log";

void write_script(const fs::path& path, const std::string& script) {
  std::ofstream out(path, std::ios::binary);
  out << valid_utf8(script);
  out.close();
  if (!out) throw InputError(path.string(), "cannot be written (is the disk full?)");
}

std::string last_line(const fs::path& path) {
  std::ifstream in(path);
  std::string last;
  for (std::string line; std::getline(in, line);) {
    if (line.find_first_not_of(" \t^") != std::string::npos) last = line;
  }
  return last;
}

// What the child does before it becomes gnuplot: its folder, no input, and all it says into a file.
class ChildSetup {
 public:
  explicit ChildSetup(const fs::path& folder) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawn_file_actions_addchdir_np(&actions_, folder.c_str());
    ::posix_spawn_file_actions_addopen(&actions_, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, kLog, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    // gnuplot does not look at what could not be written; a limit to its files ends it.
    ::posix_spawnattr_init(&attributes_);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF);
    sigset_t signals;
    ::sigemptyset(&signals);
    ::sigaddset(&signals, SIGXFSZ);
    ::posix_spawnattr_setsigdefault(&attributes_, &signals);
  }
  ~ChildSetup() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  ChildSetup(const ChildSetup&) = delete;
  ChildSetup& operator=(const ChildSetup&) = delete;
  const posix_spawn_file_actions_t* actions() const { return &actions_; }
  const posix_spawnattr_t* attributes() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_;
  posix_spawn_file_actions_t actions_;
};

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return -1;
  }
  return status;
}

}  // namespace

void run_gnuplot(const fs::path& folder, const std::string& script, const std::string& program) {
  write_script(folder / kScript, script);
  const ChildSetup setup(folder);
  // -d: the settings of the user's own must not change the figures.
  std::string name = program, defaults = "-d", file = kScript;
  char* const arguments[] = {name.data(), defaults.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failed =
      ::posix_spawnp(&child, program.c_str(), setup.actions(), setup.attributes(), arguments, environ);
  if (failed == ENOENT) {
    throw InputError(program,
                     "is not installed, and without it no figures can be drawn (package gnuplot-nox)");
  }
  if (failed != 0) throw InputError(program, std::string("cannot be started: ") + std::strerror(failed));
  const int status = wait_for(child);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError(program, "could not draw a figure: " + last_line(folder / kLog));
  }
}

std::string gnuplot_quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) continue;
    quoted += c;
    if (c == '\'') quoted += c;
  }
  return quoted + "'";
}

}  // namespace osteomill
