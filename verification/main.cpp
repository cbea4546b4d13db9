// Measures what osteomill promises of its forces and its milling, and writes the tables of
// docs/verification.md. Exit code 0 if all judged rows hold, 3 if any misses, 1 after an error, 2 for
// faulty options.
#include <chrono>
#include <ctime>
#include <exception>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"
#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/builtin_tooth.h"

#include "verification/sections.h"
#include "verification/summary.h"

namespace osteomill::verification {
namespace {

struct Options {
  std::string tooth;
  double tooth_iso = 755;
  std::string second;
  double second_iso = 300;
  std::string spongy;
  double spongy_iso = 100;
  std::string out;
  std::vector<std::string> only;
  Effort effort;
};

struct NamedSection {
  std::string name;
  std::function<Section(const Bones&, const Effort&)> measure;
};

const std::vector<NamedSection>& all_sections() {
  static const std::vector<NamedSection> sections{
      {"planes", [](const Bones&, const Effort&) { return force_on_planes(); }},
      {"levers", [](const Bones&, const Effort&) { return shaft_levers(); }},
      {"ball", [](const Bones&, const Effort&) { return slide_round_a_ball(); }},
      {"turned", [](const Bones&, const Effort&) { return turned_scans(); }},
      {"drops", [](const Bones&, const Effort&) { return drops(); }},
      {"returned", [](const Bones&, const Effort&) { return energy_given_back(); }},
      {"passivity", [](const Bones&, const Effort&) { return passivity(); }},
      {"pushes", random_pushes},
      {"tools", tools_and_pushes},
      {"sheets", [](const Bones&, const Effort&) { return thin_bone(); }},
      {"spongy", [](const Bones& bones, const Effort&) { return spongy_bone(bones); }},
      {"through", [](const Bones&, const Effort& effort) { return breaking_through(effort); }},
      {"voxels", [](const Bones&, const Effort& effort) { return voxel_sizes(effort); }},
      {"swept", [](const Bones&, const Effort& effort) { return swept_holes(effort); }},
      {"fine", [](const Bones&, const Effort& effort) { return fine_scans(effort); }},
      {"ticks", [](const Bones&, const Effort& effort) { return time_of_a_tick(effort); }},
      {"feed", [](const Bones&, const Effort&) { return force_against_feed(); }},
      {"rates", haptic_rates},
      {"tooth", milling_the_tooth},
      {"reaction", milling_with_cutting_reaction},
      {"rhythm", half_rate_oscillation},
      {"second", milling_the_second_scan},
      {"paper", papers_findings},
      {"choices", papers_choices},
      {"energy", energy_of_barrier_shell},
      {"rig", rig_noise},
      {"soak", soak},
  };
  return sections;
}

void add_options(CLI::App& program, Options& options) {
  std::vector<std::string> names;
  for (const NamedSection& section : all_sections()) names.push_back(section.name);
  program.add_option("--tooth", options.tooth, "Scan of a tooth (default: the built-in tooth)");
  program.add_option("--tooth-iso", options.tooth_iso, "Isovalue of the tooth's scan")->capture_default_str();
  program.add_option("--second", options.second, "Scan of a second bone, on which no setting was chosen");
  program.add_option("--second-iso", options.second_iso, "Isovalue of the second bone's scan")
      ->capture_default_str();
  program.add_option("--spongy", options.spongy, "Micro-CT scan of spongy bone");
  program.add_option("--spongy-iso", options.spongy_iso, "Isovalue of the spongy bone's scan")
      ->capture_default_str();
  program.add_option("--out", options.out, "Markdown file to write (default: standard output)");
  program.add_option("--only", options.only, "Sections to measure (default: all)")
      ->check(CLI::IsMember(names));
  program.add_option("--pushes", options.effort.pushes, "Random pushes for each algorithm")
      ->capture_default_str();
  program.add_option("--seeds", options.effort.seeds, "Seeds for each row")->capture_default_str();
  program.add_option("--soak", options.effort.soak_min, "Length of the long session, min")
      ->capture_default_str();
  program.add_option("--seconds", options.effort.phase_s, "Length of a milling phase, s")
      ->capture_default_str();
}

Bones load_bones(const Options& options) {
  Bones bones =
      options.tooth.empty()
          ? Bones{Volume(builtin_tooth(), kBuiltinToothIsovalue), "the built-in tooth", {}, {}, {}, {}}
          : Bones{Volume(read_scan(options.tooth).grid, options.tooth_iso), "a real tooth", {}, {}, {}, {}};
  if (!options.second.empty()) {
    bones.second.emplace(read_scan(options.second).grid, options.second_iso);
    bones.second_name = "a cranium";
  }
  if (!options.spongy.empty()) {
    bones.spongy.emplace(read_scan(options.spongy).grid, options.spongy_iso);
    bones.spongy_name = "spongy bone";
  }
  return bones;
}

bool is_selected(const Options& options, const NamedSection& section) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), section.name) != options.only.end();
}

// Measures the selected sections, except those whose scan is missing.
MeasuredSections measure(const Options& options) {
  const Bones bones = load_bones(options);
  MeasuredSections measured;
  for (const NamedSection& named : all_sections()) {
    if (!is_selected(options, named) || (named.name == "second" && !bones.second) ||
        (named.name == "spongy" && !bones.spongy)) {
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    measured.emplace_back(named.name, named.measure(bones, options.effort));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    const Section& section = measured.back().second;
    std::cerr << fmt::format("{}: {} of {} rows miss, {:.0f} s\n", named.name, section.misses.size(),
                             section.rows.size(), took.count());
  }
  return measured;
}

int run(int argc, char** argv) {
  CLI::App program("Measures what osteomill promises of its forces and its milling");
  Options options;
  add_options(program, options);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : 2;
  }
  const MeasuredSections measured = measure(options);
  std::string text = summary(measured);
  bool all_hold = true;
  for (const auto& [name, section] : measured) {
    text += to_markdown(section);
    all_hold = all_hold && section.misses.empty();
  }
  if (options.out.empty()) {
    std::cout << text;
  } else {
    write_text_atomically(options.out, [&](std::ostream& out) { out << text; });
  }
  return all_hold ? 0 : 3;
}

}  // namespace
}  // namespace osteomill::verification

int main(int argc, char** argv) {
  try {
    return osteomill::verification::run(argc, argv);
  } catch (const osteomill::InputError& error) {
    std::cerr << "verification: " << error.what() << "\n";
    return 1;
  } catch (const std::exception& error) {
    std::cerr << "verification: " << error.what() << "\n";
    return 1;
  }
}
