// Surfaces of real scans.
#include <gtest/gtest.h>

#include "osteomill/ct/read_scan.h"

#include "tests/shared_data.h"
#include "tests/support/mesh_checks.h"

namespace osteomill {
namespace {

using testing_support::enclosed_volume_mm3;
using testing_support::is_closed;
using testing_support::is_sound;
using testing_support::mesh_surface;
using testing_support::trilinear_volume_mm3;
using testing_support::welded_by_position;

Volume scanned(const char* file, double isovalue) {
  return Volume(read_scan(testing_support::shared_data() / file).grid, isovalue);
}

TEST(SurfaceMesh, MeshOfRealToothIsClosedAndHasItsVolume) {
  OSTEOMILL_NEEDS_SHARED("tooth/tooth_103x94x161_u16.nrrd");
  const Volume tooth = scanned("tooth/tooth_103x94x161_u16.nrrd", 610);
  const BrickMesh whole = mesh_in_one_piece(DensityView(tooth));
  EXPECT_TRUE(is_sound(whole));
  EXPECT_TRUE(is_closed(welded_by_position(mesh_surface(DensityView(tooth)))));
  const double expected_mm3 = trilinear_volume_mm3(tooth);
  EXPECT_NEAR(enclosed_volume_mm3(whole), expected_mm3, 0.005 * expected_mm3);
}

// The skull extends beyond the scan.
TEST(SurfaceMesh, MeshOfRealSkullIsClosedAtScanBorder) {
  OSTEOMILL_NEEDS_SHARED("cranium/cranium_256x256x108_i16.nrrd");
  EXPECT_TRUE(is_sound(mesh_in_one_piece(DensityView(scanned("cranium/cranium_256x256x108_i16.nrrd", 300)))));
}

}  // namespace
}  // namespace osteomill
