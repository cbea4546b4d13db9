// Measures what osteomill promises of its forces and its milling, and writes the tables of
// docs/verification.md. Exit code 0 where all that must hold does, 3 where something does not.
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

namespace osteomill::verification {
namespace {

constexpr const char* kPreface =
    R"(# Verification
What osteomill promises of forces, torques and milling, and what the paper found, measured and written by `scripts/verify`. Every
table is of the default settings unless it says otherwise.

**How to read it.** A section says first what *must hold*; a row of it *holds* or **misses**. The promises are those of `barrier-shell`,
the product's algorithm, which is also 4 here. The paper's 1 `line-proxy`, 2 `surface-points` and 3 `point-shell` are as published, with
their faults: their rows are *reported* and judge nothing, except that the paper's own findings must come out. Numbers are medians, in brackets the worst, unless the section says otherwise; hands are drawn by
seed, so that all but times comes out the same on any machine.

| question | section |
|---|---|
| Is the force on a wall, the torque at a lever, right? | *Force on a plane* to *Turning scan and poses together* |
| Does it stay still, and give back no more than it got? | *Dropped on bone* to *How stiff before it is no longer passive* |
| Does a tool get through bone? | *Pushes from anywhere* to *Breaking through into a hollow* |
| Is the hole what the burr swept? | *The hole and the voxels*, *What is cut and what the burr sweeps* |
| Does it keep 1000 Hz, also in fine scans? | *Voxels of 0.031 mm*, *What a tick takes, whatever the burr and the voxels*, *The haptic rate halved and doubled* |
| How calm is it while a hand mills? | *Milling the tooth* and the sections after it |
| Does what the paper found come out? | *What the paper found*, *What the paper leaves open* |

A row that misses is a known fault and stands here until it is mended; how each algorithm works is in [algorithms.md](algorithms.md).

)";

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

struct Named {
  std::string name;
  std::function<Section(const Bones&, const Effort&)> measure;
};

const std::vector<Named>& all_sections() {
  static const std::vector<Named> sections{
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
      {"rates", haptic_rates},
      {"tooth", milling_the_tooth},
      {"reaction", milling_with_cutting_reaction},
      {"second", milling_the_second_scan},
      {"paper", papers_findings},
      {"choices", papers_choices},
      {"energy", energy_of_barrier_shell},
      {"rig", the_rig_itself},
      {"soak", soak},
  };
  return sections;
}

void add_options(CLI::App& program, Options& options) {
  std::vector<std::string> names;
  for (const Named& section : all_sections()) names.push_back(section.name);
  program.add_option("--tooth", options.tooth, "Scan of a tooth (the built-in one)");
  program.add_option("--tooth-iso", options.tooth_iso, "Its isovalue")->capture_default_str();
  program.add_option("--second", options.second, "A second scan, on which nothing was chosen");
  program.add_option("--second-iso", options.second_iso, "Its isovalue")->capture_default_str();
  program.add_option("--spongy", options.spongy, "Micro-CT of spongy bone");
  program.add_option("--spongy-iso", options.spongy_iso, "Its isovalue")->capture_default_str();
  program.add_option("--out", options.out, "Markdown file (standard output)");
  program.add_option("--only", options.only, "Sections")->check(CLI::IsMember(names));
  program.add_option("--pushes", options.effort.pushes, "Random pushes an algorithm")->capture_default_str();
  program.add_option("--seeds", options.effort.seeds, "Seeds a row")->capture_default_str();
  program.add_option("--soak", options.effort.soak_min, "min, the long session")->capture_default_str();
  program.add_option("--seconds", options.effort.phase_s, "s, a milling phase")->capture_default_str();
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

bool wanted(const Options& options, const Named& section) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), section.name) != options.only.end();
}

// Measures what is wanted; false where something that must hold does not.
bool measure(const Options& options, std::string& text) {
  const Bones bones = load_bones(options);
  bool all_hold = true;
  for (const Named& named : all_sections()) {
    if (!wanted(options, named) || (named.name == "second" && !bones.second) ||
        (named.name == "spongy" && !bones.spongy)) {
      continue;
    }
    const auto begin = std::chrono::steady_clock::now();
    const Section section = named.measure(bones, options.effort);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    std::cerr << fmt::format("{}: {} of {} rows miss, {:.0f} s\n", named.name, section.misses.size(),
                             section.rows.size(), took.count());
    all_hold = all_hold && section.misses.empty();
    text += to_markdown(section);
  }
  return all_hold;
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
  std::string text = kPreface;
  const bool all_hold = measure(options, text);
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
