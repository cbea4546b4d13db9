#include "osteomill/exercise/recorded_exercise.h"

#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

namespace {

constexpr const char* kFile = "exercise.file";
constexpr const char* kFingerprint = "exercise.fingerprint";
constexpr const char* kTitle = "exercise.title";
constexpr const char* kTrainee = "exercise.trainee";
constexpr const char* kGuidance = "exercise.guidance";

std::string text_of(const RunDescription& run, const char* key) {
  const auto* text = find_setting<std::string>(run, key);
  return text == nullptr ? "" : *text;
}

}  // namespace

void put_exercise(RunDescription& run, const RecordedExercise& exercise) {
  run.settings.push_back({kFile, exercise.file, ""});
  run.settings.push_back({kFingerprint, exercise.fingerprint, ""});
  run.settings.push_back({kTitle, exercise.title, ""});
  if (!exercise.trainee.empty()) run.settings.push_back({kTrainee, exercise.trainee, ""});
  run.settings.push_back({kGuidance, exercise.has_guidance ? 1.0 : 0.0, ""});
}

std::optional<RecordedExercise> recorded_exercise(const RunDescription& run) {
  if (find_setting<std::string>(run, kFile) == nullptr) return std::nullopt;
  const auto* guidance = find_setting<double>(run, kGuidance);
  return RecordedExercise{text_of(run, kFile), text_of(run, kFingerprint), text_of(run, kTitle),
                          text_of(run, kTrainee), guidance == nullptr || *guidance != 0};
}

std::string text_fingerprint(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw InputError(file.string(), with_reason("cannot be read"));
  WordHash hash;
  for (auto byte = std::istreambuf_iterator<char>(in); byte != std::istreambuf_iterator<char>(); ++byte)
    hash.add(static_cast<unsigned char>(*byte));
  return fmt::format("{:016x}", hash.value());
}

}  // namespace osteomill
