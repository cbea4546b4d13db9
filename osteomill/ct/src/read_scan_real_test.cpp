#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "osteomill/base/input_error.h"
#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/isovalue.h"
#include "osteomill/volume/label_scan.h"

#include "tests/shared_data.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing_support::shared_data;

json read_json(const fs::path& path) {
  return json::parse(std::ifstream(path));
}

// Returns the first of these keys that exists: some expectations use "hu_min", others "min" or "value_min".
const json* find(const json& expected, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (expected.contains(name)) return &expected[name];
  }
  return nullptr;
}

void expect_vector(const json* expected, const Vec3& found, double tolerance, const char* what) {
  if (expected == nullptr) return;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR((*expected)[static_cast<std::size_t>(axis)].get<double>(), found[axis], tolerance)
        << what << " along " << axis;
  }
}

void expect_samples(const json& samples, const DensityGrid& grid) {
  for (const json& sample : samples) {
    const json& ijk = sample["ijk"];
    const VoxelIndex v{ijk[0].get<int>(), ijk[1].get<int>(), ijk[2].get<int>()};
    ASSERT_TRUE(grid.contains(v)) << ijk;
    const double value = find(sample, {"hu", "value"})->get<double>();
    EXPECT_NEAR(grid[v], value, 1e-3 + 1e-6 * std::abs(value)) << "at " << ijk;
  }
}

void expect_numbers(const json& expected, const Scan& scan) {
  const GridGeometry& geometry = scan.grid.geometry();
  if (const json* dims = find(expected, {"dims_xyz"})) {
    EXPECT_EQ((dims->get<std::array<int, 3>>()), geometry.dims);
  }
  expect_vector(find(expected, {"spacing_xyz_mm"}), geometry.spacing_mm, 1e-4, "spacing");
  expect_vector(find(expected, {"origin_mm", "origin_lps_mm"}), geometry.origin_mm, 1e-3, "origin");
  if (const json* iop = find(expected, {"iop"})) {
    for (int n = 0; n < 6; ++n) {
      EXPECT_NEAR((*iop)[static_cast<std::size_t>(n)].get<double>(), geometry.direction(n % 3, n / 3), 1e-5);
    }
  }
  const std::vector<float> densities = every_nth_density(scan.grid, 1);
  const auto [min, max] = std::minmax_element(densities.begin(), densities.end());
  const double mean =
      std::accumulate(densities.begin(), densities.end(), 0.0) / static_cast<double>(densities.size());
  const auto near = [](const json* number, double found, double tolerance) {
    if (number != nullptr) {
      EXPECT_NEAR(number->get<double>(), found, tolerance);
    }
  };
  near(find(expected, {"hu_min", "min", "value_min"}), *min, 1e-3);
  near(find(expected, {"hu_max", "max", "value_max"}), *max, 1e-3);
  near(find(expected, {"hu_mean", "mean", "value_mean"}), mean, 1e-4);
  if (const json* above = find(expected, {"voxels_above_iso"})) {
    const double iso = expected["suggested_iso"].get<double>();
    EXPECT_EQ(above->get<long>(),
              std::count_if(densities.begin(), densities.end(), [&](float v) { return v > iso; }));
  }
  if (const json* samples = find(expected, {"samples"})) expect_samples(*samples, scan.grid);
}

// Checks the outcome given in expect.json: "load", "load_or_warn", "load_or_clean_error", "warn_or_error" or
// "error".
void expect_outcome(const fs::path& path, const json& expected) {
  SCOPED_TRACE(path.string() + ": " + expected["note"].get<std::string>());
  const std::string outcome = expected["expect"].get<std::string>();
  try {
    const Scan scan = read_scan(path);
    EXPECT_NE(outcome, "error") << "was read, and should have been refused";
    const std::string warning = scan.warnings.empty() ? "" : scan.warnings.front();
    EXPECT_TRUE(outcome != "load" || warning.empty()) << warning;
    EXPECT_TRUE(outcome != "warn_or_error" || !warning.empty()) << "was read without a word";
    if (expected.contains("shear_mm_per_slice")) {
      // Straightened, so that its geometry differs; slice_stack_test.cpp checks that exactly.
      EXPECT_NE(warning.find("15.0 degrees"), std::string::npos) << warning;
      expect_vector(find(expected, {"spacing_xyz_mm"}), scan.grid.geometry().spacing_mm, 1e-4, "spacing");
    } else if (outcome.starts_with("load")) {
      expect_numbers(expected, scan);
    }
  } catch (const InputError& error) {
    EXPECT_TRUE(outcome == "error" || outcome == "warn_or_error" || outcome == "load_or_clean_error")
        << error.what();
    EXPECT_NE(std::string(error.what()).find(path.filename().string()), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

void expect_outcomes(const fs::path& folder) {
  const json outcomes = read_json(folder / "expect.json");
  for (const auto& [name, expected] : outcomes.items()) {
    expect_outcome(folder / name, expected);
  }
}

void expect_facts(const fs::path& folder) {
  const json facts = read_json(folder / "facts.json");
  for (const auto& [name, expected] : facts.items()) {
    SCOPED_TRACE(name);
    expect_numbers(expected, read_scan(folder / name));
  }
}

TEST(ReadRealScan, DicomFoldersHaveTheirExpectedOutcomes) {
  OSTEOMILL_NEEDS_SHARED("tooth_dicom_cases/expect.json");
  expect_outcomes(shared_data() / "tooth_dicom_cases");
}

TEST(ReadRealScan, VolumeFilesHaveTheirExpectedOutcomes) {
  OSTEOMILL_NEEDS_SHARED("volumes_odd/expect.json");
  expect_outcomes(shared_data() / "volumes_odd");
}

class RealScanFacts : public ::testing::TestWithParam<const char*> {};

TEST_P(RealScanFacts, MatchTheScans) {
  OSTEOMILL_NEEDS_SHARED(GetParam());
  expect_facts(shared_data() / GetParam());
}

TEST(ReadRealScan, CorrectsTheTiltOfAnUnevenStack) {
  OSTEOMILL_NEEDS_SHARED("head_tilt_dicom/facts.json");
  const json facts = read_json(shared_data() / "head_tilt_dicom/facts.json")["series/"];
  const Scan scan = read_scan(shared_data() / "head_tilt_dicom/series");
  const GridGeometry& geometry = scan.grid.geometry();
  const json& heights_mm = facts["positions_along_normal_mm"];
  const double height_mm = heights_mm.back().get<double>() - heights_mm.front().get<double>();
  EXPECT_NEAR(geometry.spacing_mm.z() * (geometry.dims[2] - 1), height_mm, 1e-3);
  EXPECT_NEAR(geometry.spacing_mm.z(), 4.002, 0.01);
  ASSERT_GE(scan.warnings.size(), 2U);
  EXPECT_NE(scan.warnings[0].find("1.081"), std::string::npos) << scan.warnings[0];
  EXPECT_NE(scan.warnings[1].find("18.5 degrees"), std::string::npos) << scan.warnings[1];
  const std::vector<float> densities = every_nth_density(scan.grid, 1);
  const auto [min, max] = std::minmax_element(densities.begin(), densities.end());
  EXPECT_GE(*min, facts["hu_min"].get<float>());
  EXPECT_LE(*max, facts["hu_max"].get<float>());
}

TEST(ReadRealScan, OddDicomFilesAreReadOrRefusedInOneLine) {
  OSTEOMILL_NEEDS_SHARED("dicom_odd/facts.json");
  for (const fs::directory_entry& entry : fs::directory_iterator(shared_data() / "dicom_odd")) {
    SCOPED_TRACE(entry.path().string());
    try {
      EXPECT_FALSE(read_scan(entry.path()).grid.densities().empty());
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

struct KnownIsovalue {
  const char* scan;
  double isovalue;
};
class RealScanIsovalue : public ::testing::TestWithParam<KnownIsovalue> {};

// Returns whether an isovalue lies on a boundary between materials of a grid.
bool is_on_boundary(const DensityGrid& grid, double isovalue) {
  const std::vector<Boundary> boundaries = boundaries_in(grid);
  return std::any_of(boundaries.begin(), boundaries.end(), [&](const Boundary& boundary) {
    return boundary.below < isovalue && isovalue < boundary.above;
  });
}

// The suggested isovalue must be in the range that experts give for bone in each scan.
TEST_P(RealScanIsovalue, SuggestionIsWithin15PercentOfBone) {
  const auto& [path, known] = GetParam();
  OSTEOMILL_NEEDS_SHARED(path);
  const Scan scan = read_scan(shared_data() / path);
  const SuggestedIsovalue suggested = suggest_isovalue(scan.grid, scan.in_hounsfield_units);
  EXPECT_NEAR(suggested.value, known, 0.15 * known) << suggested.how;
  EXPECT_TRUE(is_on_boundary(scan.grid, known));
  EXPECT_EQ(LabelGuess::densities, guess_labels(scan.grid));
}

// Densities in eight bits, as programs save pictures: the whole range, or a display window.
TEST(ReadRealScan, FindsTheBoneBoundaryInEightBits) {
  struct Window {
    const char* scan;
    double known;
    double black;
    double white;
  };
  for (const auto& [path, known, black, white] :
       {Window{"cranium/cranium_256x256x108_i16.nrrd", 300, -1024, 2986},
        Window{"cranium/cranium_256x256x108_i16.nrrd", 300, -1000, 1500},
        Window{"cranium/cranium_256x256x108_i16.nrrd", 300, -150, 350},
        Window{"cranium/cranium_256x256x108_i16.nrrd", 300, -100, 400},
        Window{"head_quarter/headsq_quarter.mhd", 1150, 0, 3926},
        Window{"head_quarter/headsq_quarter.mhd", 1150, 0, 2500}}) {
    OSTEOMILL_NEEDS_SHARED(path);
    const Scan scan = read_scan(shared_data() / path);
    const auto shade = [&, black = black, white = white](double density) {
      return std::clamp((density - black) / (white - black), 0.0, 1.0) * 255;
    };
    std::vector<float> shades;
    for (const float density : every_nth_density(scan.grid, 1))
      shades.push_back(static_cast<float>(std::round(shade(static_cast<double>(density)))));
    const DensityGrid eight_bits(scan.grid.geometry(), std::move(shades));
    EXPECT_TRUE(is_on_boundary(eight_bits, shade(known))) << path;
    const SuggestedIsovalue suggested = suggest_isovalue(eight_bits);
    const bool is_near = std::abs(suggested.value - shade(known)) < 0.15 * shade(known);
    EXPECT_TRUE(is_near || suggested.how.find("; a guess, with other boundaries at ") != std::string::npos)
        << path << ": " << suggested.value << " for " << shade(known) << ", " << suggested.how;
    EXPECT_EQ(LabelGuess::densities, guess_labels(eight_bits)) << path;
  }
}

// Its densities form thick steps, so that few voxels lie between a lower and a higher neighbour.
TEST(ReadRealScan, SteppedDensitiesAreNotTakenForLabels) {
  OSTEOMILL_NEEDS_SHARED("attacks4/stderr-closed/b6.nrrd");
  EXPECT_NE(LabelGuess::labels,
            guess_labels(read_scan(shared_data() / "attacks4/stderr-closed/b6.nrrd").grid));
}

TEST(ReadRealScan, LabelMapsAreTakenForLabels) {
  for (const char* path : {"jaw_labels/jaw_360x360x330_labels.nrrd", "temporal_bone/ear3_256_labels.nrrd",
                           "temporal_bone/RT138_256_labels.nrrd", "found4/labels/two-labels.nrrd",
                           "found4/labels/three-labels.nrrd"}) {
    OSTEOMILL_NEEDS_SHARED(path);
    const DensityGrid labels = read_scan(shared_data() / path).grid;
    EXPECT_EQ(LabelGuess::labels, guess_labels(labels)) << path;
    EXPECT_EQ(isovalue_of_labels(labels), 0.5) << path;
  }
}

// Phantom of 40 x 36 x 24 voxels, written by many programs; each file is unusual in one way.
struct OddPhantom {
  const char* path;
  double slice_mm;
  bool has_place;
  // Part of the only warning; empty if there is none.
  const char* warning;
};
class RealOddPhantom : public ::testing::TestWithParam<OddPhantom> {};

TEST_P(RealOddPhantom, MatchesThePhantom) {
  const auto& [path, slice_mm, has_place, warning] = GetParam();
  OSTEOMILL_NEEDS_SHARED(path);
  const Scan scan = read_scan(shared_data() / path);
  const GridGeometry& geometry = scan.grid.geometry();
  EXPECT_EQ(geometry.dims, (std::array<int, 3>{40, 36, 24}));
  EXPECT_TRUE(geometry.spacing_mm.isApprox(Vec3(0.4, 0.4, slice_mm), 1e-5))
      << geometry.spacing_mm.transpose();
  EXPECT_TRUE(!has_place || geometry.origin_mm.isApprox(Vec3(-8, -7, 3), 1e-5))
      << geometry.origin_mm.transpose();
  const std::vector<float> densities = every_nth_density(scan.grid, 1);
  const auto [min, max] = std::minmax_element(densities.begin(), densities.end());
  EXPECT_EQ(*min, -1000);
  EXPECT_EQ(*max, 1161);
  EXPECT_EQ(std::count_if(densities.begin(), densities.end(), [](float v) { return v > 260; }), 2420);
  ASSERT_EQ(scan.warnings.size(), *warning == '\0' ? 0u : 1u);
  if (*warning != '\0') {
    EXPECT_NE(scan.warnings[0].find(warning), std::string::npos) << scan.warnings[0];
  }
}

INSTANTIATE_TEST_SUITE_P(
    ReadRealScan, RealOddPhantom,
    ::testing::Values(OddPhantom{"found4/01-nan-scaling/both-nan.nii.gz", 0.5, true, "were not rescaled"},
                      OddPhantom{"found4/02-sform/unit-sform-qform.nii.gz", 0.5, true, "its qform was used"},
                      OddPhantom{"found4/02-sform/shear-0.1-qform.nii.gz", 0.5, true, "its qform was used"},
                      OddPhantom{"found4/02-sform/zero-sform.nii.gz", 0.5, true, "its qform was used"},
                      OddPhantom{"found4/22-nrrd/first-unit.nrrd", 0.05, false, ""},
                      OddPhantom{"found4/22-nrrd/list.nhdr", 0.5, true, ""},
                      OddPhantom{"found4/23-nifti-kinds/pair.hdr", 0.5, true, ""},
                      OddPhantom{"found4/24-metaimage/blank-line.mha", 0.5, true, ""}));

INSTANTIATE_TEST_SUITE_P(ReadRealScan, RealScanIsovalue,
                         ::testing::Values(KnownIsovalue{"tooth/tooth_103x94x161_u16.nrrd", 610},
                                           KnownIsovalue{"tooth/tooth_256x256x176_u16.nrrd", 610},
                                           KnownIsovalue{"tooth/original/tooth.nhdr", 610},
                                           KnownIsovalue{"tooth_dicom/series", 755},
                                           KnownIsovalue{"tooth_dicom_cases/baseline_explicit_le", 755},
                                           KnownIsovalue{"volumes_odd/nrrd/gzip.nrrd", 610},
                                           KnownIsovalue{"cranium/cranium_256x256x108_i16.nrrd", 300},
                                           KnownIsovalue{"head_quarter/headsq_quarter.mhd", 1150},
                                           KnownIsovalue{"head_tilt_dicom/series", 250},
                                           KnownIsovalue{"trabecular/lhdl_3155_D_4_bc_200x200x200_u8.nrrd",
                                                         100}));

INSTANTIATE_TEST_SUITE_P(ReadRealScan, RealScanFacts,
                         ::testing::Values("tooth", "tooth_dicom", "cranium", "head_quarter", "jaw_labels",
                                           "trabecular"));

}  // namespace
}  // namespace osteomill
