#include "osteomill/recording/recording.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace osteomill {

namespace {

bool is_run_alike(const RunDescription& a, const RunDescription& b) {
  const auto settings = [](const RunDescription& run) {
    std::vector<RunSetting> those = run.settings;
    // Not what was set: how the program was called, and what the algorithm made of it.
    std::erase_if(those, [](const RunSetting& setting) {
      return setting.key == kCommandLineKey || setting.key == "sample_points";
    });
    return those;
  };
  return a.algorithm == b.algorithm && a.mode == b.mode && a.isovalue == b.isovalue && a.tool == b.tool &&
         settings(a) == settings(b);
}

}  // namespace

std::vector<Recording> in_stretches(Recording recording) {
  std::vector<std::size_t> first{0};
  const std::vector<RecordedSession>& sessions = recording.sessions;
  for (std::size_t n = 1; n < sessions.size(); ++n) {
    if (sessions[n].first > sessions[first.back()].first &&
        !is_run_alike(sessions[n - 1].start.run, sessions[n].start.run))
      first.push_back(n);
  }
  std::vector<Recording> stretches;
  if (first.size() < 2) {
    stretches.push_back(std::move(recording));
    return stretches;
  }
  for (std::size_t n = 0; n < first.size(); ++n) {
    const RecordedSession& begin = sessions[first[n]];
    const bool last = n + 1 == first.size();
    const std::size_t end = last ? recording.records.size() : sessions[first[n + 1]].first;
    if (begin.first == end) continue;
    Recording stretch{.path = recording.path, .description = begin.start.run};
    stretch.description.phase = "part " + std::to_string(n + 1);
    stretch.records.assign(recording.records.begin() + static_cast<std::ptrdiff_t>(begin.first),
                           recording.records.begin() + static_cast<std::ptrdiff_t>(end));
    stretch.complete = recording.complete;
    stretch.dropped = n == 0 ? recording.dropped : 0;
    stretches.push_back(std::move(stretch));
  }
  for (const RunPicture& picture : recording.pictures) {
    Recording& shown = picture.name == kPictureBefore ? stretches.front() : stretches.back();
    shown.pictures.push_back(picture);
  }
  return stretches;
}

}  // namespace osteomill
