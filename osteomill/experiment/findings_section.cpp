#include "osteomill/experiment/findings_section.h"

#include <fmt/format.h>

#include "osteomill/experiment/statistics.h"
#include "osteomill/experiment/study_findings.h"

namespace osteomill {

namespace {

const char* css_of(Verdict verdict) {
  return verdict == Verdict::agrees ? "agrees" : verdict == Verdict::does_not_agree ? "differs" : "none";
}

HtmlTable findings_table(const Study& study, Mode mode) {
  const bool one = study.seeds().size() == 1;
  HtmlTable table{{"The paper found", one ? "Measured here" : "Medians over the hands",
                   one ? "In this hand" : "Verdict", "Rule"},
                  {}};
  if (!one) table.header.insert(table.header.end() - 1, {"In how many hands", "Sign test"});
  for (const StudyFinding& f : check_study_findings(study, mode)) {
    const Verdict verdict = f.verdict;
    std::vector<std::string> row{
        html_escaped(f.of_medians.paper_says), html_escaped(f.of_medians.measured),
        fmt::format("<span class=\"{}\">{}</span>", css_of(verdict), name_of(verdict))};
    if (!one) {
      row.push_back(fmt::format("{} of {}", f.agreeing, f.tested));
      row.push_back(html_escaped(p_text(f.p)));
    }
    row.push_back("agrees where " + html_escaped(f.of_medians.rule));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

PageSection findings_section(const Study& study) {
  PageSection section{
      .title = "The paper's findings",
      .paragraphs = {
          "What section 8.2 of the paper says it found, each held against what was measured by a rule of "
          "this "
          "project. Mode paper has the algorithms as the paper has them; steady has this project's named "
          "improvements, so what the paper found wrong with one of them need not be wrong there."}};
  if (study.seeds().size() > 1) {
    section.paragraphs.push_back(
        "Several hands agree with the paper, or do not, where all of them do, or so many more than half that "
        "tossing a coin would give as many in one of twenty tries at most; else it is not settled. p is the "
        "chance that as many or more would agree by the toss.");
  }
  for (const Mode mode : study.modes()) {
    section.parts.push_back(
        {.title = fmt::format("Mode {}", name_of(mode)), .tables = {findings_table(study, mode)}});
  }
  return section;
}

}  // namespace osteomill
