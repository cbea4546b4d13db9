#include "app/simulate/milling_screen.h"

#include <utility>

#include <fmt/core.h>

#include "osteomill/base/input_error.h"
#include "osteomill/live/spindle_state.h"
#include "osteomill/visual/annotations.h"
#include "osteomill/visual/image.h"

#include "app/scan_options.h"
#include "app/simulate/exercise_panel.h"
#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/view_aids_panel.h"

namespace osteomill::app {

namespace {

void drop_requests(ViewState& view) {
  view.undo_requested = view.redo_requested = view.reset_confirmed = view.finish_requested = false;
  view.chosen_piece.requested.reset();
  view.isovalue_requested.reset();
}

}  // namespace

Pose initial_tool_pose(const PreparedScan& opened, const Camera& camera, const PixelSize& size) {
  if (const std::optional<Pose>& recorded = opened.milling.handover.X_WT) return *recorded;
  // In front of the bone's upper half, so that the shaft does not hide the bone.
  const MillingSession& session = *opened.milling.session;
  return tool_pose_at_centre(session.volume(), session.setup().tool, camera, size, 0.15 * size.height);
}

MillingScreen::MillingScreen(PreparedScan opened, const Pose& X_WT, const ToolSource& tool_source,
                             const std::string& command_line, const SendOption& send, Stage& stage)
    : simulation_(std::move(opened), X_WT, tool_source, command_line),
      exercise_begins_(simulation_.exercise && !simulation_.from) {
  if (simulation_.from) stage.files.begin_recording(stage.view, simulation_, "again.h5");
  simulation_.start();
  // If the receiver does not listen, milling continues without sending.
  stage.view.dialogues.run_reporting_errors(
      [&] { sender_ = send_bone(simulation_.milling.follower(), send); });
  begin_view(stage);
}

void MillingScreen::begin_view(Stage& stage) {
  LiveMilling& milling = simulation_.milling;
  ViewState& view = stage.view;
  view.X_W_target = milling.state().record.X_WD;
  view.requested_setup.tool = milling.setup().tool;
  view.isovalue.reset();
  drop_requests(view);
  view.chosen_piece = {};
  // Pieces may have been removed in an earlier run.
  if (milling.follower().is_touched()) measure_bone(view.chosen_piece, simulation_);
  view.X_W_destination.reset();
  view.holding_tool = view.dragging_tool = view.dragging_view = view.pedal_down = false;
  view.dragged_cut = -1;
  reset_cuts(view);
  view.landmarks.clear();
  stage.bone.show(milling.follower().layout(), milling.geometry(), simulation_.shown_labels());
}

bool MillingScreen::is_settled(const Stage& stage) {
  const ViewState& view = stage.view;
  return stage.bone.is_up_to_date() && !exercise_begins_ && !simulation_.milling.is_preparing() &&
         !simulation_.milling.is_placing() && !view.X_W_destination && !view.setup_changed &&
         !view.undo_requested && !view.redo_requested && !view.reset_confirmed && !view.isovalue_requested &&
         view.chosen_piece.is_settled() && !stage.files.is_busy() &&
         !(simulation_.exercise && simulation_.exercise->is_measuring());
}

// Starts the requested changes; each waits until no preparation is under way.
void MillingScreen::start_requests(ViewState& view) {
  LiveMilling& milling = simulation_.milling;
  const bool begun = view.dialogues.run_reporting_errors([&] {
    if (view.undo_requested) view.undo_requested = !milling.undo();
    if (view.redo_requested) view.redo_requested = !milling.redo();
    if (auto& removal = view.chosen_piece.requested; removal && milling.remove_pieces(*removal))
      removal.reset();
    if (view.reset_confirmed) view.reset_confirmed = !milling.reset();
    if (view.isovalue_requested && milling.change_isovalue(*view.isovalue_requested))
      view.isovalue_requested.reset();
  });
  if (!begun) drop_requests(view);
}

void MillingScreen::update(Stage& stage) {
  ViewState& view = stage.view;
  const bool updated = view.dialogues.run_reporting_errors([&] {
    const bool prepared = simulation_.milling.is_preparing();
    simulation_.update();
    if (sender_) sender_->show_tool(simulation_.milling.state().record);
    if (prepared && !simulation_.milling.is_preparing()) {
      move_tool_out_of_bone(view, simulation_, stage.window.size());
      measure_bone(view.chosen_piece, simulation_);
    }
  });
  if (!updated) view.requested_setup = simulation_.milling.setup();
  report_device_failure(view);
  if (view.message.empty()) view.message = simulation_.autosave.take_error();
}

// A device failure ends the milling, not the window.
void MillingScreen::report_device_failure(ViewState& view) {
  const std::exception_ptr failure = simulation_.milling.failure();
  if (failure == nullptr || failure == device_failure_) return;
  device_failure_ = failure;
  view.dialogues.add_error("The device has failed: " + reason_of(failure));
}

void MillingScreen::draw(Stage& stage) {
  ViewState& view = stage.view;
  const PixelSize size = stage.window.size();
  start_requests(view);
  update(stage);
  take_input(view, simulation_, space_mouse_, gamepad_, size);
  update_view_aids(view, simulation_, size);
  stage.bone.take(simulation_.milling.take_changed_bricks(), stage.frames_per_s());
  // The recording begins with a picture of the bone.
  if (exercise_begins_ && stage.bone.is_up_to_date() && stage.bone.triangle_count() > 0) {
    exercise_begins_ = false;
    stage.files.begin_recording(view, simulation_, "exercise.h5");
  }
  stage.bone.update_cuts(view, simulation_.milling.follower(),
                         view.grey_window.value_or(simulation_.scan.grey_window),
                         simulation_.has_visible_labels(view) ? simulation_.shown_labels().get() : nullptr);
  const ViewScene scene = scene_of(view, simulation_);
  stage.bone.draw(scene, size);
  if (std::exchange(view.picture_requested, false)) save_picture(stage);
  draw_view_aids(view, scene, stage.bone, size);
  draw_panels(stage);
  set_sound(stage);
}

void MillingScreen::draw_panels(Stage& stage) {
  ViewState& view = stage.view;
  const PixelSize size = stage.window.size();
  draw_annotations(view, size, !is_builtin(simulation_.scan.source.scan));
  draw_controls(view, simulation_, stage.files, size);
  draw_piece_menu(view, simulation_, size);
  const float bottom_px = stage.files.draw_message(view, simulation_, size);
  float top_px = draw_readings(view, simulation_, stage.frames_per_s(), size);
  top_px = draw_labels(view, simulation_, {top_px, bottom_px});
  draw_help(view, size, {top_px, bottom_px});
  if (const auto recording_s = stage.files.recording_s(simulation_)) draw_recording(*recording_s);
  draw_no_go(simulation_);
  draw_hand(view);
  draw_exercise(view, simulation_, stage.files, size);
}

void MillingScreen::set_sound(Stage& stage) {
  const TickRecord& record = simulation_.milling.state().record;
  const MillingSetup& setup = simulation_.milling.setup();
  SpindleState heard = spindle_state(record, setup);
  if (!stage.view.sound) heard.speed_rpm = 0;
  stage.voice.set(heard, simulation_.exercise
                             ? simulation_.exercise->beat(record.X_WT.position_mm, setup.tool.burr_radius_mm)
                             : BeatState{});
}

Image MillingScreen::picture(const Camera& camera, Stage& stage) {
  ViewScene scene = scene_of(stage.view, simulation_);
  scene.camera = camera;
  return stage.bone.picture(scene, stage.window.size());
}

void MillingScreen::save_picture(Stage& stage) {
  const Camera& camera = stage.view.camera;
  Image picture = this->picture(camera, stage);
  annotate(picture, camera, !is_builtin(simulation_.scan.source.scan), kInkOnDark, stage.window.ui_scale());
  stage.files.save_picture(stage.view, picture);
}

}  // namespace osteomill::app
