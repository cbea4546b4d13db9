#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/core.h>
#include <imgui.h>
#include <malloc.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/recent_rate.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/live/spindle_state.h"
#include "osteomill/openigtlink/bone_sender.h"
#include "osteomill/visual/annotations.h"
#include "osteomill/visual/image.h"
#include "osteomill/visual/scene_renderer.h"
#include "osteomill/visual/spindle_sound.h"

#include "app/branch_options.h"
#include "app/commands.h"
#include "app/config_file.h"
#include "app/device_option.h"
#include "app/exercise_options.h"
#include "app/memory_limit.h"
#include "app/milling_options.h"
#include "app/option_checks.h"
#include "app/progress.h"
#include "app/scan_options.h"
#include "app/simulate/exercise_panel.h"
#include "app/simulate/files_panel.h"
#include "app/simulate/panels.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/screen_scale.h"
#include "app/simulate/simulation.h"
#include "app/simulate/start_page.h"
#include "app/simulate/window.h"
#include "app/simulate/window_driver.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Returns whether this user has never seen the help on this machine. Leaves a file that says that it was
// seen; if none can be left the help is shown at every start.
bool note_first_help() {
  const std::filesystem::path folder = state_folder();
  if (folder.empty()) return true;
  const std::filesystem::path marker = folder / "help-seen";
  std::error_code unreadable;
  if (std::filesystem::exists(marker, unreadable)) return false;
  try {
    create_folder(folder);
    write_text_atomically(marker, [](std::ostream& text) {
      text << "The page of osteomill simulate that explains the controls was shown; F1 shows it again.\n";
    });
  } catch (const InputError&) {
    // Then it is shown again next time.
  }
  return true;
}

// Opens a scan on a thread of its own, and can be stopped: that thread then ends by itself within about a
// tenth of a second and gives its memory back. Only this object's destructor waits for it.
class Opening {
 public:
  Opening() = default;
  ~Opening() { stop(); }
  Opening(const Opening&) = delete;
  Opening& operator=(const Opening&) = delete;

  // Stops what is being opened, if anything is, and begins to open another scan.
  void begin(std::function<PreparedScan()> open) {
    stop();
    work_ = std::make_shared<Work>();
    result_ = std::async(std::launch::async, [work = work_, open = std::move(open)] {
      try {
        const WorkProgress progress([&](double share) {
          work->share_done = share;
          if (work->stopped) throw WorkStopped();
          check_memory_taken();
        });
        return open();
      } catch (const WorkStopped&) {
        ::malloc_trim(0);
        throw;
      }
    });
  }

  void stop() {
    std::erase_if(stopped_,
                  [](const auto& ended) { return ended.wait_for(0s) == std::future_status::ready; });
    if (!result_.valid()) return;
    work_->stopped = true;
    stopped_.push_back(std::move(result_));
  }

  bool valid() const { return result_.valid(); }
  std::future_status wait_for(std::chrono::milliseconds time) const { return result_.wait_for(time); }
  // Returns the opened scan, or throws the exception of opening it. Call once for each scan.
  PreparedScan get() { return result_.get(); }
  // Returns how much of opening is done, 0 to 1.
  double share_done() const { return work_ ? work_->share_done.load() : 0; }

 private:
  struct Work {
    std::atomic<double> share_done = 0;
    std::atomic<bool> stopped = false;
  };
  std::shared_ptr<Work> work_;
  std::future<PreparedScan> result_;
  std::vector<std::future<PreparedScan>> stopped_;
};

struct SimulatorOptions {
  ScanOptions scan;
  ExerciseOptions exercise;
  BranchOptions from;
  MillingOptions milling;
  DeviceOption device{kMouse};
  SendOption send;
  // How much larger than usual text is drawn; not given: as the screen needs it.
  std::optional<double> ui_scale;
  // Null: a person works the window.
  WindowDriver* driver = nullptr;
  bool no_help = false;
  // Folder of recordings and saved files.
  std::string folder = ".";
  std::string command_line;
};

constexpr PixelSize kWindowSize{1280, 800};
constexpr int kMaxPictures = 500;

// Everything between opening the window and closing it.
class Simulator {
 public:
  explicit Simulator(const SimulatorOptions& options)
      : options_(options),
        setup_(options.milling.setup),
        hardware_(open_device(options.device)),
        window_("osteomill", kWindowSize, options.ui_scale),
        files_(options.folder, [this](const Camera& camera) { return picture(camera); }) {
    if (hardware_) setup_.guard.limits = hardware_->limits_W(setup_.guard.limits);
    view_.help = !options.no_help;
  }

  void run() {
    // Unsaved milling of an earlier run comes before the scan that was named.
    leftover_ = last_leftover_milling();
    if (leftover_) {
      ask_about_leftover();
    } else {
      begin_first();
    }
    while (!update_closing()) {
      begin();
      if (simulation_) {
        work();
      } else if (opening()) {
        wait_for_scan();
      } else if (playback_) {
        play();
      } else if (start_page_) {
        choose_start();
      }
      draw_dialogue(view_.dialogues);
      finish();
    }
    if (options_.driver != nullptr) options_.driver->finish();
    std::filesystem::path results;
    if (simulation_) {
      if (simulation_->exercise && !simulation_->exercise->results().empty())
        results = simulation_->exercise->folder() / "debrief.csv";
      files_.close(view_, *simulation_);
      simulation_->autosave.discard();
    }
    for (const std::string& complaint : view_.dialogues.errors())
      app::print_error(fmt::format("osteomill: {}\n", complaint));
    if (!results.empty()) {
      fmt::print("{}\n{}\n", files_.last_recording().string(), results.string());
    } else if (simulation_ && simulation_->exercise && !files_.last_recording().empty()) {
      fmt::print("{0}\nIts results: osteomill debrief {0} --out results\n", files_.last_recording().string());
    } else if (reported_) {
      fmt::print("{}\n{}\n", files_.last_recording().string(), view_.message);
    } else if (!files_.last_recording().empty()) {
      fmt::print("{0}\nIts report: osteomill report {0} --out report\n", files_.last_recording().string());
    }
  }

 private:
  bool is_driven() const {
    return options_.driver != nullptr &&
           (simulation_ || leftover_ || start_page_ || playback_ || options_.driver->starts_before_scan());
  }

  bool has_unsaved() const { return simulation_ && simulation_->autosave.has_unsaved(simulation_->milling); }

  // Does `on_proceed` at once if nothing unsaved would be lost by it; else asks first.
  void ask_before(const char* what, const Dialogue::Action& on_proceed, const Dialogue::Action& stay = {}) {
    if (!has_unsaved()) return on_proceed();
    simulation_->milling.set_spindle(false);
    const auto save = [this, on_proceed, stay] {
      write(
          "Saving ...", [this] { files_.save_scan(view_, *simulation_); }, on_proceed, stay);
    };
    view_.dialogues.add(unsaved_question(
        what, [this] { return !has_unsaved(); }, save, on_proceed, stay));
  }

  void after_writing(const char* doing, const Dialogue::Action& then) {
    if (!files_.is_busy()) return then();
    view_.dialogues.add({"osteomill", doing, {}, [this] { return !files_.is_busy(); }, then});
  }

  // Begins to write as soon as nothing else is being written. Once it is written `then` follows; if that
  // failed, `stay`: a dialogue then says why.
  void write(const char* doing, const Dialogue::Action& begin, const Dialogue::Action& then,
             const Dialogue::Action& stay) {
    after_writing(doing, [=, this] {
      begin();
      after_writing(doing, [=, this] {
        const Dialogue::Action& next = files_.is_written() ? then : stay;
        if (next) next();
      });
    });
  }

  // Waits for the results before it closes the window, unless the trainee gives them up.
  void close_when_measured() {
    const auto is_measured = [this] { return !simulation_->exercise->is_measuring(); };
    view_.dialogues.add(measuring_message(is_measured, [this] { closing_ = true; }));
  }

  void close_exercise() {
    if (simulation_->exercise->is_measuring()) return close_when_measured();
    if (!simulation_->milling.is_recording()) {
      closing_ = true;
      return;
    }
    const auto measure = [this] {
      finish_exercise(view_, *simulation_, files_);
      close_when_measured();
    };
    view_.dialogues.add(unfinished_question(measure, [this] { closing_ = true; }));
  }

  void close() {
    if (simulation_ && simulation_->exercise) return close_exercise();
    if (!simulation_ || !files_.has_unreported(*simulation_)) {
      closing_ = true;
      return;
    }
    const auto reported = [this] { closing_ = reported_ = true; };
    const auto report = [this, reported] {
      write("Writing the report ...", [this] { files_.end_with_report(view_, *simulation_); }, reported, {});
    };
    view_.dialogues.add(report_question(report, [this] { closing_ = true; }));
  }

  bool update_closing() {
    if (window_.take_close_asked()) ask_before("Closing the window", [this] { close(); });
    // Also while the window is too small to be drawn.
    if (simulation_) files_.take_result(view_, *simulation_);
    if (simulation_ && simulation_->exercise)
      view_.dialogues.run_reporting_errors([this] { simulation_->exercise->take_result(); });
    view_.dialogues.proceed();
    return closing_ || (options_.driver != nullptr && options_.driver->wants_to_close());
  }

  void begin() {
    window_.begin_frame();
    const bool is_played = playback_ && !opening() && to_draw_.empty() && playback_->is_verified();
    const bool settled =
        is_played ||
        (simulation_ && to_draw_.empty() && !exercise_begins_ && !simulation_->milling.is_preparing() &&
         !simulation_->milling.is_placing() && !view_.X_W_destination && !view_.setup_changed &&
         !view_.undo_requested && !view_.reset_confirmed && !view_.isovalue_requested && !files_.is_busy() &&
         !(simulation_->exercise && simulation_->exercise->is_measuring()) &&
         (!opening() || view_.dialogues.current() != nullptr));
    if (is_driven()) options_.driver->give_input(seconds_since(last_picture_), settled, window_);
    last_picture_ = Clock::now();
    ImGui::NewFrame();
  }

  void ask_about_leftover() {
    const auto start = [this] {
      leftover_.reset();
      begin_first();
    };
    const auto remove = [this, start] {
      leftover_->file.clear();
      start();
    };
    view_.dialogues.add(leftover_question(
        leftover_->start, [this] { open_leftover(); }, remove, start));
  }

  void open_leftover() {
    ScanOptions scan = scan_of(leftover_->start.run);
    scan.read.max_memory_bytes = options_.scan.read.max_memory_bytes;
    // The labels that were asked for at this start come before those of the earlier run.
    std::error_code other;
    if (!options_.scan.labels.map.empty() &&
        std::filesystem::equivalent(scan.scan, options_.scan.scan, other))
      scan.labels = options_.scan.labels;
    opened_milled_ = std::move(leftover_->file);
    open(scan, std::exchange(leftover_, std::nullopt)->start);
  }

  bool opening() const { return opening_.valid() || opened_; }

  // Opens what was named, or else shows the start page.
  void begin_first() {
    if (options_.from.given()) {
      begin_branch(options_.from, options_.scan, options_.exercise);
    } else if (options_.exercise.given()) {
      begin_exercise(options_.exercise, options_.scan);
    } else if (options_.scan.scan.empty() && !options_.scan.isovalue) {
      start_page_.emplace();
    } else {
      begin_opening(options_.scan);
    }
  }

  void choose_start() {
    std::optional<StartChoice> choice = start_page_->draw(window_.size());
    if (const auto dropped = window_.take_dropped(); !dropped.empty())
      choice = StartChoice{"", "", dropped.back()};
    if (!choice) return;
    if (choice->exercise.empty()) return begin_opening(scan_options_for(choice->scan));
    ExerciseOptions exercise = options_.exercise;
    exercise.file = choice->exercise;
    if (!choice->trainee.empty()) exercise.trainee = choice->trainee;
    begin_exercise(exercise, scan_options_for(""));
  }

  // Opens a scan, or a recording to be played.
  void begin_opening(const ScanOptions& scan) {
    opened_milled_.reset();
    if (!is_hdf5(scan.scan)) return open(scan, {});
    opened_scan_ = scan;
    setup_to_open();
    opening_.begin([recording = scan.scan, of_recording = scan_options_for("")] {
      return open_for_playback(recording, of_recording, {});
    });
  }

  void begin_branch(const BranchOptions& from, const ScanOptions& scan, const ExerciseOptions& exercise) {
    opened_scan_ = scan;
    opened_scan_.scan = from.recording;
    const GuardSettings guard = setup_to_open().guard;
    opening_.begin([from, scan, exercise, guard] { return open_for_branch(from, scan, exercise, guard); });
  }

  MillingSetup setup_to_open() {
    opening_since_ = Clock::now();
    changes_before_ = view_.changes;
    return simulation_ ? view_.requested_setup : setup_;
  }

  void begin_exercise(const ExerciseOptions& exercise, const ScanOptions& scan) {
    opened_milled_.reset();
    opened_scan_ = scan;
    opened_scan_.scan = exercise.file;
    options_.exercise = exercise;
    opening_.begin(
        [exercise, scan, setup = setup_to_open()] { return open_exercise(exercise, scan, setup); });
  }

  void open(const ScanOptions& scan, SessionStart milled) {
    opened_scan_ = scan;
    const MillingSetup setup = setup_to_open();
    opening_.begin(
        [scan, setup, milled = std::move(milled)] { return open_for_milling(scan, setup, milled); });
  }

  void draw_opening() {
    const std::string what = opened_scan_.scan.empty() ? kBuiltinTooth : opened_scan_.scan;
    const bool is_cancelled = draw_loading(what, opening_.share_done(), seconds_since(opening_since_),
                                           window_.size(), simulation_ != nullptr);
    if (is_cancelled) cancel_opening(what);
  }

  void cancel_opening(const std::string& what) {
    opening_.stop();
    opened_milled_.reset();
    view_.message = "Opening " + what + " was given up";
    // Without a scan or a page the window would stay empty.
    if (!simulation_ && !start_page_ && !playback_) closing_ = true;
  }

  ScanOptions scan_options_for(const std::string& scan) const {
    return {scan, std::nullopt, {.series = "", .max_memory_bytes = options_.scan.read.max_memory_bytes}};
  }

  // Milling goes on until another scan was read and takes its place.
  void open_another() {
    std::vector<std::string> asked = window_.take_dropped();
    if (!view_.exercise_requested.empty()) {
      options_.exercise.file = std::exchange(view_.exercise_requested, {});
      begin_exercise(options_.exercise, scan_options_for(""));
    }
    if (!view_.scan_requested.empty()) asked.push_back(std::exchange(view_.scan_requested, {}));
    if (asked.size() > 1) {
      view_.dialogues.add_error("One scan at a time: a file, or the folder of a series");
    } else if (!asked.empty() && !opened_) {
      begin_opening(scan_options_for(asked.front()));
    }
    if (!opening_.valid() || opening_.wait_for(0s) != std::future_status::ready) return;
    if (!view_.dialogues.run_reporting_errors([this] { opened_ = opening_.get(); })) return;
    const auto take = [this] { after_writing("Writing ...", [this] { take_scan(); }); };
    ask_before("Opening another scan", take, [this] { opened_.reset(); });
  }

  void take_scan() {
    PreparedScan opened = std::move(*opened_);
    opened_.reset();
    const ScanInfo& scan = opened.scan;
    if (simulation_) {
      files_.end_recording(view_, *simulation_);
      simulation_->autosave.discard();
      view_.setup_changed = view_.changes != changes_before_;
      options_.command_line += " # then opened in the window: " + scan.name;
      view_.message = fmt::format("Opened {}: isovalue {:.4g}{}, {}", scan.name, scan.isovalue, scan.unit,
                                  scan.isovalue_from);
      view_.result.clear();
      sender_.reset();
      simulation_.reset();
    } else if (!opened.playback) {
      view_.requested_setup = opened.milling.session->setup();
      view_.help = view_.help && note_first_help();
    }
    options_.scan = scan.source;
    start_page_.reset();
    if (opened.playback) return take_playback(std::move(opened.playback));
    const bool looks_on = opened.from && playback_;
    playback_.reset();
    if (!is_builtin(scan.source.scan) && !opened.exercise) note_recent_scan(scan.source.scan);
    const PixelSize size = window_.size();
    view_.box = scan.box;
    window_.set_title(std::filesystem::path(scan.name).filename().string() + " - osteomill");
    if (!looks_on) view_.camera = first_camera(view_.box, size);
    if (opened.exercise && !looks_on)
      view_.camera = camera_on_target(opened.exercise->placed(), view_.box, size);
    const Volume& bone = opened.milling.session->volume();
    // In front of the bone's upper half, so that the shaft does not hide the bone.
    const std::optional<Pose>& recorded = opened.milling.handover.X_WT;
    const Pose X_WT = recorded ? *recorded
                               : tool_pose_before_middle(bone, opened.milling.session->setup().tool,
                                                         view_.camera, size, 0.15 * size.height);
    const ToolSource tool_source{options_.device.device, hardware_.get()};
    simulation_ = std::make_unique<Simulation>(std::move(opened), X_WT, tool_source, options_.command_line,
                                               std::exchange(opened_milled_, std::nullopt));
    if (simulation_->from) files_.begin_recording(view_, *simulation_, "again.h5");
    simulation_->start();
    // If nothing listens there, milling goes on without sending.
    view_.dialogues.run_reporting_errors(
        [&] { sender_ = send_bone(simulation_->milling.follower(), options_.send); });
    reset_view();
    view_.requested_setup.tool = simulation_->milling.setup().tool;
    exercise_begins_ = simulation_->exercise != nullptr && !simulation_->from;
  }

  void take_playback(std::unique_ptr<Playback> playback) {
    playback_ = std::move(playback);
    view_.message.clear();
    heard_ = {};
    sound_.set(heard_, {});
    view_.box = playback_->box();
    view_.camera = first_camera(view_.box, window_.size());
    window_.set_title(playback_->recording().path.filename().string() + " - osteomill");
    reset_cuts(view_);
    cuts_ = {};
    to_draw_.clear();
    const Volume& bone = playback_->work().bone.volume;
    renderer_ =
        std::make_unique<SceneRenderer>(playback_->follower().layout(), bone.geometry(), playback_->labels());
    if (!options_.from.given() && options_.from.at_s > 0)
      playback_->go_to_time(std::exchange(options_.from.at_s, 0));
  }

  // A picture of the recording that is played.
  void play() {
    const PixelSize size = window_.size();
    if (size.width < 1 || size.height < 1) return;
    if (std::exchange(view_.start_page_requested, false)) return show_start_page();
    if (const auto asked = window_.take_dropped(); !asked.empty())
      return begin_opening(scan_options_for(asked.back()));
    if (const auto from = std::exchange(view_.branch_requested, std::nullopt))
      return begin_branch(*from, scan_options_for(""), {.has_guidance = options_.exercise.has_guidance});
    const auto now = Clock::now();
    // Nothing was played while a file was opened or the window hidden.
    constexpr double kLongestPicture_s = 0.25;
    const std::chrono::duration<double> passed = now - std::exchange(played_, now);
    playback_->advance(std::min(passed.count(), kLongestPicture_s));
    if (playback_->follows_recorded_view()) show_view(*playback_->view(), view_);
    const Camera before = view_.camera;
    take_view_input(view_, size);
    if (view_.camera != before) playback_->follow_recorded_view(false);
    take_surface(playback_->take_changed_bricks());
    cuts_.update(view_, playback_->follower(), playback_->grey_window(), nullptr, *renderer_);
    renderer_->draw(scene_of(view_, *playback_), size);
    renderer_->copy_to_window();
    draw_playback(view_, *playback_, size);
  }

  void reset_view() {
    LiveMilling& milling = simulation_->milling;
    view_.X_W_target = milling.state().record.X_WD;
    view_.isovalue.reset();
    drop_requests();
    view_.X_W_destination.reset();
    view_.holding_tool = view_.dragging_tool = view_.dragging_view = view_.pedal_down = false;
    view_.dragged_cut = -1;
    reset_cuts(view_);
    cuts_ = {};
    to_draw_.clear();
    renderer_ = std::make_unique<SceneRenderer>(milling.follower().layout(), milling.geometry(),
                                                simulation_->shown_labels());
  }

  void wait_for_scan() {
    // If several paths were dropped, the last one counts.
    if (const auto asked = window_.take_dropped(); !asked.empty())
      begin_opening(scan_options_for(asked.back()));
    if (opening_.wait_for(0s) == std::future_status::ready) take_first_scan();
    draw_opening();
  }

  void take_first_scan() {
    try {
      opened_ = opening_.get();
    } catch (const std::exception& error) {
      if (!opened_milled_ && (start_page_ || playback_)) {
        view_.dialogues.add_error(error.what());
        return;
      }
      if (!opened_milled_) throw;
      // The milled bone is kept for another start, when its scan may be there again.
      view_.dialogues.add_error(error.what());
      begin_first();
      return;
    }
    take_scan();
  }

  // Goes back to the start page, once what was milled may be lost.
  void show_start_page() {
    ask_before("Going to the start page", [this] {
      after_writing("Writing ...", [this] {
        if (simulation_) {
          files_.end_recording(view_, *simulation_);
          simulation_->autosave.discard();
        }
        sender_.reset();
        simulation_.reset();
        playback_.reset();
        renderer_.reset();
        window_.set_title("osteomill");
        start_page_.emplace();
      });
    });
  }

  // Begins the requested changes; each waits until nothing else is being prepared.
  void start_requests() {
    LiveMilling& milling = simulation_->milling;
    const bool begun = view_.dialogues.run_reporting_errors([&] {
      if (view_.undo_requested) view_.undo_requested = !milling.undo();
      if (view_.reset_confirmed) view_.reset_confirmed = !milling.reset();
      if (view_.isovalue_requested && milling.change_isovalue(*view_.isovalue_requested))
        view_.isovalue_requested.reset();
    });
    if (!begun) drop_requests();
  }

  void drop_requests() {
    view_.undo_requested = view_.reset_confirmed = view_.finish_requested = false;
    view_.isovalue_requested.reset();
  }

  // A device that throws ends the milling, not the window.
  void complain_of_device() {
    const std::exception_ptr failure = simulation_->milling.failure();
    if (failure == nullptr || failure == device_failure_) return;
    device_failure_ = failure;
    view_.dialogues.add_error("The device has failed: " + reason_of(failure));
  }

  void work() {
    const PixelSize size = window_.size();
    if (size.width < 1 || size.height < 1) return;
    if (std::exchange(view_.start_page_requested, false)) show_start_page();
    if (!simulation_) return;
    open_another();
    if (!simulation_) return;
    if (std::exchange(view_.reset_requested, false)) {
      ask_before("Resetting the bone", [this] { view_.reset_confirmed = true; });
    }
    start_requests();
    const bool updated = view_.dialogues.run_reporting_errors([&] {
      const bool prepared = simulation_->milling.is_preparing();
      simulation_->update();
      if (sender_) sender_->show_tool(simulation_->milling.state().record);
      if (prepared && !simulation_->milling.is_preparing()) free_tool(view_, *simulation_, size);
    });
    if (!updated) view_.requested_setup = simulation_->milling.setup();
    complain_of_device();
    if (view_.message.empty()) view_.message = simulation_->autosave.take_error();
    take_input(view_, *simulation_, space_mouse_, size);
    take_surface(simulation_->milling.take_changed_bricks());
    // The recording begins with a picture of the bone.
    if (exercise_begins_ && to_draw_.empty() && renderer_->triangle_count() > 0) {
      exercise_begins_ = false;
      files_.begin_recording(view_, *simulation_, "exercise.h5");
    }
    cuts_.update(view_, simulation_->milling.follower(), simulation_->scan.grey_window,
                 simulation_->shows_labels(view_) ? simulation_->shown_labels().get() : nullptr, *renderer_);
    renderer_->draw(scene_of(view_, *simulation_), size);
    renderer_->copy_to_window();
    if (std::exchange(view_.picture_requested, false)) save_picture();
    draw_annotations(view_, size, !is_builtin(options_.scan.scan));
    draw_controls(view_, *simulation_, files_, size);
    const float bottom_px = files_.draw_message(view_, *simulation_, size);
    float top_px = draw_readings(view_, *simulation_, pictures_per_s(), size);
    top_px = draw_labels(view_, *simulation_, {top_px, bottom_px});
    draw_help(view_, size, {top_px, bottom_px});
    if (opening_.valid()) draw_opening();
    if (const auto recording_s = files_.recording_s(*simulation_)) draw_recording(*recording_s);
    draw_no_go(*simulation_);
    draw_exercise(view_, *simulation_, files_, size);
    set_sound();
  }

  double pictures_per_s() { return pictures_.per_s(seconds_since({})); }

  void set_sound() {
    const TickRecord& record = simulation_->milling.state().record;
    const MillingSetup& setup = simulation_->milling.setup();
    heard_ = spindle_state(record, setup);
    if (!view_.sound) heard_.speed_rpm = 0;
    sound_.set(heard_, simulation_->exercise
                           ? simulation_->exercise->beat(record.X_WT.position_mm, setup.tool.burr_radius_mm)
                           : BeatState{});
  }

  void take_surface(ChangedBricks changed) {
    changed.merge(to_draw_);
    to_draw_ = std::move(changed);
    // All bricks of a large bone take longer than a picture may. But if pictures take long anyway, as
    // without a graphics card, too few at a time would take minutes.
    const double max_s = std::max(0.02, 0.5 / std::max(pictures_per_s(), 1.0));
    for (const auto start = Clock::now(); !to_draw_.empty() && seconds_since(start) < max_s;
         to_draw_.erase(to_draw_.begin())) {
      renderer_->set_brick(to_draw_.begin()->first, to_draw_.begin()->second);
    }
  }

  // Drawn until it has full detail.
  Image picture(const Camera& camera) {
    ViewScene scene = scene_of(view_, *simulation_);
    scene.camera = camera;
    renderer_->draw(scene, window_.size());
    for (int n = 0; n < kMaxPictures && !renderer_->is_settled(); ++n) renderer_->draw(scene, window_.size());
    return renderer_->picture();
  }

  void save_picture() {
    view_.dialogues.run_reporting_errors([this] {
      Image picture = this->picture(view_.camera);
      annotate(picture, view_.camera, !is_builtin(options_.scan.scan), kInkOnDark, window_.ui_scale());
      create_folder(options_.folder);
      const auto path = files_.name("picture.png");
      write_png(path, picture);
      view_.message = "Saved " + path.string();
      view_.result = path;
    });
  }

  void finish() {
    window_.end_frame();
    if (is_driven()) {
      options_.driver->read({window_, view_, simulation_.get(), playback_.get(), files_, heard_,
                             pictures_per_s(), renderer_ ? renderer_->triangle_count() : 0});
    }
    window_.show();
    pictures_.count();
    if (std::exchange(view_.full_screen_requested, false)) window_.toggle_full_screen();
    if (const int steps = std::exchange(view_.text_steps, 0); steps != 0) {
      constexpr double kStep = 0.25;
      window_.ask_ui_scale(std::clamp(window_.ui_scale() + kStep * steps, kMinScale, kMaxScale));
    }
    // More pictures than anyone sees would only take time from the other threads.
    constexpr auto kMin = 12ms;
    std::this_thread::sleep_until(last_picture_ + kMin);
  }

  SimulatorOptions options_;
  // The first scan is opened with it.
  MillingSetup setup_;
  std::unique_ptr<ConnectedDevice> hardware_;
  Window window_;
  // Until something is opened.
  std::optional<StartPage> start_page_;
  // The failure that the user was told of.
  std::exception_ptr device_failure_;
  Opening opening_;
  // Milled bone of an earlier run that is offered to the user.
  std::optional<LeftoverMilling> leftover_;
  // A scan that was read, and waits for the answer to what becomes of the one that is milled.
  std::optional<PreparedScan> opened_;
  std::optional<AutosaveFile> opened_milled_;
  ScanOptions opened_scan_;
  Clock::time_point opening_since_;
  int changes_before_ = 0;
  // A recording that is played; nothing is milled then.
  std::unique_ptr<Playback> playback_;
  Clock::time_point played_ = Clock::now();
  std::unique_ptr<SceneRenderer> renderer_;
  // Changed bricks of the surface.
  ChangedBricks to_draw_;
  // True from when an exercise was opened until it is recorded.
  bool exercise_begins_ = false;
  bool closing_ = false;
  bool reported_ = false;
  ViewState view_;
  FilesPanel files_;
  CutUpdates cuts_;
  SoundPlayer sound_;
  SpindleState heard_;
  SpaceMouse space_mouse_;
  RecentRate pictures_;
  Clock::time_point last_picture_ = Clock::now();
  // Destroyed before all that stands above, which its ticks refer to.
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<BoneSender> sender_;
};

}  // namespace

void add_simulate_command(CLI::App& program, const std::string& command_line, WindowDriver* driver) {
  auto options = std::make_shared<SimulatorOptions>();
  options->driver = driver;
  options->command_line = command_line;
  options->milling.setup.cutting_reaction = options->milling.setup.drag = true;
  options->milling.setup.vibration.on = true;
  options->milling.setup.law = CuttingLaw::chips;
  CLI::App* command = program.add_subcommand(
      "simulate",
      "Open the window: see the bone, take the burr, mill; or play a recording in the scan's place");
  command->group("In a window");
  add_scan_options(*command, options->scan);
  add_exercise_options(*command, options->exercise);
  add_guidance_option(*command, options->exercise);
  add_branch_options(*command, options->from);
  // A recording in the place of the scan is played from there.
  CLI::Option* const at = command->get_option("--at");
  at->remove_needs(command->get_option("--from"));
  command->option_defaults()->group("Algorithm");
  add_algorithm_option(*command, options->milling.setup.algorithm);
  add_milling_options(*command, options->milling);
  add_device_option(*command, options->device);
  add_rate_option(*command, options->milling.setup.tick_s);
  add_send_options(*command, options->send);
  command->option_defaults()->group("The window");
  command->add_option("--out", options->folder, "Folder for recordings and saved files")
      ->type_name("FOLDER")
      ->capture_default_str();
  command
      ->add_option("--ui-scale", options->ui_scale,
                   "Scale of the text, 1 is usual and 2 suits 4K (default: as the screen asks for)")
      ->check(number_of({.min = kMinScale, .max = kMaxScale}))
      ->type_name("NUMBER");
  command->add_flag("--no-help", options->no_help,
                    "Begin without the page that explains the controls (default: shown on the first start)");
  command->callback([=] {
    apply_config_file(*command);
    settle_law(*command, options->milling.setup);
    if (options->from.given()) refuse_recorded_options(*command);
    if (at->count() > 0 && !options->from.given() && !is_hdf5(options->scan.scan))
      throw CLI::RequiredError("--at: --from, or a recording to be played,");
    Simulator(*options).run();
  });
}

}  // namespace osteomill::app
