#include "app/simulate/simulator.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/base/input_error.h"

#include "app/config_file.h"
#include "app/progress.h"
#include "app/simulate/exercise_panel.h"
#include "app/simulate/panels.h"
#include "app/simulate/screen_scale.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr PixelSize kWindowSize{1280, 800};

// The command line overrides the remembered scale.
std::optional<double> text_scale_of(const SimulatorOptions& options) {
  const double remembered = options.remembered.text_scale;
  return options.ui_scale || remembered == 0 ? options.ui_scale : remembered;
}

}  // namespace

Simulator::Simulator(const SimulatorOptions& options)
    : options_(options),
      setup_(options.milling.setup),
      hardware_(open_device(options.device)),
      stage_{
          .window{"osteomill", kWindowSize, text_scale_of(options), options.remembered.place},
          .files{options.folder, [this](const Camera& camera) { return milling_->picture(camera, stage_); }}},
      keeper_(options.remembered) {
  if (hardware_) setup_.guard.limits = hardware_->limits_W(setup_.guard.limits);
  static_cast<Preferences&>(stage_.view) = options.remembered;
  stage_.view.help = !options.no_help;
}

void Simulator::run() {
  // Unsaved milling of an earlier run comes before the named scan.
  leftover_ = last_leftover_milling();
  if (leftover_) {
    ask_about_leftover();
  } else {
    open_first();
  }
  while (!update_closing()) {
    begin_picture();
    draw_screen();
    draw_dialogue(stage_.view.dialogues);
    draw_open_dialog();
    finish_picture();
  }
  keeper_.keep_now(stage_.view);
  if (options_.driver != nullptr) options_.driver->finish();
  print_results();
}

bool Simulator::is_driven() const {
  return options_.driver != nullptr &&
         (milling_ || leftover_ || start_page_ || playback_ || options_.driver->is_started_before_scan());
}

bool Simulator::is_settled() {
  if (playback_ && !is_opening()) return playback_->is_settled(stage_);
  return milling_ && milling_->is_settled(stage_) &&
         (!is_opening() || stage_.view.dialogues.current() != nullptr);
}

void Simulator::begin_picture() {
  stage_.window.begin_frame();
  if (stage_.window.take_focus_lost()) stage_.view.holding_tool = false;
  if (is_driven()) {
    const std::chrono::duration<double> passed = Clock::now() - last_picture_;
    options_.driver->inject_input(passed.count(), is_settled(), stage_.window);
  }
  last_picture_ = Clock::now();
  ImGui::NewFrame();
}

void Simulator::draw_screen() {
  const PixelSize size = stage_.window.size();
  // Do not draw the bone of a hidden window.
  const bool is_hidden = size.width < 1 || size.height < 1;
  if (milling_) {
    if (!is_hidden) draw_milling();
  } else if (is_opening()) {
    draw_waiting();
  } else if (playback_) {
    if (!is_hidden) draw_playback();
  } else if (start_page_) {
    draw_start_page();
  }
}

void Simulator::finish_picture() {
  Window& window = stage_.window;
  ViewState& view = stage_.view;
  window.hold_pointer(milling_ && view.holding_tool && !is_dialogue_open());
  window.end_frame();
  if (is_driven()) {
    options_.driver->read({window, view, simulation(), playback_ ? &playback_->playback() : nullptr,
                           stage_.files, stage_.voice.state, stage_.frames_per_s(),
                           stage_.bone.triangle_count()});
  }
  window.show();
  stage_.pictures.count();
  if (std::exchange(view.full_screen_requested, false)) window.toggle_full_screen();
  if (const int steps = std::exchange(view.text_steps, 0); steps != 0) {
    constexpr double kStep = 0.25;
    view.text_scale = std::clamp(window.ui_scale() + kStep * steps, kMinScale, kMaxScale);
    window.request_ui_scale(view.text_scale);
  }
  window.request_theme(view.theme);
  view.place = window.place();
  keeper_.keep(view);
  // A higher frame rate would only take time from other threads.
  constexpr auto kMin = 12ms;
  std::this_thread::sleep_until(last_picture_ + kMin);
}

void Simulator::draw_start_page() {
  std::optional<StartChoice> choice = start_page_->draw(stage_.window.size());
  if (const auto dropped = stage_.window.take_dropped(); !dropped.empty())
    choice = StartChoice{dropped.back()};
  if (!choice) return;
  options_.exercise.trainee = start_page_->trainee();
  stage_.view.open_requested = choice->open;
  if (choice->open == OpenKind::none) begin_file(choice->path);
}

void Simulator::draw_waiting() {
  // If several paths were dropped, use the last one.
  if (const auto asked = stage_.window.take_dropped(); !asked.empty()) begin_file(asked.back());
  if (opening_.is_ready()) install_first();
  draw_opening();
}

void Simulator::draw_playback() {
  ViewState& view = stage_.view;
  if (std::exchange(view.start_page_requested, false)) return show_start_page();
  if (const auto asked = stage_.window.take_dropped(); !asked.empty()) return begin_file(asked.back());
  if (const auto from = std::exchange(view.branch_requested, std::nullopt)) {
    OpenRequest request = scan_request("");
    request.from = *from;
    request.exercise.has_guidance = options_.exercise.has_guidance;
    return begin_opening(std::move(request));
  }
  playback_->draw(stage_);
}

void Simulator::draw_milling() {
  ViewState& view = stage_.view;
  if (std::exchange(view.start_page_requested, false)) show_start_page();
  if (!milling_) return;
  open_another();
  if (!milling_) return;
  if (std::exchange(view.reset_requested, false))
    ask_before("Resetting the bone", [&view] { view.reset_confirmed = true; });
  milling_->draw(stage_);
  if (opening_.is_begun()) draw_opening();
}

void Simulator::draw_opening() {
  // It may have been taken in this frame.
  if (!opening_.is_begun()) return;
  const bool is_cancelled = draw_loading(opening_.request().name(), opening_.share_done(),
                                         opening_.passed_s(), stage_.window.size(), milling_ != nullptr);
  if (is_cancelled) cancel_opening();
}

// Opens what the command line names, or else shows the start page.
void Simulator::open_first() {
  if (!options_.from.given() && !options_.exercise.given() && options_.scan.scan.empty() &&
      !options_.scan.isovalue) {
    start_page_.emplace(options_.exercise.trainee);
  } else {
    begin_opening({options_.scan, options_.exercise, options_.from});
  }
}

void Simulator::begin_opening(OpenRequest request) {
  changes_before_ = stage_.view.changes;
  if (request.exercise.given()) options_.exercise = request.exercise;
  opening_.begin(std::move(request), milling_ ? stage_.view.requested_setup : setup_);
}

OpenRequest Simulator::scan_request(const std::string& path) const {
  return {{path, std::nullopt, {.series = "", .max_memory_bytes = options_.scan.read.max_memory_bytes}}};
}

// Opens a scan, a recording or an exercise.
void Simulator::begin_file(const std::string& path) {
  if (std::filesystem::path(path).extension() != ".toml") return begin_opening(scan_request(path));
  ExerciseOptions exercise = options_.exercise;
  exercise.file = path;
  begin_exercise(std::move(exercise));
}

void Simulator::begin_exercise(ExerciseOptions exercise) {
  OpenRequest request = scan_request("");
  request.exercise = std::move(exercise);
  begin_opening(std::move(request));
}

void Simulator::ask_about_leftover() {
  const auto start = [this] {
    leftover_.reset();
    open_first();
  };
  const auto remove = [this, start] {
    leftover_->file.clear();
    start();
  };
  stage_.view.dialogues.add(leftover_question(
      leftover_->start, [this] { open_leftover(); }, remove, start));
}

void Simulator::open_leftover() {
  ScanOptions scan = scan_of(leftover_->start.run);
  scan.read.max_memory_bytes = options_.scan.read.max_memory_bytes;
  // Labels requested at this start replace those of the earlier run, unless that run removed pieces, whose
  // volumes are stored per label.
  std::error_code other;
  if (!options_.scan.labels.map.empty() && leftover_->start.piece_drops.empty() &&
      std::filesystem::equivalent(scan.scan, options_.scan.scan, other))
    scan.labels = options_.scan.labels;
  begin_opening({.scan = std::move(scan), .milled = std::exchange(leftover_, std::nullopt)});
}

void Simulator::cancel_opening() {
  const std::string what = opening_.request().name();
  opening_.stop();
  note_opening_cancelled(what);
}

void Simulator::note_opening_cancelled(const std::string& what) {
  stage_.view.message = "Opening " + what + " was cancelled";
  // Without a scan or a page the window would stay empty.
  if (!milling_ && !start_page_ && !playback_) closing_ = true;
}

// Opens the chosen file as if it had been dropped.
void Simulator::draw_open_dialog() {
  ViewState& view = stage_.view;
  const OpenKind kind = std::exchange(view.open_requested, OpenKind::none);
  const bool is_waiting = view.dialogues.current() != nullptr;
  if (const auto chosen = open_dialog_.draw(kind, is_waiting, view.last_folder)) stage_.window.drop(*chosen);
}

// Asks which series of a folder to open. Returns whether there are several.
bool Simulator::ask_for_series() {
  if (opened_->series.empty()) return false;
  const ScanInfo scan = opened_->scan;
  const std::vector<SeriesSummary> series = std::exchange(opened_, std::nullopt)->series;
  const auto open = [this, scan](const std::string& number) {
    OpenRequest request{scan.source};
    request.scan.read.series = number;
    begin_opening(std::move(request));
  };
  stage_.view.dialogues.add(
      series_question(scan.name, series, open, [this, scan] { note_opening_cancelled(scan.name); }));
  return true;
}

// Milling continues until another scan is opened and replaces it.
void Simulator::open_another() {
  ViewState& view = stage_.view;
  std::vector<std::string> asked = stage_.window.take_dropped();
  if (!view.exercise_requested.empty()) {
    ExerciseOptions exercise = options_.exercise;
    exercise.file = std::exchange(view.exercise_requested, {});
    begin_exercise(std::move(exercise));
  }
  if (!view.scan_requested.empty()) asked.push_back(std::exchange(view.scan_requested, {}));
  if (asked.size() > 1) {
    view.dialogues.add_error("Only one scan can be opened at a time: a file, or the folder of a series");
  } else if (!asked.empty() && !opened_) {
    begin_file(asked.front());
  }
  // Only one opened scan at a time may wait for the user's decision on the milled bone.
  if (opened_ || !opening_.is_ready()) return;
  if (!view.dialogues.run_reporting_errors([this] { opened_ = opening_.take(); })) return;
  if (ask_for_series()) return;
  const auto take = [this] { after_writing("Writing ...", [this] { install_opened(); }); };
  ask_before("Opening another scan", take, [this] { opened_.reset(); });
}

void Simulator::install_first() {
  const bool is_leftover = opening_.request().milled.has_value();
  try {
    opened_ = opening_.take();
  } catch (const std::exception& error) {
    if (!is_leftover && !start_page_ && !playback_) throw;
    stage_.view.dialogues.add_error(error.what());
    // Keep the milled bone for another start, when its scan may be available again.
    if (is_leftover) open_first();
    return;
  }
  if (!ask_for_series()) install_opened();
}

void Simulator::install_opened() {
  if (!opened_) return;
  PreparedScan opened = *std::exchange(opened_, std::nullopt);
  ViewState& view = stage_.view;
  const bool brings_tool = milling_ || opened.exercise || opened.from || !options_.is_tool_free;
  if (milling_) {
    leave_scan(opened.scan);
  } else if (!opened.playback) {
    view.requested_setup = opened.milling.session->setup();
    if (view.help) view.help = !std::exchange(view.help_seen, true);
  }
  options_.scan = opened.scan.source;
  start_page_.reset();
  stage_.window.set_title(std::filesystem::path(opened.scan.name).filename().string() + " - osteomill");
  if (!opened.playback) {
    begin_milling(std::move(opened));
    if (!brings_tool) request_remembered_tool(view);
    return;
  }
  const double at_s = opened.play_at_s;
  playback_ = std::make_unique<PlaybackScreen>(std::move(opened.playback), at_s, stage_);
}

void Simulator::leave_scan(const ScanInfo& next) {
  ViewState& view = stage_.view;
  stage_.files.end_recording(view, *simulation());
  simulation()->autosave.discard();
  view.setup_changed = view.changes != changes_before_;
  options_.command_line += " # then opened in the window: " + next.name;
  view.message = fmt::format("Opened {}: isovalue {:.4g}{}, {}", next.name, next.isovalue, next.unit,
                             next.isovalue_from);
  view.result.clear();
  milling_.reset();
}

void Simulator::begin_milling(PreparedScan opened) {
  ViewState& view = stage_.view;
  const PixelSize size = stage_.window.size();
  const ScanInfo& scan = opened.scan;
  // Continuing from a recording being played keeps its view.
  const bool keeps_view = opened.from && playback_;
  playback_.reset();
  if (!is_builtin(scan.source.scan) && !opened.exercise) note_recent_scan(scan.source.scan);
  view.box = scan.box;
  if (!keeps_view)
    view.camera = opened.exercise ? camera_on_target(opened.exercise->placed(), view.box, size)
                                  : initial_camera(view.box, size);
  const Pose X_WT = initial_tool_pose(opened, view.camera, size);
  const ToolSource tool_source{options_.device.device, hardware_.get()};
  milling_ = std::make_unique<MillingScreen>(std::move(opened), X_WT, tool_source, options_.command_line,
                                             options_.send, stage_);
}

// Returns to the start page, after asking about unsaved milling.
void Simulator::show_start_page() {
  ask_before("Returning to the start page", [this] {
    after_writing("Writing ...", [this] {
      if (milling_) {
        stage_.files.end_recording(stage_.view, *simulation());
        simulation()->autosave.discard();
      }
      milling_.reset();
      playback_.reset();
      stage_.bone.clear();
      stage_.voice.set({}, {});
      stage_.window.set_title("osteomill");
      start_page_.emplace(options_.exercise.trainee);
    });
  });
}

bool Simulator::has_unsaved() {
  return milling_ && simulation()->autosave.has_unsaved(simulation()->milling);
}

// Runs `on_proceed` at once if nothing unsaved would be lost; otherwise asks first.
void Simulator::ask_before(const char* what, const Dialogue::Action& on_proceed,
                           const Dialogue::Action& stay) {
  if (!has_unsaved()) return on_proceed();
  simulation()->milling.set_spindle(false);
  const auto save = [this, on_proceed, stay] {
    write(
        "Saving ...", [this] { stage_.files.save_scan(stage_.view, *simulation()); }, on_proceed, stay);
  };
  stage_.view.dialogues.add(unsaved_question(
      what, [this] { return !has_unsaved(); }, save, on_proceed, stay));
}

void Simulator::after_writing(const char* doing, const Dialogue::Action& then) {
  if (!stage_.files.is_busy()) return then();
  stage_.view.dialogues.add({"osteomill", doing, {}, [this] { return !stage_.files.is_busy(); }, then});
}

// Starts writing as soon as nothing else is being written. Afterwards runs `then`, or `stay` if writing
// failed, which a dialogue reports.
void Simulator::write(const char* doing, const Dialogue::Action& begin, const Dialogue::Action& then,
                      const Dialogue::Action& stay) {
  after_writing(doing, [=, this] {
    begin();
    after_writing(doing, [=, this] {
      const Dialogue::Action& next = stage_.files.is_written() ? then : stay;
      if (next) next();
    });
  });
}

bool Simulator::update_closing() {
  if (stage_.window.take_close_request()) ask_before("Closing the window", [this] { close(); });
  DialogueQueue& dialogues = stage_.view.dialogues;
  // Also while the window is too small to be drawn.
  if (milling_) stage_.files.take_result(stage_.view, *simulation());
  if (milling_ && simulation()->exercise)
    dialogues.run_reporting_errors([this] { simulation()->exercise->take_result(); });
  dialogues.proceed();
  return closing_ || (options_.driver != nullptr && options_.driver->has_close_request());
}

void Simulator::close() {
  if (milling_ && simulation()->exercise) return close_exercise();
  if (!milling_ || !stage_.files.has_unreported(*simulation())) {
    closing_ = true;
    return;
  }
  const auto reported = [this] { closing_ = reported_ = true; };
  const auto report = [this, reported] {
    write("Writing the report ...", [this] { stage_.files.end_with_report(stage_.view, *simulation()); },
          reported, {});
  };
  stage_.view.dialogues.add(report_question(report, [this] { closing_ = true; }));
}

void Simulator::close_exercise() {
  if (simulation()->exercise->is_measuring()) return close_when_measured();
  if (!simulation()->milling.is_recording()) {
    closing_ = true;
    return;
  }
  const auto measure = [this] {
    finish_exercise(stage_.view, *simulation(), stage_.files);
    close_when_measured();
  };
  stage_.view.dialogues.add(unfinished_question(measure, [this] { closing_ = true; }));
}

// Waits for the results before closing the window, unless the trainee cancels.
void Simulator::close_when_measured() {
  const auto is_measured = [this] { return !simulation()->exercise->is_measuring(); };
  stage_.view.dialogues.add(measuring_message(is_measured, [this] { closing_ = true; }));
}

// Ends a running recording and prints the files that were written.
void Simulator::print_results() {
  FilesPanel& files = stage_.files;
  const ExerciseWork* const exercise = milling_ ? simulation()->exercise.get() : nullptr;
  std::filesystem::path results;
  if (milling_) {
    if (exercise && !exercise->results().empty()) results = exercise->folder() / "debrief.csv";
    files.close(stage_.view, *simulation());
    simulation()->autosave.discard();
  }
  for (const std::string& complaint : stage_.view.dialogues.errors())
    print_error(fmt::format("osteomill: {}\n", complaint));
  const std::string recording = files.last_recording().string();
  if (!results.empty()) {
    fmt::print("{}\n{}\n", recording, results.string());
  } else if (exercise && !recording.empty()) {
    fmt::print("{0}\nIts results: osteomill debrief {0} --out results\n", recording);
  } else if (reported_) {
    fmt::print("{}\n{}\n", recording, stage_.view.message);
  } else if (!recording.empty()) {
    fmt::print("{0}\nIts report: osteomill report {0} --out report\n", recording);
  }
}

}  // namespace osteomill::app
