#include "osteomill/ct/scan_summary.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "osteomill/base/input_error.h"
#include "osteomill/volume/bone_pieces.h"

namespace osteomill {

namespace {

std::array<double, 3> to_array(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

void summarise_values(double isovalue, ScanSummary& summary) {
  const DensityGrid& grid = summary.scan.grid;
  double sum = 0;
  float min = grid.outside_density();
  float max = min;
  for_each_density(grid, [&](float density) {
    sum += static_cast<double>(density);
    min = std::min(min, density);
    max = std::max(max, density);
    summary.voxels_above_iso += static_cast<double>(density) > isovalue;
  });
  summary.value_min = static_cast<double>(min);
  summary.value_max = static_cast<double>(max);
  summary.value_mean =
      sum / static_cast<double>(grid.geometry().voxel_count() - grid.voxels_without_density());
}

std::string volume_text(double volume_mm3) {
  return volume_mm3 < 1e4 ? fmt::format("{:.4g}", volume_mm3) : fmt::format("{:.0f}", volume_mm3);
}

// "pieces      812 connected pieces of bone: 105000, 3020, 12.1 mm³ and smaller ones of 8.2 mm³ in all"
std::string pieces_text(std::span<const double> volumes_mm3) {
  constexpr std::size_t kListed = 3;
  std::string text = fmt::format("pieces      {} connected piece{} of bone: ", volumes_mm3.size(),
                                 volumes_mm3.size() == 1 ? "" : "s");
  const std::span<const double> listed = volumes_mm3.first(std::min(kListed, volumes_mm3.size()));
  const std::span<const double> others = volumes_mm3.subspan(listed.size());
  for (const double& volume : listed) text += (&volume == listed.data() ? "" : ", ") + volume_text(volume);
  text += " mm³";
  if (!others.empty())
    text += ", and smaller ones of " + volume_text(std::accumulate(others.begin(), others.end(), 0.0)) +
            " mm³ in all";
  return text + "\n";
}

}  // namespace

ScanSummary summarise(Scan scan, SuggestedIsovalue suggested_iso, double isovalue) {
  ScanSummary summary{
      .scan = std::move(scan), .suggested_iso = std::move(suggested_iso), .isovalue = isovalue};
  summarise_values(isovalue, summary);
  return summary;
}

std::vector<LabelSummary> summarise_labels(const Volume& bone) {
  std::vector<LabelSummary> summaries;
  const std::shared_ptr<const LabelMap>& map = bone.labels();
  if (!map) return summaries;
  for (const Label& label : map->labels()) summaries.push_back({label});
  for_each(map->box(), [&](const VoxelIndex& v) {
    const LabelMap::LabelIndex place = map->at(v);
    if (place == 0) return;
    LabelSummary& summary = summaries[place - 1u];
    ++summary.voxels;
    summary.bone_voxels += bone.is_bone(v) ? 1 : 0;
  });
  const double voxel_mm3 = bone.geometry().voxel_volume_mm3();
  for (LabelSummary& summary : summaries)
    summary.volume_mm3 = static_cast<double>(summary.voxels) * voxel_mm3;
  return summaries;
}

std::vector<double> piece_volumes_mm3(const Volume& bone) {
  std::vector<double> volumes_mm3;
  for (const std::size_t voxels : piece_sizes(bone.grid(), bone.isovalue()))
    volumes_mm3.push_back(static_cast<double>(voxels) * bone.geometry().voxel_volume_mm3());
  return volumes_mm3;
}

std::string to_json(const ScanSummary& summary) {
  const GridGeometry& geometry = summary.scan.grid.geometry();
  std::array<std::array<double, 3>, 3> direction;
  for (int row = 0; row < 3; ++row)
    direction[static_cast<std::size_t>(row)] = to_array(geometry.direction.row(row).transpose());
  nlohmann::ordered_json json{{"dims", geometry.dims},
                              {"spacing_mm", to_array(geometry.spacing_mm)},
                              {"origin_mm", to_array(geometry.origin_mm)},
                              {"direction", direction},
                              {"value_min", summary.value_min},
                              {"value_max", summary.value_max},
                              {"value_mean", summary.value_mean},
                              {"suggested_iso", summary.suggested_iso.value},
                              {"suggested_how", summary.suggested_iso.how},
                              {"voxels_above_iso", summary.voxels_above_iso},
                              {"warnings", summary.scan.warnings}};
  json["boundaries"] = nlohmann::ordered_json::array();
  for (const Boundary& of : summary.suggested_iso.boundaries)
    json["boundaries"].push_back({{"density", of.density}, {"below", of.below}, {"above", of.above}});
  if (!summary.scan.series.empty()) json["series"] = summary.scan.series;
  if (const std::size_t without = summary.scan.grid.voxels_without_density(); without > 0)
    json["voxels_without_density"] = without;
  if (const std::vector<double>& all = summary.pieces_mm3; !all.empty()) {
    const std::span<const double> largest(all.data(), std::min<std::size_t>(all.size(), 10));
    json["pieces"] = {{"count", all.size()}, {"largest_mm3", largest}};
  }
  for (const LabelSummary& of : summary.labels) {
    json["labels"].push_back({{"value", of.label.value},
                              {"name", of.label.name},
                              {"colour", hex_colour(of.label)},
                              {"no_go", of.label.no_go},
                              {"voxels", of.voxels},
                              {"volume_mm3", of.volume_mm3},
                              {"bone_voxels", of.bone_voxels}});
  }
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

std::string to_text(const ScanSummary& summary) {
  const GridGeometry& geometry = summary.scan.grid.geometry();
  const auto& [columns, rows, slices] = geometry.dims;
  const Vec3& spacing = geometry.spacing_mm;
  const Vec3& origin = geometry.origin_mm;
  std::string text = fmt::format("{} ({})\n", in_one_line(summary.scan.name), summary.scan.format);
  text += fmt::format("voxels      {} x {} x {}\n", columns, rows, slices);
  text += fmt::format("spacing     {:.6g} x {:.6g} x {:.6g} mm\n", spacing[0], spacing[1], spacing[2]);
  text += fmt::format("size        {:.6g} x {:.6g} x {:.6g} mm\n", spacing[0] * columns, spacing[1] * rows,
                      spacing[2] * slices);
  text += fmt::format("origin      {:.6g}, {:.6g}, {:.6g} mm\n", origin[0], origin[1], origin[2]);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 along = geometry.direction.col(axis);
    text += fmt::format("{} runs along {:.6g}, {:.6g}, {:.6g}\n", "ijk"[axis], along[0], along[1], along[2]);
  }
  text += fmt::format("values      {:.6g} to {:.6g}, mean {:.6g}\n", summary.value_min, summary.value_max,
                      summary.value_mean);
  if (const std::size_t without = summary.scan.grid.voxels_without_density(); without > 0) {
    text += fmt::format("no density  {} voxels (padding or NaN), set to the lowest density\n", without);
  }
  const std::string suggested =
      fmt::format("{:.6g} suggested, {}", summary.suggested_iso.value, summary.suggested_iso.how);
  const bool given = summary.isovalue != summary.suggested_iso.value;
  text += given ? fmt::format("isovalue    {:.6g} given ({})\n", summary.isovalue, suggested)
                : fmt::format("isovalue    {}\n", suggested);
  for (const Boundary& of : summary.suggested_iso.boundaries)
    text += fmt::format(
        "boundary    {:.4g}, with {:.4g} below and {:.4g} above{}\n", of.density, of.below, of.above,
        of.is_suggested
            ? fmt::format("; the suggested isovalue lies on this boundary, sharpest at {:.4g}", of.density)
            : "");
  text += fmt::format("bone        {} voxels above {:.6g}\n", summary.voxels_above_iso, summary.isovalue);
  if (!summary.pieces_mm3.empty()) text += pieces_text(summary.pieces_mm3);
  for (const std::string& series : summary.scan.series)
    text += fmt::format("series      {}\n", in_one_line(series));
  for (const LabelSummary& of : summary.labels) {
    text += fmt::format(
        "label       {} {}, {}: {} voxels, {:.5g} mm³, {:.0f} % bone{}\n", of.label.value,
        in_one_line(of.label.name), hex_colour(of.label), of.voxels, of.volume_mm3,
        of.voxels > 0 ? 100.0 * static_cast<double>(of.bone_voxels) / static_cast<double>(of.voxels) : 0.0,
        of.label.no_go ? ", no-go" : "");
  }
  for (const std::string& warning : summary.scan.warnings)
    text += fmt::format("warning: {}\n", in_one_line(warning));
  return text;
}

}  // namespace osteomill
