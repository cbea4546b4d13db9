#include "osteomill/experiment/study_section.h"

#include <algorithm>

#include <fmt/format.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/signed_rank.h"
#include "osteomill/experiment/study_comparison.h"
#include "osteomill/report/html.h"

namespace osteomill {

namespace {

std::string interval_text(const MedianInterval& interval) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}]", interval.median, interval.low, interval.high);
}

// "2 > 1, p = 0.012" in bold where significant, else "1, 2: p = 0.3" in grey.
std::string pair_text(const AlgorithmPair& pair) {
  const AlgorithmId& lesser = pair.greater == pair.first ? pair.second : pair.first;
  if (pair.p <= kSignificance) {
    return fmt::format("<b>{} &gt; {}</b>, {}", short_label(pair.greater), short_label(lesser),
                       html_escaped(p_text(pair.p)));
  }
  return fmt::format("<span class=\"none\">{}, {}: {}</span>", short_label(pair.first),
                     short_label(pair.second), p_text(pair.p));
}

// "0.02 [0.01, 0.03]", with the hands where it could not be measured in all; else why not in any.
std::string values_text(const Study& study, const Study::Tried& tried, std::string_view phase,
                        const Metric& metric) {
  if (!study.was_tried(tried)) return "–";
  const std::vector<double> values = study.values(tried, phase, metric);
  if (values.empty()) return contact_words(study.contact(tried, phase));
  const std::string text = interval_text(median_interval(values));
  return values.size() == study.seeds().size()
             ? text
             : fmt::format("{} in {} of {} hands", text, values.size(), study.seeds().size());
}

std::string algorithms_table(const Study& study, Mode mode, std::string_view phase) {
  HtmlTable table{{"Median over the hands [interval]"}, {}, true};
  for (const AlgorithmId& algorithm : study.algorithms()) table.header.emplace_back(algorithm.label);
  if (study.algorithms().size() > 1) table.header.emplace_back("Differences");
  for (const Metric& metric : study.metrics_of(phase)) {
    table.rows.push_back({html_escaped(with_unit(metric.name, metric))});
    for (const AlgorithmId& algorithm : study.algorithms()) {
      table.rows.back().push_back(values_text(study, {algorithm, mode}, phase, metric));
    }
    std::string pairs;
    for (const AlgorithmPair& pair : compare_algorithms(study, mode, phase, metric)) {
      pairs += (pairs.empty() ? "" : "<br>") + pair_text(pair);
    }
    if (study.algorithms().size() > 1) table.rows.back().push_back(pairs);
  }
  return html_table(table);
}

std::string change_text(const ModeChange& change) {
  const std::string p = html_escaped(p_text(change.p));
  return fmt::format(
      "{:.3g} → {:.3g}<br>× {}<br>{}", change.paper.median, change.steady.median,
      change.ratios > 0 ? interval_text(change.ratio) : "–",
      change.p <= kSignificance ? "<b>" + p + "</b>" : "<span class=\"none\">" + p + "</span>");
}

std::string changes_table(const Study& study, std::string_view phase) {
  HtmlTable table{{"steady / paper, median over the hands [interval]"}, {}, true};
  for (const AlgorithmId& algorithm : study.algorithms()) table.header.emplace_back(algorithm.label);
  for (const Metric& metric : study.metrics_of(phase)) {
    table.rows.push_back({html_escaped(with_unit(metric.name, metric))});
    const std::vector<ModeChange> changes = compare_modes(study, phase, metric);
    for (const AlgorithmId& algorithm : study.algorithms()) {
      const auto change = std::find_if(changes.begin(), changes.end(),
                                       [&](const ModeChange& of) { return of.algorithm == algorithm; });
      table.rows.back().push_back(change == changes.end() ? "–" : change_text(*change));
    }
  }
  return html_table(table);
}

// What the numbers are, and how far they can be trusted.
std::string how_to_read(const Study& study) {
  const std::size_t n = study.seeds().size();
  std::vector<double> stiffness, damping;
  for (const StudyRow& row : study.rows()) {
    stiffness.push_back(1e3 * row.hand.stiffness_N_per_mm);
    damping.push_back(1e3 * row.hand.damping_Ns_per_mm);
  }
  const auto [softest, stiffest] = std::minmax_element(stiffness.begin(), stiffness.end());
  const auto [min, max] = std::minmax_element(damping.begin(), damping.end());
  const MedianInterval interval = median_interval(std::vector<double>(n, 0.0));
  const std::size_t pairs = study.algorithms().size() * (study.algorithms().size() - 1) / 2;
  const double min_corrected = std::min(1.0, static_cast<double>(std::max<std::size_t>(pairs, 1)) * min_p(n));
  std::string html = html_paragraph(fmt::format(
      "The same trial in {} hands: each seed (the first is {}) has a tremor and a hand of its own, drawn "
      "evenly from the published ranges; here {:.0f} to {:.0f} N/m and {:.2g} to {:.2g} N s/m. study.csv has "
      "every trial. Recordings are kept of seed {} alone, which is the one that the figures of force, "
      "torque, "
      "shaft and path show; of the others only these figures of merit.",
      n, study.seeds().front(), *softest, *stiffest, *min, *max, study.seeds().front()));
  html += html_paragraph(
      interval.is_range
          ? fmt::format(
                "In brackets stands the range of all values: {} hands are too few for a 95 % interval "
                "of the median, which takes 6 (the range covers it with {:.3g} %).",
                n, 100 * interval.coverage)
          : fmt::format(
                "In brackets stands a confidence interval of the median between two order statistics, "
                "by the binomial distribution; it covers the median with {:.3g} %.",
                100 * interval.coverage));
  html += html_paragraph(fmt::format(
      "Differences are tested hand by hand with Wilcoxon's signed-rank test, exact and two-sided, corrected "
      "after Holm over what is compared in one row (not over the rows); bold ones are significant (p at most "
      "{}). The least p "
      "that {} hands can give is {:.2g}, after the correction {:.2g}{}.",
      kSignificance, n, min_p(n), min_corrected,
      min_corrected > kSignificance ? ", so that no difference can be significant here" : ""));
  return html + html_paragraph(
                    "Step times are the machine's: those of the first seed were taken with nothing else of "
                    "this program running, the others with a trial beside on each further core, so compare "
                    "them with care. Everything else comes out the same on any machine.");
}

std::string phase_title(std::string_view phase) {
  return phase == kMilling ? "Milling" : "Holding still, not milling";
}

}  // namespace

std::string study_section(const Study& study, const std::vector<CaptionedFigure>& figures) {
  std::string html = fmt::format("<h2>Study over {} hands</h2>\n", study.seeds().size()) + how_to_read(study);
  for (const CaptionedFigure& figure : figures) html += html_figure(figure.files.svg, figure.caption);
  for (const Mode mode : study.modes()) {
    for (const std::string_view phase : study.phases()) {
      html += fmt::format("<h3>{}, mode {}</h3>\n", phase_title(phase), name_of(mode));
      html += algorithms_table(study, mode, phase);
    }
  }
  if (study.modes().size() < 2) return html;
  for (const std::string_view phase : study.phases()) {
    html += fmt::format("<h3>What steady changes: {}</h3>\n", phase_title(phase));
    html += changes_table(study, phase);
  }
  return html;
}

}  // namespace osteomill
