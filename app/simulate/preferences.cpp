#include "app/simulate/preferences.h"

#include <exception>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"

#include "app/option_checks.h"
#include "app/progress.h"
#include "app/simulate/screen_scale.h"
#include "app/toml_file.h"

namespace osteomill::app {

namespace fs = std::filesystem;

namespace {

using P = Preferences;

fs::path file_of_preferences() {
  const fs::path folder = state_folder();
  return folder.empty() ? fs::path() : folder / "window.toml";
}

// The handpiece comes before the speed, because setting it changes the speed.
const std::vector<Field<MillingSetup>>& tool_fields_kept() {
  static const std::vector<Field<MillingSetup>> kept = [] {
    std::vector<Field<MillingSetup>> fields;
    for (const char* option :
         {"burr-radius", "shaft-radius", "shaft-length", "burr", "handpiece", "spindle-speed"})
      fields.push_back(*field_of_option(fields_of<MillingSetup>(), option));
    return fields;
  }();
  return kept;
}

template <typename Access>
Field<P> number(const char* key, const char* unit, const NumberRange& range, const char* doc, Access access) {
  return field<P>({.unit = unit, .range = range, .doc = doc, .option = key}, access);
}

template <typename Access>
Field<P> on_or_off(const char* key, const char* doc, Access access) {
  return number(key, "", NumberRange::on_or_off(), doc, access);
}

Field<P> group(const char* key, const char* doc, bool P::Open::*member) {
  return on_or_off(
      key, doc, [member](auto& p) -> auto& { return p.open.*member; });
}

// All numbers, switches and choices, in the order of the file.
const std::vector<Field<P>>& kept_numbers() {
  using O = P::Open;
  constexpr NumberRange kPlace = {-100000, 100000, true}, kSize = NumberRange::count(0, 100000);
  static const std::vector<Field<P>> all = joined<P>(
      {{number(
            "window-left", "px", kPlace, "Left edge of the window on the screens",
            [](auto& p) -> auto& { return p.place.left; }),
        number(
            "window-top", "px", kPlace, "Upper edge of the window on the screens",
            [](auto& p) -> auto& { return p.place.top; }),
        number(
            "window-width", "px", kSize, "Width of the window; 0: default",
            [](auto& p) -> auto& { return p.place.width; }),
        number(
            "window-height", "px", kSize, "Height of the window; 0: default",
            [](auto& p) -> auto& { return p.place.height; }),
        number("text-scale", "", {0, kMaxScale}, "Scale of the text; 0: follows the screen", &P::text_scale),
        field<P>({.range = NumberRange::count(0, 1),
                  .doc = "Colours of the panels",
                  .option = "theme",
                  .choices = {"dark", "light"}},
                 &P::theme),
        on_or_off("ghost", "Show where the hand is", &P::ghost),
        on_or_off("arrows", "Show force and torque as arrows", &P::arrows),
        on_or_off("see-through", "Show the burr through bone in front of it", &P::see_through),
        on_or_off("label-colours", "Colour the bone by its labels", &P::labels),
        on_or_off("help-seen", "The help page was shown", &P::help_seen),
        on_or_off("sound", "Play the sound of the spindle", &P::sound),
        on_or_off("follow-burr", "Keep the burr in the middle of the view", &P::follow_burr),
        on_or_off("loupe", "Show the surroundings of the burr magnified", &P::loupe),
        number("loupe-power", "", {2, 4}, "Magnification of the loupe", &P::loupe_power),
        group("show-controls", "Show the column of controls", &O::controls),
        group("show-readings", "Show the readings", &O::readings),
        group("open-milling", "Open the group Milling", &O::milling),
        group("open-view", "Open the group View", &O::view),
        group("open-record-and-save", "Open the group Record and save", &O::files),
        group("open-look-closer", "Open the group Look closer", &O::closer),
        group("open-bone", "Open the group Bone", &O::bone),
        group("open-cuts", "Open the group Cuts", &O::cuts),
        group("laboratory", "Show the laboratory's controls and readings", &O::laboratory),
        group("open-algorithm", "Open the laboratory's group Algorithm", &O::algorithm),
        group("open-tool", "Open the laboratory's group Tool", &O::tool),
        group("open-burr-and-drive", "Open the laboratory's group Burr and drive", &O::drive),
        group("open-all-measures", "Show all measures in results", &O::measures)},
       fields_within<P>(&P::tool, tool_fields_kept())});
  return all;
}

const std::vector<Field<P, std::string>>& kept_texts() {
  static const std::vector<Field<P, std::string>> all = {field<P>(
      {.doc = "Folder from which a scan was last opened", .option = "last-folder"}, &P::last_folder)};
  return all;
}

}  // namespace

bool copy_tool(const MillingSetup& from, MillingSetup& to) {
  bool has_changed = false;
  for (const Field<MillingSetup>& field : tool_fields_kept()) {
    has_changed = has_changed || field.get(to) != field.get(from);
    field.set(to, field.get(from));
  }
  return has_changed;
}

namespace {

// Throws InputError, naming file and line. Ignores unknown keys, e.g. of another version.
Preferences preferences_in(const std::string& file) {
  Preferences preferences;
  const toml::table table = parse_toml(file);
  for (const Field<P>& field : kept_numbers()) {
    const toml::node* const value = table.get(field.option);
    if (value == nullptr) continue;
    try {
      field.set(preferences, value_of(field, option_values(*value, file, field.option).front()));
    } catch (const std::invalid_argument& fault) {
      throw error_at(*value, file, fault.what());
    }
  }
  for (const Field<P, std::string>& field : kept_texts())
    if (const toml::node* const value = table.get(field.option))
      field.set(preferences, option_values(*value, file, field.option).front());
  return preferences;
}

}  // namespace

Preferences read_preferences() {
  const fs::path file = file_of_preferences();
  std::error_code unreadable;
  if (file.empty() || !fs::exists(file, unreadable)) return {};
  try {
    return preferences_in(file.string());
  } catch (const InputError& error) {
    print_error(fmt::format("osteomill: {}; using default window settings\n", error.what()));
    return {};
  }
}

std::string preferences_text(const Preferences& preferences) {
  std::ostringstream text;
  text << "# Window settings of osteomill simulate. Delete this file to restore the defaults.\n";
  for (const Field<P>& field : kept_numbers()) {
    const double value = field.get(preferences);
    const bool is_switch = field.choices.empty() && field.range == NumberRange::on_or_off();
    const std::string shown = is_switch               ? (value != 0 ? "true" : "false")
                              : field.choices.empty() ? fmt::format("{}", value)
                                                      : '"' + value_text(field, value) + '"';
    text << fmt::format("{} = {}  # {}{}{}\n", field.option, shown, field.doc, field.unit.empty() ? "" : ", ",
                        field.unit);
  }
  for (const Field<P, std::string>& field : kept_texts()) {
    std::ostringstream line;
    line << field.option << " = " << toml::value<std::string>(field.get(preferences)) << "  # " << field.doc
         << '\n';
    // A folder name that is not valid UTF-8 cannot be stored in TOML.
    try {
      (void)toml::parse(line.str());
      text << line.str();
    } catch (const toml::parse_error&) {
      continue;
    }
  }
  return text.str();
}

void write_preferences(const std::string& text) {
  const fs::path file = file_of_preferences();
  if (file.empty()) return;
  try {
    create_folder(file.parent_path());
    write_text_atomically(file, [&](std::ostream& out) { out << text; });
  } catch (const InputError&) {
    // The preferences are lost; the next start begins like this one.
  }
}

void PreferencesKeeper::keep(const Preferences& preferences) {
  constexpr std::chrono::seconds kBetween{2};
  const auto now = std::chrono::steady_clock::now();
  if (now < next_ ||
      (writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) != std::future_status::ready))
    return;
  next_ = now + kBetween;
  std::string text = preferences_text(preferences);
  if (text == kept_) return;
  kept_ = text;
  writing_ = std::async(std::launch::async, write_preferences, std::move(text));
}

void PreferencesKeeper::keep_now(const Preferences& preferences) {
  if (writing_.valid()) writing_.wait();
  if (const std::string text = preferences_text(preferences); text != kept_) write_preferences(kept_ = text);
}

}  // namespace osteomill::app
