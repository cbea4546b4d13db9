#pragma once

#include <string>

namespace osteomill {

/// While it lives, what the program writes to standard error goes to memory: libjpeg and OpenJPEG, deep
/// within GDCM, complain there and nowhere else. The whole program is affected, so only round a call that is
/// short.
class CapturedStderr {
 public:
  CapturedStderr();
  ~CapturedStderr();
  CapturedStderr(const CapturedStderr&) = delete;
  CapturedStderr& operator=(const CapturedStderr&) = delete;

  /// What was written so far.
  std::string text() const;

 private:
  int stderr_ = -1;
  int memory_ = -1;
};

}  // namespace osteomill
