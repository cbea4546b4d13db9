// Layers of overlapping segments in 3D Slicer's files (.seg.nrrd): SegmentN_Layer, SegmentN_LabelValue.
#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/base/work_progress.h"

#include "volume_file.h"

namespace osteomill {

namespace {

// Layer of a segment and its value in that layer.
using Place = std::pair<std::uint64_t, float>;

struct Segment {
  Place place;
  std::string value_key;
};

std::vector<Segment> segments_of(const std::map<std::string, std::string>& key_values) {
  std::vector<Segment> segments;
  for (const int n : segment_numbers(key_values)) {
    const auto number = [&](const char* what) -> std::optional<int> {
      const auto found = key_values.find(fmt::format("Segment{}_{}", n, what));
      return found == key_values.end() ? std::nullopt : parse_number<int>(found->second);
    };
    const auto value = number("LabelValue");
    if (!value) continue;
    segments.push_back(
        {{static_cast<std::uint64_t>(std::max(0, number("Layer").value_or(0))), static_cast<float>(*value)},
         fmt::format("Segment{}_LabelValue", n)});
  }
  return segments;
}

bool a_value_has_two_layers(const std::set<Place>& places) {
  std::set<float> values;
  return std::any_of(places.begin(), places.end(),
                     [&](const Place& place) { return !values.insert(place.second).second; });
}

// `at` returns the layer in which a voxel is labelled, and its value there; {0, 0} if none. Throws InputError
// if there are several.
class Layers {
 public:
  Layers(const std::string& subject, const std::vector<float>& values, const VoxelLayers& layers)
      : subject_(subject), values_(values), layers_(layers), voxels_(values.size() / layers.count) {}

  std::uint64_t voxels() const { return voxels_; }
  Place at(std::uint64_t voxel) const {
    Place place{0, 0};
    for (std::uint64_t layer = 0; layer < layers_.count; ++layer) {
      const float value =
          values_[layers_.run_fastest ? voxel * layers_.count + layer : layer * voxels_ + voxel];
      if (value == 0) continue;
      if (place.second != 0) {
        throw InputError(
            subject_,
            fmt::format("has overlapping segments, in {} layers; save it as a label map of one layer",
                        layers_.count));
      }
      place = {layer, value};
    }
    return place;
  }

 private:
  const std::string& subject_;
  const std::vector<float>& values_;
  const VoxelLayers& layers_;
  std::uint64_t voxels_;
};

}  // namespace

std::set<int> segment_numbers(const std::map<std::string, std::string>& key_values) {
  constexpr std::string_view kHead = "Segment";
  std::set<int> numbers;
  for (auto pair = key_values.lower_bound(std::string(kHead));
       pair != key_values.end() && pair->first.starts_with(kHead); ++pair) {
    const std::string_view key = std::string_view(pair->first).substr(kHead.size());
    const auto number = parse_number<int>(key.substr(0, key.find('_')));
    if (number && *number >= 0) numbers.insert(*number);
  }
  return numbers;
}

std::vector<float> merge_layers(const std::string& subject, std::vector<float> values, VolumeHeader& header) {
  const Layers layers(subject, values, header.layers);
  const std::vector<Segment> segments = segments_of(header.key_values);
  std::set<Place> places;
  for (const Segment& segment : segments) places.insert(segment.place);
  std::vector<float> merged;
  merged.reserve(layers.voxels());
  Place last{0, 0};
  for (std::uint64_t voxel = 0; voxel < layers.voxels(); ++voxel) {
    const Place place = layers.at(voxel);
    if (place != last && place.second != 0) places.insert(last = place);
    merged.push_back(place.second);
    WorkProgress::done(0);
  }
  if (!a_value_has_two_layers(places)) return merged;
  std::map<Place, float> numbers;
  for (const Segment& segment : segments) {
    const auto number = static_cast<float>(numbers.size() + 1);
    header.key_values[segment.value_key] =
        fmt::format("{}", numbers.emplace(segment.place, number).first->second);
  }
  for (const Place& place : places) numbers.emplace(place, static_cast<float>(numbers.size() + 1));
  for (std::uint64_t voxel = 0; voxel < layers.voxels(); ++voxel) {
    if (const Place place = layers.at(voxel); place.second != 0) merged[voxel] = numbers.at(place);
  }
  header.warnings.push_back(fmt::format(
      "has the same label values in several of its {} layers; its segments were renumbered from 1",
      header.layers.count));
  return merged;
}

}  // namespace osteomill
