#include "series_parts.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"

namespace osteomill {

namespace {

using Numbers = std::vector<std::size_t>;

// Slices that share one value, or a range of consecutive values, of a mark.
struct Group {
  std::string first_value;
  std::string last_value;
  Numbers slices;
  // Heights of the slices along the normal, ascending.
  std::vector<double> heights_mm;
};

void add(Group& to, const Group& other) {
  to.last_value = other.last_value;
  to.slices.insert(to.slices.end(), other.slices.begin(), other.slices.end());
  const auto middle = static_cast<std::ptrdiff_t>(to.heights_mm.size());
  to.heights_mm.insert(to.heights_mm.end(), other.heights_mm.begin(), other.heights_mm.end());
  std::inplace_merge(to.heights_mm.begin(), to.heights_mm.begin() + middle, to.heights_mm.end());
}

bool have_common_position(const Group& a, const Group& b) {
  if (a.heights_mm.size() < b.heights_mm.size()) return have_common_position(b, a);
  return std::any_of(b.heights_mm.begin(), b.heights_mm.end(), [&](double height_mm) {
    const auto near = std::upper_bound(a.heights_mm.begin(), a.heights_mm.end(), height_mm - kSamePlace_mm);
    return near != a.heights_mm.end() && *near < height_mm + kSamePlace_mm;
  });
}

// Returns whether the ranges of two groups of at least `least_slices` slices overlap.
bool overlap(const Group& a, const Group& b, std::size_t least_slices) {
  return a.slices.size() >= least_slices && b.slices.size() >= least_slices &&
         a.heights_mm.front() < b.heights_mm.back() && b.heights_mm.front() < a.heights_mm.back();
}

// Orders values numerically, then alphabetically; derived images after originals.
bool is_less(const std::string& a, const std::string& b) {
  const auto place = [](const std::string& text) {
    return std::pair(text.starts_with("DERIVED"),
                     parse_number<double>(text).value_or(-std::numeric_limits<double>::infinity()));
  };
  return std::pair(place(a), a) < std::pair(place(b), b);
}

// Splits one series into parts.
class SeriesSplitter {
 public:
  SeriesSplitter(std::span<const SlicePlane> slices, std::span<const SliceMarks> marks,
                 const SamePixels& same_pixels)
      : slices_(slices), marks_(marks), same_pixels_(same_pixels) {}

  std::vector<SeriesPart> parts() const;

 private:
  std::vector<Numbers> by_shape() const;
  // Splits `part` recursively and appends the result to `parts`.
  void split(SeriesPart part, std::vector<SeriesPart>& parts) const;
  // Groups slices by value, in order of the values.
  std::vector<Group> by_value(const Numbers& slices, std::size_t mark) const;
  // Returns the groups that the mark distinguishes; empty if it does not.
  std::vector<Group> by_mark(const Numbers& slices, std::size_t mark) const;
  // Returns nullopt if the slices do not form a volume.
  std::optional<SliceStack> stacked(const Numbers& slices, bool by_number = false) const;
  bool is_volume(const Numbers& slices, bool by_number = false) const {
    return stacked(slices, by_number).has_value();
  }
  // Returns the minimum size of groups whose ranges must not overlap. A single slice may lie between others
  // of its volume if they are even with it.
  std::size_t least_group(const Numbers& slices, std::span<const Group> values) const;
  bool are_volumes(std::span<const Group> groups) const {
    return std::all_of(groups.begin(), groups.end(), [&](const Group& group) {
      return group.slices.size() < 2 || is_volume(group.slices);
    });
  }

  std::span<const SlicePlane> slices_;
  std::span<const SliceMarks> marks_;
  const SamePixels& same_pixels_;
};

std::vector<Numbers> SeriesSplitter::by_shape() const {
  std::vector<Numbers> shapes;
  for (std::size_t n = 0; n < slices_.size(); ++n) {
    const auto shape = std::find_if(shapes.begin(), shapes.end(), [&](const Numbers& of) {
      return difference_of(slices_[of.front()], slices_[n]) == nullptr;
    });
    (shape == shapes.end() ? shapes.emplace_back() : *shape).push_back(n);
  }
  return shapes;
}

std::optional<SliceStack> SeriesSplitter::stacked(const Numbers& slices, bool by_number) const {
  std::vector<SlicePlane> planes;
  for (const std::size_t n : slices) {
    planes.push_back(slices_[n]);
    if (!by_number) planes.back().number.reset();
  }
  try {
    return stack_slices("", planes,
                        [&](std::size_t a, std::size_t b) { return same_pixels_(slices[a], slices[b]); });
  } catch (const InputError&) {
    return std::nullopt;
  }
}

std::size_t SeriesSplitter::least_group(const Numbers& slices, std::span<const Group> values) const {
  const auto is_single = [](const Group& group) { return group.slices.size() == 1; };
  if (std::none_of(values.begin(), values.end(), is_single) ||
      std::all_of(values.begin(), values.end(), is_single))
    return 2;
  const std::optional<SliceStack> stack = stacked(slices);
  return stack && !stack->heights_mm.empty() ? 1 : 2;
}

std::vector<Group> SeriesSplitter::by_value(const Numbers& slices, std::size_t mark) const {
  Numbers sorted = slices;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](std::size_t a, std::size_t b) { return is_less(marks_[a][mark], marks_[b][mark]); });
  const SlicePlane& first = slices_[slices.front()];
  const Vec3 normal = first.i_direction.cross(first.j_direction);
  std::vector<Group> groups;
  for (const std::size_t n : sorted) {
    const std::string& value = marks_[n][mark];
    if (groups.empty() || groups.back().first_value != value) groups.push_back({value, value, {}, {}});
    groups.back().slices.push_back(n);
    groups.back().heights_mm.push_back(normal.dot(slices_[n].position_mm));
  }
  for (Group& group : groups) std::sort(group.heights_mm.begin(), group.heights_mm.end());
  return groups;
}

// Joins consecutive values as long as they do not collide.
std::vector<Group> joined(const std::vector<Group>& values, const auto& collide) {
  std::vector<Group> groups;
  for (const Group& value : values) {
    if (groups.empty() || collide(groups.back(), value)) {
      groups.push_back(value);
    } else {
      add(groups.back(), value);
    }
  }
  return groups;
}

// Returns whether any two groups with overlapping ranges collide.
bool any_collide(std::vector<Group> groups, const auto& collide) {
  std::sort(groups.begin(), groups.end(),
            [](const Group& a, const Group& b) { return a.heights_mm.front() < b.heights_mm.front(); });
  for (std::size_t n = 0; n < groups.size(); ++n) {
    for (std::size_t m = n + 1;
         m < groups.size() && groups[m].heights_mm.front() <= groups[n].heights_mm.back() + kSamePlace_mm;
         ++m) {
      if (collide(groups[n], groups[m])) return true;
    }
  }
  return false;
}

std::vector<Group> SeriesSplitter::by_mark(const Numbers& slices, std::size_t mark) const {
  const MarkKind& kind = kMarkKinds[mark];
  const std::vector<Group> values = by_value(slices, mark);
  if (values.size() < 2) return {};
  const bool at_one_place = any_collide(values, have_common_position);
  const std::size_t least = kind.is_of_slices ? 2 : least_group(slices, values);
  const auto intrude = [&](const Group& a, const Group& b) { return overlap(a, b, least); };
  const auto collide = [&](const Group& a, const Group& b) {
    return have_common_position(a, b) || (!kind.is_of_slices && intrude(a, b));
  };
  if (!at_one_place && (kind.is_of_slices || !any_collide(values, intrude))) return {};
  // Coincident slices that still form a volume are copies or have rounded positions.
  if (at_one_place && is_volume(slices, kind.is_of_slices)) return {};
  const std::vector<Group> groups = kind.is_ordered ? joined(values, collide) : values;
  if (groups.size() < 2 || 2 * groups.size() > slices.size()) return {};
  if (kind.is_of_slices) {
    const bool alike = std::all_of(groups.begin(), groups.end(), [&](const Group& group) {
      return group.slices.size() == groups.front().slices.size();
    });
    return alike && are_volumes(groups) ? groups : std::vector<Group>{};
  }
  // One volume, some of whose slices have another mark.
  if (!at_one_place && !are_volumes(groups) && is_volume(slices)) return {};
  return groups;
}

void SeriesSplitter::split(SeriesPart part, std::vector<SeriesPart>& parts) const {
  for (std::size_t mark = 0; mark < kMarkKinds.size(); ++mark) {
    for (Group& group : by_mark(part.slices, mark)) {
      std::string value = group.first_value == group.last_value
                              ? group.first_value
                              : group.first_value + " to " + group.last_value;
      if (value.empty()) value = "not given";
      std::sort(group.slices.begin(), group.slices.end());
      split({std::move(group.slices),
             fmt::format("{}{}{} {}", part.distinguishing_marks,
                         part.distinguishing_marks.empty() ? "" : ", ", kMarkKinds[mark].name, value)},
            parts);
      part.slices.clear();
    }
    if (part.slices.empty()) return;
  }
  parts.push_back(std::move(part));
}

std::vector<SeriesPart> SeriesSplitter::parts() const {
  std::vector<SeriesPart> parts;
  for (Numbers& shape : by_shape()) split({std::move(shape), ""}, parts);
  return parts;
}

}  // namespace

std::vector<SeriesPart> split_series(std::span<const SlicePlane> slices, std::span<const SliceMarks> marks,
                                     const SamePixels& same_pixels) {
  return SeriesSplitter(slices, marks, same_pixels).parts();
}

}  // namespace osteomill
