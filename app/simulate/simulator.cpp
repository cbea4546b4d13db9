#include "app/simulate/simulator.h"

#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "app/simulate/overlay.h"
#include "app/simulate/panels.h"
#include "app/simulate/pointer.h"
#include "app/simulate/scene_of.h"
#include "app/simulate/simulation.h"
#include "app/simulate/ui_script.h"
#include "app/simulate/window.h"
#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/view/scene_renderer.h"

namespace osteomill::app {

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// How many pictures the last second had.
class PictureRate {
 public:
  void count() {
    ++pictures_;
    const double passed_s = seconds_since(start_);
    if (passed_s < 1) return;
    rate_ = pictures_ / passed_s;
    start_ = Clock::now();
    pictures_ = 0;
  }
  double per_s() const { return rate_; }

 private:
  Clock::time_point start_ = Clock::now();
  int pictures_ = 0;
  double rate_ = 0;
};

// Everything between opening the window and closing it.
class Simulator {
 public:
  explicit Simulator(const SimulatorOptions& options)
      : options_(options), window_("osteomill", options.size) {
    if (!options.script.empty()) script_.emplace(options.script);
    view_.help = !options.no_help;
  }

  void run() {
    opening_ = std::async(std::launch::async, [this] {
      return Simulation::open(options_.scan, options_.settings, options_.command_line);
    });
    while (!window_.closing()) {
      begin();
      if (simulation_) {
        work();
      } else {
        wait_for_scan();
      }
      finish();
    }
  }

 private:
  void begin() {
    window_.begin_frame();
    const bool settled = simulation_ && !simulation_->preparing() && !view_.wanted_is_new;
    if (script_ && simulation_) script_->feed(seconds_since(last_picture_), settled, window_);
    last_picture_ = Clock::now();
    ImGui::NewFrame();
  }

  void wait_for_scan() {
    if (opening_.wait_for(0s) == std::future_status::ready) {
      simulation_ = opening_.get();
      view_.bounds = bounds_of_bone(simulation_->bone(), simulation_->isovalue());
      view_.camera = camera_on_entry(simulation_->entry(), view_.bounds);
      view_.X_W_target = simulation_->state().record.X_WD;
      view_.wanted = simulation_->settings();
      renderer_ =
          std::make_unique<SceneRenderer>(simulation_->surface().layout(), simulation_->bone().geometry());
      surface_number_ = simulation_->surface_number();
    }
    const std::string what = options_.scan.scan.empty() ? "built-in tooth" : options_.scan.scan;
    draw_loading(what, seconds_since(start_), window_.size());
  }

  void work() {
    const PixelSize size = window_.size();
    if (size.width < 1 || size.height < 1) return;
    try {
      simulation_->update();
    } catch (const std::exception& error) {
      view_.complaint = error.what();
      view_.wanted = simulation_->settings();
    }
    take_input(view_, *simulation_, size);
    take_surface();
    renderer_->draw(scene_of(view_, *simulation_), size);
    renderer_->copy_to_window();
    draw_annotations(view_, size, !options_.scan.scan.empty());
    draw_controls(view_, *simulation_, size);
    draw_readings(*simulation_, rate_.per_s(), size);
    draw_help(view_, size);
    draw_complaint(view_);
  }

  void take_surface() {
    if (simulation_->surface_number() != surface_number_) {
      renderer_->clear();
      surface_number_ = simulation_->surface_number();
    }
    for (const ChangedBrick& changed : simulation_->surface().take_changed_bricks()) {
      renderer_->set_brick(changed.brick, changed.mesh);
    }
  }

  void finish() {
    window_.end_frame();
    if (script_ && simulation_) {
      if (const std::string text = script_->after_drawing(window_); !text.empty()) say(text);
    }
    window_.show();
    rate_.count();
    if (std::exchange(view_.full_screen_asked, false)) window_.toggle_full_screen();
    // Faster than anyone sees only takes time from the others.
    constexpr auto kShortest = 12ms;
    std::this_thread::sleep_until(last_picture_ + kShortest);
  }

  void say(const std::string& text) {
    const TimingSummary timing = simulation_->timing();
    const TickRecord& record = simulation_->state().record;
    fmt::print(
        "{}: {:.1f} pictures/s, {} triangles, {:.1f} Hz, {} late, step p99 {:.0f} us, force {:.2f} N, "
        "removed {:.3f} mm^3\n",
        text, rate_.per_s(), renderer_->triangle_count(), timing.rate_hz, timing.late_ticks,
        timing.step.p99_us, record.wrench.force_N.norm(), record.removed_mm3);
    std::fflush(stdout);
  }

  SimulatorOptions options_;
  Window window_;
  std::optional<UiScript> script_;
  std::future<std::unique_ptr<Simulation>> opening_;
  std::unique_ptr<SceneRenderer> renderer_;
  int surface_number_ = 0;
  ViewState view_;
  PictureRate rate_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_picture_ = Clock::now();
  // Ends first: no tick outlives what it tells of.
  std::unique_ptr<Simulation> simulation_;
};

}  // namespace

void run_simulator(const SimulatorOptions& options) {
  Simulator(options).run();
}

}  // namespace osteomill::app
