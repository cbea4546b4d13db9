#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "slice_stack.h"

namespace osteomill {

/// Header value that distinguishes acquisitions, phases or time points within a series.
struct MarkKind {
  const char* name;
  /// Slices are ordered by its numbers, so that several consecutive values may form one part.
  bool is_ordered;
  /// May differ between slices of one volume; used only if slices coincide in position.
  bool is_of_slices;
};

/// Marks in order of significance.
inline constexpr std::array<MarkKind, 29> kMarkKinds{{{"modality", false, false},
                                                      {"study", false, false},
                                                      {"series number", false, false},
                                                      {"image type", false, false},
                                                      {"stack", false, false},
                                                      {"temporal position", true, false},
                                                      {"frame reference time", true, false},
                                                      {"cardiac phase", true, false},
                                                      {"acquisition", true, false},
                                                      {"series time", false, false},
                                                      {"frame of reference", false, false},
                                                      {"patient position", false, false},
                                                      {"description", false, false},
                                                      {"protocol", false, false},
                                                      {"echo time", false, false},
                                                      {"echo", false, false},
                                                      {"inversion time", false, false},
                                                      {"flip angle", false, false},
                                                      {"contrast agent", false, false},
                                                      {"tube voltage", false, false},
                                                      {"filter", false, false},
                                                      {"kernel", false, false},
                                                      {"field of view", false, false},
                                                      {"b-value", false, false},
                                                      {"slice thickness", false, false},
                                                      {"acquisition time", true, true},
                                                      {"trigger time", true, true},
                                                      {"content time", true, true},
                                                      {"instance number", true, true}}};
/// Header texts of a slice in the order of kMarkKinds; empty if missing.
using SliceMarks = std::array<std::string, kMarkKinds.size()>;

/// Slices of a series that lie on one grid.
struct SeriesPart {
  /// Slice indices, ascending.
  std::vector<std::size_t> slices;
  /// Marks that distinguish it from the other parts, such as "acquisition 2"; empty if only its shape does.
  std::string distinguishing_marks;
};

/// Splits the slices of one series into parts: first by size, pixel spacing and orientation; then, if slices
/// coincide or ranges along the normal overlap, by marks. Consecutive values of an ordered mark stay together
/// if they do not collide, as in series that count every rotation or slice as an acquisition. A part may be a
/// single slice that fits no other, including one that would make even slices uneven. `marks` belong to
/// `slices`; `same_pixels` is as for `stack_slices`.
std::vector<SeriesPart> split_series(std::span<const SlicePlane> slices, std::span<const SliceMarks> marks,
                                     const SamePixels& same_pixels);

}  // namespace osteomill
