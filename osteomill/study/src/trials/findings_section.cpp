#include "trials/findings_section.h"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "osteomill/study/study_findings.h"

#include "trials/statistics.h"

namespace osteomill {

namespace {

// A single hand settles nothing, so its cell only states whether the rule holds in it.
Cell verdict_cell(const StudyFinding& finding, bool one_hand) {
  const Verdict verdict = one_hand ? finding.of_medians.verdict : finding.verdict;
  if (one_hand && verdict == Verdict::agrees) return {"holds in this hand", CellStyle::faint};
  if (one_hand && verdict == Verdict::does_not_agree) return {"does not hold in this hand", CellStyle::faint};
  return {std::string(name_of(verdict)), verdict == Verdict::agrees           ? CellStyle::agrees
                                         : verdict == Verdict::does_not_agree ? CellStyle::differs
                                                                              : CellStyle::faint};
}

// Returns the findings whose runs are present.
std::vector<StudyFinding> recorded_findings(const Study& study) {
  std::vector<StudyFinding> findings = check_study_findings(study);
  std::erase_if(findings, [](const StudyFinding& finding) {
    return finding.of_medians.verdict == Verdict::not_recorded;
  });
  return findings;
}

// Returns the number of hands in which the rule holds and in which it was tested: "6 of 8".
std::string hands_of(const StudyFinding& finding) {
  if (finding.tested == 0) return "not tested";
  return fmt::format("{} of {}", finding.agreeing, finding.tested);
}

Table findings_table(const Study& study, const std::vector<StudyFinding>& findings) {
  const bool one = study.seeds().size() == 1;
  Table table{{"The paper found", one ? "Measured here" : "Medians over the hands",
               one ? "In one hand, which settles nothing" : "Verdict", "Rule"},
              {}};
  if (!one) table.header.insert(table.header.end() - 1, {"In how many hands", "Sign test"});
  for (const StudyFinding& f : findings) {
    std::vector<Cell> row{f.of_medians.paper_says, f.of_medians.measured, verdict_cell(f, one)};
    if (!one) row.insert(row.end(), {hands_of(f), f.tested == 0 ? "–" : p_text(f.p)});
    row.emplace_back((one ? "holds if " : "agrees if ") + f.of_medians.rule);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

Table verdicts_table(const Study& study) {
  const bool one = study.seeds().size() == 1;
  struct Findings {
    Cell verdict;
    std::vector<std::string> which;
  };
  std::map<Verdict, Findings> findings;
  const std::vector<StudyFinding> recorded = recorded_findings(study);
  for (const StudyFinding& f : recorded) {
    Findings& alike = findings[one ? f.of_medians.verdict : f.verdict];
    alike.verdict = verdict_cell(f, one);
    alike.which.push_back(f.of_medians.paper_says);
    if (!one && is_tested(f.verdict)) alike.which.back() += fmt::format(", in {} hands", hands_of(f));
  }
  const std::string of_all = recorded.size() == kFindings
                                 ? "The paper's nine findings"
                                 : fmt::format("{} of the paper's nine findings", recorded.size());
  Table table{{of_all, "How many", "Which"}, {}};
  for (const auto& [verdict, alike] : findings)
    table.rows.push_back({alike.verdict, fmt::format("{}", alike.which.size()),
                          fmt::format("{}", fmt::join(alike.which, ";\n"))});
  return table;
}

Section findings_section(const Study& study) {
  const std::vector<StudyFinding> findings = recorded_findings(study);
  if (findings.empty()) return {};
  Section section{
      .title = "The paper's findings",
      .paragraphs = {"The findings of section 8.2 of the paper (M. G. Eriksson, Three 6-DOF "
                     "Haptic Algorithms Compared for Use in a Milling Surgery Simulator "
                     "Prototype, TRITA-MMK 2012:05, KTH, Stockholm, 2012), each tested on the "
                     "measurements by a rule of this project. The paper does not give its hand, push "
                     "and bone, so a finding that does not hold here may hold there."}};
  if (const std::size_t missing = check_study_findings(study).size() - findings.size(); missing > 0) {
    section.paragraphs.push_back(
        fmt::format("{} further finding{} to algorithms, phases or grips that were not tried here.", missing,
                    missing == 1 ? " belongs" : "s belong"));
  }
  if (study.seeds().size() > 1) {
    section.paragraphs.push_back(
        "The hands agree with the paper, or do not, if more than half do and the sign test is significant at "
        "5 %, which takes five hands; otherwise it is not settled. p is the probability that as many or more "
        "would agree by tossing a coin.");
  }
  section.tables = {findings_table(study, findings)};
  return section;
}

}  // namespace osteomill
