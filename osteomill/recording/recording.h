#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/recording/run_description.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// A picture that belongs to a recording, as the bytes of a PNG file.
struct RunPicture {
  std::string name;
  std::vector<unsigned char> png;
};

/// The names of the pictures that reports lay side by side: the bone before the run and after it.
inline constexpr std::string_view kPictureBefore = "before";
inline constexpr std::string_view kPictureAfter = "after";

/// The key of the further setting of a run that has no pictures because OpenGL could not be had.
inline constexpr std::string_view kPicturesKey = "pictures";

/// One run, a record a tick.
struct Recording {
  /// Where it was read from; errors name it.
  std::filesystem::path path;
  RunDescription description;
  std::vector<TickRecord> records;
  /// Sorted by name.
  std::vector<RunPicture> pictures;
  /// False where the program ended before it closed the recording; the last tenth of a second or so is
  /// missing.
  bool complete = true;
  /// Ticks that found the recorder's queue full and are not among `records`.
  std::uint64_t dropped = 0;
};

}  // namespace osteomill
