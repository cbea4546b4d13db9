#include "series_parts.h"

#include <algorithm>
#include <iterator>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

std::size_t mark_named(const std::string& name) {
  const auto kind =
      std::find_if(kMarkKinds.begin(), kMarkKinds.end(), [&](const MarkKind& of) { return of.name == name; });
  EXPECT_NE(kind, kMarkKinds.end()) << name;
  return static_cast<std::size_t>(kind - kMarkKinds.begin());
}

// Slices of one series with their marks, in order of addition.
struct Series {
  std::vector<SlicePlane> slices;
  std::vector<SliceMarks> marks;
  // Picture number of each slice; equal numbers mean equal pixels.
  std::vector<int> pictures;

  SlicePlane& add(double height_mm, const std::string& mark = "acquisition", const std::string& value = "") {
    SlicePlane slice;
    slice.name = "slice" + std::to_string(slices.size());
    slice.instance = slice.name;
    slice.columns = 8;
    slice.rows = 6;
    slice.column_distance_mm = slice.row_distance_mm = 0.5;
    slice.position_mm = Vec3(1, 2, height_mm);
    slices.push_back(slice);
    marks.emplace_back();
    marks.back()[mark_named(mark)] = value;
    pictures.push_back(static_cast<int>(slices.size()));
    return slices.back();
  }

  std::vector<SeriesPart> parts() const {
    return split_series(slices, marks,
                        [&](std::size_t a, std::size_t b) { return pictures[a] == pictures[b]; });
  }
  // Returns the number of slices of each part.
  std::vector<std::size_t> sizes() const {
    std::vector<std::size_t> sizes;
    for (const SeriesPart& part : parts()) sizes.push_back(part.slices.size());
    return sizes;
  }
};

using Sizes = std::vector<std::size_t>;

TEST(SeriesParts, SplitsAcquisitionsOfOverlappingRanges) {
  for (const double off_mm : {0.0, 0.25, 0.1, 3.0}) {
    Series series;
    for (int k = 0; k < 12; ++k) {
      series.add(0.5 * k, "acquisition", "1");
      series.add(0.5 * k + off_mm, "acquisition", "2");
    }
    const std::vector<SeriesPart> parts = series.parts();
    ASSERT_EQ(parts.size(), 2U) << off_mm;
    EXPECT_EQ(parts[0].distinguishing_marks, "acquisition 1");
    EXPECT_EQ(parts[1].distinguishing_marks, "acquisition 2");
    for (std::size_t n = 0; n < 12; ++n) {
      EXPECT_EQ(parts[0].slices[n], 2 * n);
      EXPECT_EQ(parts[1].slices[n], 2 * n + 1);
    }
  }
}

TEST(SeriesParts, KeepsConsecutiveAcquisitionsTogether) {
  // Every slice, or every rotation of four slices, has its own number; every other slice was acquired first.
  for (const int rotation : {1, 4}) {
    Series series;
    for (int k = 0; k < 24; ++k) series.add(0.5 * k, "acquisition", std::to_string(k / rotation));
    EXPECT_EQ(series.sizes(), Sizes{24}) << rotation;
  }
  Series interleaved;
  for (const int first : {0, 1}) {
    for (int k = first; k < 24; k += 2)
      interleaved.add(0.5 * k, "acquisition", std::to_string(interleaved.slices.size()));
  }
  EXPECT_EQ(interleaved.sizes(), Sizes{24});
}

TEST(SeriesParts, SplitsRepeatedRotationsIntoVolumes) {
  for (const int rotation : {1, 4}) {
    Series series;
    for (int n = 0; n < 72; ++n) series.add(0.5 * (n % 24), "acquisition", std::to_string(n / rotation));
    EXPECT_EQ(series.sizes(), (Sizes{24, 24, 24})) << rotation;
    EXPECT_EQ(series.parts()[1].distinguishing_marks,
              rotation == 1 ? "acquisition 24 to 47" : "acquisition 6 to 11");
  }
}

TEST(SeriesParts, SplitsTimePointsByAnyMark) {
  for (const MarkKind& kind : kMarkKinds) {
    if (kind.is_of_slices) continue;
    Series series;
    for (int n = 0; n < 36; ++n) series.add(n / 3, kind.name, "v" + std::to_string(n % 3));
    EXPECT_EQ(series.sizes(), (Sizes{12, 12, 12})) << kind.name;
  }
  for (const char* of_slices : {"acquisition time", "content time", "instance number"}) {
    Series series;
    for (int n = 0; n < 36; ++n) series.add(n % 12, of_slices, std::to_string(100000 + n));
    EXPECT_EQ(series.sizes(), (Sizes{12, 12, 12})) << of_slices;
  }
}

TEST(SeriesParts, SplitsByTwoMarksTogether) {
  Series series;
  for (int n = 0; n < 48; ++n) {
    series.add(n / 4, "acquisition", std::to_string(n % 2));
    series.marks.back()[mark_named("kernel")] = n % 4 < 2 ? "soft" : "bone";
  }
  EXPECT_EQ(series.sizes(), (Sizes{12, 12, 12, 12}));
  EXPECT_EQ(series.parts()[0].distinguishing_marks, "acquisition 0, kernel bone");
}

TEST(SeriesParts, SortsOriginalsFirstAndMarksByNumber) {
  for (const auto& [mark, first, second] :
       {std::array{"image type", "ORIGINAL\\PRIMARY", "DERIVED\\SECONDARY"}, {"acquisition", "9", "10"}}) {
    Series series;
    for (int k = 0; k < 12; ++k) {
      series.add(0.5 * k, mark, second);
      series.add(0.5 * k + 0.25, mark, first);
    }
    const std::vector<SeriesPart> parts = series.parts();
    ASSERT_EQ(parts.size(), 2U) << mark;
    EXPECT_EQ(parts[0].slices.front(), 1U) << mark << " " << first;
  }
}

TEST(SeriesParts, SplitsOffASliceThatMakesOthersUneven) {
  Series series;
  for (int k = 0; k < 24; ++k) series.add(0.5 * k, "acquisition", "1");
  series.add(2.25, "acquisition", "2");
  EXPECT_EQ(series.sizes(), (Sizes{24, 1}));
  Series even;
  for (int k = 0; k < 24; ++k) even.add(0.5 * k, "acquisition", k == 7 ? "2" : "1");
  EXPECT_EQ(even.sizes(), Sizes{24});
}

TEST(SeriesParts, KeepsSlicesOfOneVolumeTogetherDespiteTheirMarks) {
  Series series;
  for (int k = 0; k < 24; ++k) series.add(0.5 * k, "image type", k == 5 || k == 11 ? "DERIVED" : "ORIGINAL");
  EXPECT_EQ(series.sizes(), Sizes{24});
  Series copied;
  for (int k = 0; k < 24; ++k) copied.add(0.5 * k, "instance number", std::to_string(k));
  for (int k = 3; k < 6; ++k) {
    copied.add(0.5 * k, "instance number", std::to_string(100 + k));
    copied.pictures.back() = copied.pictures[static_cast<std::size_t>(k)];
  }
  EXPECT_EQ(copied.sizes(), Sizes{27});
}

TEST(SeriesParts, DoesNotSplitByTimeAlone) {
  Series series;
  for (int k = 0; k < 12; ++k) series.add(0.5 * k, "content time", std::to_string(k));
  series.add(2.0, "content time", "99");
  EXPECT_EQ(series.sizes(), Sizes{13});
}

TEST(SeriesParts, SplitsBySizeSpacingAndOrientation) {
  Series series;
  for (int k = 0; k < 12; ++k) {
    series.add(0.5 * k);
    series.add(0.5 * k).columns = 9;
    series.add(0.5 * k).row_distance_mm = 0.6;
    series.add(0.5 * k).i_direction = -Vec3::UnitX();
  }
  series.add(3).rows = 20;
  EXPECT_EQ(series.sizes(), (Sizes{12, 12, 12, 12, 1}));
}

}  // namespace
}  // namespace osteomill
