#include "tests/window/driver/ui_script.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include <GLFW/glfw3.h>
#include <fmt/core.h>
#include <imgui.h>

#include "osteomill/base/input_error.h"
#include "osteomill/visual/image.h"

#include "app/simulate/widgets.h"
#include "tests/window/driver/state_text.h"

namespace osteomill::app {

namespace {

// Number of frames of a click (move, button down, button up), and of a drag, which also moves in between.
constexpr int kClickPictures = 6;
constexpr int kDragPictures = 12;

const std::map<std::string, std::size_t> kWords{
    {"at-once", 0},    {"resize", 2},   {"wait", 1},  {"settle", 0},  {"glide", 3}, {"press", 1},
    {"release", 1},    {"wheel", 2},    {"key", 1},   {"hold", 2},    {"click", 1}, {"drag", 2},
    {"screenshot", 1}, {"say", 1},      {"type", 1},  {"open", 1},    {"quit", 0},  {"close", 0},
    {"state", 1},      {"controls", 1}, {"await", 1}, {"display", 0}, {"colour", 1}};

const std::map<std::string, int> kKeys{
    {"space", GLFW_KEY_SPACE},      {"enter", GLFW_KEY_ENTER},          {"escape", GLFW_KEY_ESCAPE},
    {"shift", GLFW_KEY_LEFT_SHIFT}, {"control", GLFW_KEY_LEFT_CONTROL}, {"arrow-up", GLFW_KEY_UP},
    {"arrow-down", GLFW_KEY_DOWN},  {"arrow-left", GLFW_KEY_LEFT},      {"arrow-right", GLFW_KEY_RIGHT},
    {"page-up", GLFW_KEY_PAGE_UP},  {"page-down", GLFW_KEY_PAGE_DOWN},  {"f1", GLFW_KEY_F1},
    {"f11", GLFW_KEY_F11},          {"backspace", GLFW_KEY_BACKSPACE}};

// Actions that run after the frame is drawn.
const std::set<std::string> kDrawnFirst{"screenshot", "say", "state", "colour"};

int key_named(const std::string& name) {
  if (const auto found = kKeys.find(name); found != kKeys.end()) return found->second;
  if (name.size() == 1 && std::isalnum(static_cast<unsigned char>(name[0])) != 0) {
    return std::toupper(static_cast<unsigned char>(name[0]));
  }
  return -1;
}

const std::map<std::string, std::size_t> kButtons{{"left", 0}, {"right", 1}, {"middle", 2}};

}  // namespace

UiScript::UiScript(const std::filesystem::path& path) : path_(path) {
  std::ifstream file(path);
  if (!file) throw InputError(path.string(), "cannot be read");
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream text(line);
    Action action;
    action.line = number;
    if (!(text >> action.name) || action.name[0] == '#') continue;
    std::getline(text >> std::ws, action.text);
    std::istringstream rest(action.text);
    for (std::string word; rest >> word;) action.words.push_back(word);
    const auto known = kWords.find(action.name);
    if (known == kWords.end() || action.words.size() < known->second) {
      throw InputError(path.string(), fmt::format("line {}: '{}' is not an action", number, line));
    }
    actions_.push_back(action);
  }
}

double UiScript::number(const Action& action, std::size_t word) const {
  try {
    return std::stod(action.words.at(word));
  } catch (const std::exception&) {
    throw InputError(path_.string(), fmt::format("line {}: a number is missing", action.line));
  }
}

int UiScript::key_of(const Action& action) const {
  const int key = key_named(action.words[0]);
  if (key < 0) throw InputError(path_.string(), fmt::format("line {}: no such key", action.line));
  return key;
}

void UiScript::press(const Action& action, bool down) {
  if (const auto button = kButtons.find(action.words[0]); button != kButtons.end()) {
    buttons_[button->second] = down;
  } else if (down) {
    held_keys_.insert(key_of(action));
  } else {
    held_keys_.erase(key_of(action));
  }
}

void UiScript::begin(const Action& action, Window& window) {
  begun_ = true;
  time_left_s_ = 0;
  to_x_ = x_;
  to_y_ = y_;
  const std::string& name = action.name;
  if (name == "wait") {
    time_left_s_ = number(action, 0);
  } else if (name == "glide") {
    to_x_ = static_cast<float>(number(action, 0));
    to_y_ = static_cast<float>(number(action, 1));
    time_left_s_ = number(action, 2);
  } else if (name == "press" || name == "release") {
    press(action, name == "press");
  } else if (name == "wheel") {
    wheel_left_ = number(action, 0);
    time_left_s_ = number(action, 1);
  } else if (name == "key" || name == "hold") {
    keys_.push_back(key_of(action));
    time_left_s_ = name == "hold" ? number(action, 1) : 0.05;
  } else if (name == "click" || name == "drag") {
    std::string label = action.text;
    if (name == "drag") label.resize(label.rfind(' '));
    const auto found = ui::widget_states().find(label);
    if (found == ui::widget_states().end() || found->second.frame < ImGui::GetFrameCount() - 1) {
      throw InputError(path_.string(),
                       fmt::format("line {}: nothing is called '{}' now", action.line, label));
    }
    x_ = to_x_ = found->second.middle.x;
    y_ = to_y_ = found->second.middle.y;
    if (name == "drag") to_x_ += static_cast<float>(number(action, action.words.size() - 1));
    click_picture_ = 1;
  } else if (name == "type") {
    ImGui::GetIO().AddInputCharactersUTF8(action.text.c_str());
  } else if (name == "open") {
    window.drop(action.text);
  } else if (name == "resize") {
    window.resize({static_cast<int>(number(action, 0)), static_cast<int>(number(action, 1))});
  } else if (name == "quit") {
    window.request_close();
  } else if (name == "controls") {
    controls_path_ = action.text;
  } else if (name == "display") {
    is_of_display_ = true;
  } else if (name == "close") {
    closed_ = true;
  }
}

void UiScript::next() {
  ++now_;
  begun_ = false;
  click_picture_ = 0;
  keys_.clear();
}

void UiScript::inject_input(double passed_s, bool is_settled, Window& window) {
  ImGuiIO& io = ImGui::GetIO();
  double wheel = 0;
  bool pressed = false;
  if (now_ < actions_.size()) {
    const Action& action = actions_[now_];
    if (action.name == "await") {
      if (std::filesystem::exists(action.text)) next();
      return;
    }
    if (!begun_) begin(action, window);
    double share = time_left_s_ > passed_s ? passed_s / time_left_s_ : 1.0;
    if (click_picture_ > 0) {
      const int pictures = action.name == "drag" ? kDragPictures : kClickPictures;
      pressed = click_picture_ > 2 && click_picture_ < pictures - 2;
      // Stays at the point of the press at first, then moves.
      share = pressed && click_picture_ > 3 ? 0.5 : 0.0;
      if (click_picture_++ < pictures) time_left_s_ = 2 * passed_s;
    }
    x_ += static_cast<float>(share) * (to_x_ - x_);
    y_ += static_cast<float>(share) * (to_y_ - y_);
    wheel = share < 1 ? std::trunc(share * wheel_left_) : wheel_left_;
    wheel_left_ -= wheel;
    time_left_s_ -= passed_s;
    if (!is_of_display_) {
      std::fill(std::begin(io.KeysDown), std::end(io.KeysDown), false);
      for (const int key : keys_) io.KeysDown[key] = true;
      for (const int key : held_keys_) io.KeysDown[key] = true;
      io.KeyShift = io.KeysDown[GLFW_KEY_LEFT_SHIFT];
      io.KeyCtrl = io.KeysDown[GLFW_KEY_LEFT_CONTROL];
    }
    const bool waits = action.name == "settle" && !is_settled;
    const bool drawn_first = kDrawnFirst.count(action.name) != 0;
    const bool over = time_left_s_ <= 0 && !waits && !drawn_first;
    if (over && keys_.empty()) next();
    // Releases the keys for a frame, so that the same key twice is two taps.
    if (over) keys_.clear();
  }
  if (is_of_display_) return;
  io.MousePos = {x_, y_};
  for (std::size_t n = 0; n < 3; ++n) io.MouseDown[n] = buttons_[n];
  io.MouseDown[0] = io.MouseDown[0] || pressed;
  io.MouseWheel = static_cast<float>(wheel);
}

void UiScript::finish() {
  if (controls_path_.empty()) return;
  std::ofstream file(controls_path_, std::ios::app);
  for (const auto& [label, state] : ui::widget_states()) file << "drawn " << label << '\n';
  for (const auto& [label, state] : ui::widget_states())
    if (state.was_used) file << "worked " << label << '\n';
}

void UiScript::read(const WindowContents& contents) {
  ++pictures_since_said_;
  if (now_ >= actions_.size() || !begun_) return;
  const Action action = actions_[now_];
  if (kDrawnFirst.count(action.name) == 0) return;
  next();
  if (action.name == "screenshot") {
    write_png(action.text, contents.window.picture());
  } else if (contents.simulation == nullptr && (contents.playback == nullptr || action.name != "state")) {
    fmt::print("{}\n", action.text);
  } else if (action.name == "state") {
    fmt::print("{}", state_text(action.text, contents));
  } else if (action.name == "colour") {
    fmt::print("{}", colour_text(action.text, contents));
  } else {
    say(action.text, contents);
  }
  std::fflush(stdout);
}

void UiScript::say(const std::string& text, const WindowContents& contents) {
  const LiveMilling& milling = contents.simulation->milling;
  const TimingSummary timing = milling.timing();
  const TickRecord& record = contents.simulation->milling.state().record;
  const double cpu_s = static_cast<double>(std::clock() - said_cpu_) / CLOCKS_PER_SEC;
  fmt::print(
      "{}: {:.1f} pictures/s ({:.0f} ms of all processors each), {} triangles, {:.1f} Hz, {} late, step "
      "p99 {:.0f} us, force {:.2f} N, removed {:.3f} mm³, {} cuts, scan {}\n",
      text, contents.frames_per_s, 1e3 * cpu_s / std::max(pictures_since_said_, 1), contents.triangles,
      timing.ticks_per_s, timing.late_ticks, timing.step.p99_us, record.wrench.force_N.norm(),
      record.removed_mm3, milling.follower().cuts(), contents.simulation->scan.name);
  for (const std::string& complaint : contents.view.dialogues.errors()) {
    fmt::print("dialogue: {}\n", complaint);
  }
  said_cpu_ = std::clock();
  pictures_since_said_ = 0;
}

}  // namespace osteomill::app
