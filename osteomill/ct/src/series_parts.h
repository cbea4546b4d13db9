#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "slice_stack.h"

namespace osteomill {

/// A value of a header that tells the acquisitions, phases and time points of one series apart.
struct MarkKind {
  const char* name;
  /// Slices come in the order of its numbers, so that several values in turn may make one part.
  bool is_ordered;
  /// It may differ from slice to slice of one volume, and counts only if slices lie at the same places.
  bool is_of_slices;
};

/// The most telling first.
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
/// The texts of a slice's header in the order of kMarkKinds; empty if it has none.
using SliceMarks = std::array<std::string, kMarkKinds.size()>;

/// Slices of a series that lie on one grid.
struct SeriesPart {
  /// Numbers of slices, in their order.
  std::vector<std::size_t> slices;
  /// The marks that tell it from the other parts, as "acquisition 2"; empty if only its shape does.
  std::string told_by;
};

/// Parts the slices of one series: those of another size, pixel spacing or orientation; then, if slices lie
/// at one place or ranges along the normal overlap, those of different marks. Values in turn of an ordered
/// mark that do not get in each other's way stay together, as the slices of a series that number every
/// rotation or every slice as an acquisition. A part of a single slice fits nothing else; one that makes even
/// slices uneven is such a part. `marks` are those
/// of `slices`, which may be of several series' parts again; `same_pixels` as `stack_slices` takes it.
std::vector<SeriesPart> part_series(std::span<const SlicePlane> slices, std::span<const SliceMarks> marks,
                                    const SamePixels& same_pixels);

}  // namespace osteomill
