#include "app/simulate/pieces_panel.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/widgets.h"

namespace osteomill::app {

namespace {

constexpr const char* kMenu = "##piece";
constexpr const char* kNotInExercise =
    "Pieces cannot be removed in an exercise, because its results count all removed bone";

// Counts the pieces in a copy, which shares its memory with the bone, so that milling can continue.
void choose(ChosenPiece& chosen, const Simulation& simulation, const VoxelIndex& voxel) {
  chosen.voxel = voxel;
  chosen.piece.reset();
  chosen.choosing = false;
  DensityGrid grid;
  simulation.milling.follower().read([&](const Volume& bone) { grid = bone.grid(); });
  chosen.pending = std::async(std::launch::async,
                              [grid = std::move(grid), voxel, isovalue = simulation.milling.isovalue()] {
                                return piece_at(grid, isovalue, voxel);
                              });
}

// Returns the bone voxel under the pointer.
std::optional<VoxelIndex> voxel_under_pointer(const ViewState& view, const Simulation& simulation,
                                              const PixelSize& size) {
  const ImVec2 pointer = ImGui::GetIO().MousePos;
  std::optional<VoxelIndex> voxel;
  simulation.milling.follower().read([&](const Volume& bone) {
    voxel =
        bone_voxel_seen_at(bone, view.camera, size,
                           {static_cast<double>(pointer.x), static_cast<double>(pointer.y)}, planes_of(view));
  });
  return voxel;
}

void take_click(ViewState& view, const Simulation& simulation, const PixelSize& size) {
  ChosenPiece& chosen = view.chosen_piece;
  if (view.holding_tool || ui::is_key_pressed(GLFW_KEY_ESCAPE)) chosen.choosing = false;
  const bool clicked = ui::is_click(1) || (chosen.choosing && ui::is_click(0));
  if (!clicked || view.holding_tool || is_dialogue_open() || ImGui::GetIO().WantCaptureMouse) return;
  const auto voxel = voxel_under_pointer(view, simulation, size);
  if (!voxel) return;
  if (simulation.exercise) {
    view.message = kNotInExercise;
    return;
  }
  choose(chosen, simulation, *voxel);
  ImGui::OpenPopup(kMenu);
}

template <typename Result>
bool is_ready(const std::future<Result>& result) {
  return result.valid() && result.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void draw_box(const ViewState& view, const GridGeometry& grid, const VoxelBox& box, const PixelSize& size) {
  const std::array<Vec3, 8> corners_W = osteomill::corners_W(grid, box);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto at = [&](std::size_t corner) {
    const Eigen::Vector2d pixel = pixel_of(view.camera, size, corners_W[corner]);
    return ImVec2(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  };
  for (std::size_t corner = 0; corner < 8; ++corner) {
    for (const std::size_t axis : {1u, 2u, 4u}) {
      const std::size_t other = corner | axis;
      const bool is_seen =
          depth_of(view.camera, corners_W[corner]) > 0 && depth_of(view.camera, corners_W[other]) > 0;
      if (other != corner && is_seen)
        list.AddLine(at(corner), at(other), IM_COL32(255, 180, 60, 255), ui::px(2));
    }
  }
}

std::string text_of(const BonePiece& piece, double voxel_mm3) {
  const auto place =
      1 + std::ranges::count_if(piece.sizes, [&](std::size_t size) { return size > piece.voxels; });
  const double mm3 = static_cast<double>(piece.voxels) * voxel_mm3;
  const std::string volume = fmt::format("{:.{}f} mm³", mm3, mm3 < 100 ? 2 : 0);
  if (piece.sizes.size() == 1) return volume + ", the whole bone";
  if (place == 1) return fmt::format("{}, the largest of {} pieces", volume, piece.sizes.size());
  return fmt::format("{}, number {} of {} pieces by size", volume, place, piece.sizes.size());
}

// Draws the actions that leave some bone. Returns the chosen removal.
std::optional<PieceRemoval> draw_actions(ChosenPiece& chosen, double voxel_mm3, bool is_free) {
  using Which = PieceRemoval::Which;
  const std::vector<std::size_t> none;
  const std::vector<std::size_t>& sizes = chosen.piece ? chosen.piece->sizes : none;
  const auto min_mm3 = static_cast<double>(chosen.min_mm3);
  const auto small = static_cast<std::size_t>(std::ranges::count_if(
      sizes, [&](std::size_t size) { return static_cast<double>(size) * voxel_mm3 < min_mm3; }));
  std::optional<PieceRemoval> removal;
  if (ui::button(
          "Keep only this piece",
          "Removes all other pieces of bone, e.g. the table under a scanned head. Undo cut restores them",
          is_free && sizes.size() > 1))
    removal = {Which::all_but_chosen, *chosen.voxel};
  if (ui::button("Remove this piece", "Removes the piece in the box. Undo cut restores it",
                 is_free && sizes.size() > 1))
    removal = {Which::chosen, *chosen.voxel};
  if (ui::button("Remove pieces below",
                 "Removes every piece of bone smaller than the volume next to this button, e.g. crumbs and "
                 "noise. Undo cut restores them",
                 is_free && small > 0 && small < sizes.size()))
    removal = {Which::smaller, {}, min_mm3};
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ui::px(130));
  ui::slider("volume", "Smallest volume of pieces to keep. Drag, or Ctrl+click to type a number",
             &chosen.min_mm3, 0.1f, 100000, "%.1f mm³",
             ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
  if (chosen.piece)
    ImGui::TextDisabled(small == 1 ? "%d piece is smaller" : "%d pieces are smaller",
                        static_cast<int>(small));
  return removal;
}

}  // namespace

void measure_bone(ChosenPiece& chosen, const Simulation& simulation) {
  std::optional<Volume> copy;
  simulation.milling.follower().read([&](const Volume& bone) { copy = bone; });
  chosen.box = std::async(std::launch::async, [copy = *std::move(copy)] { return box_of_bone(copy); });
}

void draw_piece_controls(ViewState& view, const Simulation& simulation) {
  bool& choosing = view.chosen_piece.choosing;
  const char* const hint = simulation.exercise ? kNotInExercise
                                               : "Then click a piece of bone to keep or remove it. A right "
                                                 "click on bone does the same at any time";
  if (ui::button(choosing ? "Click on bone ...##choose" : "Choose piece##choose", hint,
                 !simulation.exercise && !view.holding_tool))
    choosing = !choosing;
}

void draw_piece_menu(ViewState& view, Simulation& simulation, const PixelSize& size) {
  ChosenPiece& chosen = view.chosen_piece;
  view.dialogues.run_reporting_errors([&] {
    if (is_ready(chosen.pending)) chosen.piece = chosen.pending.get();
    if (is_ready(chosen.box)) view.box = chosen.box.get();
  });
  take_click(view, simulation, size);
  if (!ImGui::BeginPopup(kMenu)) {
    chosen.voxel.reset();
    chosen.piece.reset();
    return;
  }
  const GridGeometry& grid = simulation.milling.geometry();
  const double voxel_mm3 = grid.voxel_volume_mm3();
  ImGui::TextUnformatted(chosen.piece ? text_of(*chosen.piece, voxel_mm3).c_str()
                                      : "Measuring the piece ...");
  ImGui::Separator();
  if (const auto removal = draw_actions(chosen, voxel_mm3, !simulation.milling.is_preparing())) {
    chosen.requested = removal;
    ImGui::CloseCurrentPopup();
  }
  if (chosen.piece) draw_box(view, grid, chosen.piece->box, size);
  if (ui::is_key_pressed(GLFW_KEY_ESCAPE)) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace osteomill::app
