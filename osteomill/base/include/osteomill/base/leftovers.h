#pragma once

#include <filesystem>

namespace osteomill {

/// A file or folder that is only meant to be there while this object lives. A program that is asked to end
/// meanwhile (`remove_leftovers_when_ended`) removes it with all that is in it; this object's end does not.
class Leftover {
 public:
  explicit Leftover(const std::filesystem::path& path);
  ~Leftover();
  Leftover(const Leftover&) = delete;
  Leftover& operator=(const Leftover&) = delete;

 private:
  int place_;
};

/// Lets SIGTERM, SIGINT and SIGHUP remove every Leftover before they do what they did; one that is ignored
/// stays so. For a program to call as it starts.
void remove_leftovers_when_ended();

}  // namespace osteomill
