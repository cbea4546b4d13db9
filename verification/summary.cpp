#include "verification/summary.h"

#include <algorithm>
#include <cctype>
#include <span>

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace osteomill::verification {

namespace {

constexpr const char* kHowToRead =
    R"(# Verification
`scripts/verify` measures everything that osteomill promises of forces, torques and milling, and the paper's findings, and
writes this page. Tables use the default settings unless they say otherwise.

## Summary
Each section begins with what *must hold*, and each of its rows *holds* or **misses**. The promises are those of
`barrier-shell`, the default algorithm, also called 4 here. The paper's 1 `line-proxy`, 2 `surface-points` and 3 `point-shell`
are as published, faults included: their rows are *reported* and not judged, except that they must reproduce the paper's
findings.

)";

constexpr const char* kMore =
    R"(A row that misses is a known fault and stays here until it is corrected. Numbers are medians, with the worst in
brackets, unless the section says otherwise. Hands are drawn by seed, so everything except times repeats to the bit
([determinism.md](determinism.md) gives the machines). A *drawn hand* has a stiffness and a damping drawn by its seed from
published ranges; otherwise the seed changes only the tremor.
[algorithms.md](algorithms.md) describes each algorithm.

)";

struct Question {
  const char* text;
  std::vector<std::string> sections;
};

const std::vector<Question>& questions() {
  static const std::vector<Question> all{
      {"Are force and torque on simple shapes right?", {"planes", "levers", "ball", "turned"}},
      {"Is it stable, and does it return no more energy than it received?",
       {"drops", "returned", "passivity"}},
      {"Does the tool stay out of bone?", {"pushes", "tools", "sheets", "spongy", "through"}},
      {"Is the hole the volume that the burr swept?", {"voxels", "swept"}},
      {"Does it keep 1000 Hz, also in fine scans?", {"fine", "ticks", "rates"}},
      {"Is it calm while a hand mills?", {"tooth", "reaction", "rhythm", "second", "energy", "rig"}},
      {"Are the paper's findings reproduced?", {"paper", "choices"}},
      {"Do cutting forces agree with published ones?", {"feed"}},
      {"Does a long session stay stable?", {"soak"}},
  };
  return all;
}

// Returns a link to a heading of the page, with GitHub's anchor.
std::string link_to(const std::string& title) {
  std::string anchor;
  for (const char c : title) {
    if (c == ' ') {
      anchor += '-';
    } else if (std::isalnum(static_cast<unsigned char>(c)) || c == '-') {
      anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return fmt::format("[{}](#{})", title, anchor);
}

// Counts the rows whose last cell is `verdict`.
std::size_t rows_with(const Section& section, const std::string& verdict) {
  return static_cast<std::size_t>(std::ranges::count_if(
      section.rows, [&](const auto& row) { return !row.empty() && row.back() == verdict; }));
}

// Returns the question's row of the table, or an empty text if none of its sections was measured.
std::string row_of(const Question& question, const MeasuredSections& measured) {
  std::vector<std::string> links;
  std::string reservations;
  std::size_t holds = 0;
  std::size_t judged = 0;
  for (const auto& [name, section] : measured) {
    if (std::ranges::find(question.sections, name) == question.sections.end()) continue;
    links.push_back(link_to(section.title));
    if (!section.reservation.empty())
      reservations += (reservations.empty() ? " " : "; ") + section.reservation;
    holds += rows_with(section, "holds");
    judged += rows_with(section, "holds") + section.misses.size();
  }
  if (links.empty()) return "";
  return fmt::format("| {} | {} of {}{} | {} |\n", question.text, holds, judged, reservations,
                     fmt::join(links, ", "));
}

// Returns a list of the rows that miss, by section.
std::string misses(const MeasuredSections& measured) {
  std::string text;
  for (const auto& [name, section] : measured) {
    if (section.misses.empty()) continue;
    text += fmt::format("- {}: {}\n", link_to(section.title), fmt::join(section.misses, "; "));
  }
  return text.empty() ? "No row misses.\n\n" : "Rows that miss:\n\n" + text + "\n";
}

}  // namespace

std::string summary(const MeasuredSections& measured) {
  std::string text = kHowToRead;
  text += "| question | rows that hold | sections |\n|---|---|---|\n";
  for (const Question& question : questions()) text += row_of(question, measured);
  return text + "\n" + misses(measured) + kMore;
}

}  // namespace osteomill::verification
