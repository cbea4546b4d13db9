#include "osteomill/experiment/write_rates_report.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string_view>

#include <fmt/format.h>

#include "osteomill/experiment/rates_figure.h"
#include "osteomill/files/atomic_file.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/positive.h"
#include "osteomill/report/html.h"
#include "osteomill/report/metrics.h"
#include "osteomill/report/report_page.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

void require_usable(const std::vector<RateRow>& rows) {
  if (rows.empty()) throw InputError("rates", "there are no rates to report on");
  for (const RateRow& row : rows) {
    if (!is_positive(row.rate_hz) || !is_positive(row.steps_per_s)) {
      throw InputError("rates", fmt::format("the rate of {} at {} is not a positive number",
                                            name_of(row.algorithm), row.resolution));
    }
  }
}

// A resolution is free text and may hold what separates columns.
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

void write_rates_csv(const fs::path& path, const std::vector<RateRow>& rows) {
  write_text_atomically(path, [&](std::ostream& out) {
    out << "algorithm,resolution,points,step_us_median,step_us_p99,rate_hz,steps_per_s,paper_rate_hz\n";
    for (const RateRow& r : rows) {
      out << fmt::format("{},{},{},{},{},{},{},{}\n", name_of(r.algorithm), csv_field(r.resolution), r.points,
                         r.step_us_median, r.step_us_p99, r.rate_hz, r.steps_per_s,
                         r.paper_rate_hz > 0 ? fmt::format("{}", r.paper_rate_hz) : "");
    }
  });
}

std::string ratio_text(double ratio) {
  return fmt::format("{:.{}f}", ratio, ratio < 9.95 ? 1 : 0);
}

// The machines are told apart by the steps a second; the paper's are of a loop that waits for its
// millisecond.
std::string plain_words(const std::vector<RateRow>& rows) {
  std::vector<double> ratios;
  std::size_t fast_enough = 0;
  for (const RateRow& row : rows) {
    if (row.paper_rate_hz > 0) ratios.push_back(row.steps_per_s / row.paper_rate_hz);
    if (row.rate_hz >= kMinRate_hz) ++fast_enough;
  }
  std::string text =
      fmt::format("{} of the {} resolutions hold {:.0f} Hz or more in a loop of 1000 Hz here. ", fast_enough,
                  rows.size(), kMinRate_hz);
  if (ratios.empty()) return text + "The paper has no rates at these resolutions.";
  double log_sum = 0;
  for (const double ratio : ratios) log_sum += std::log(ratio);
  const auto [min, max] = std::minmax_element(ratios.begin(), ratios.end());
  return text +
         fmt::format(
             "Where the paper has a rate, this machine makes {} to {} times as many steps a second as the "
             "paper's Pentium 4 of 3.3 GHz, {} times in the geometric mean. The paper's rates are those of a "
             "loop that waits for its next millisecond and does more than the step, so they end at 1000 Hz; "
             "those "
             "compared with them here are of the step alone and have no such end. The ratio therefore tells "
             "how far "
             "apart "
             "the "
             "machines are only where the paper's rate lies well below 1000 Hz, and is too large elsewhere.",
             ratio_text(*min), ratio_text(*max),
             ratio_text(std::exp(log_sum / static_cast<double>(ratios.size()))));
}

constexpr std::string_view kWhatRatesMean =
    "Two rates stand in the table. The rate that a 1 kHz loop would hold is what section 8.1 of the paper "
    "measures: a tick that is done early waits for its millisecond, one that is late puts the next off, and "
    "all of the tick's work counts, not the step alone. So it is never above 1000 Hz, and 1000 Hz means that "
    "no tick was late. Steps a second are 1,000,000 over the median step in microseconds: what the "
    "algorithm's step alone would allow, with nothing else to do and nothing to wait for. The figure draws "
    "these, since the other hardly tells fast algorithms apart. Only steps in contact are counted. "
    "barrier-shell is not the paper's, so nothing of the paper stands beside it.";

HtmlTable rates_table(const std::vector<RateRow>& rows) {
  HtmlTable table{
      {"Algorithm", "Resolution", "Points", "Step, median (µs)", "Step, 99th percentile (µs)",
       "Rate that a 1 kHz loop would hold (Hz)", "In the paper (Hz)", "Steps a second, of the step alone"},
      {},
      true};
  for (const RateRow& r : rows) {
    table.rows.push_back({std::string(name_of(r.algorithm)), html_escaped(r.resolution),
                          fmt::format("{}", r.points), fmt::format("{:.4g}", r.step_us_median),
                          fmt::format("{:.4g}", r.step_us_p99), fmt::format("{:.0f}", r.rate_hz),
                          r.paper_rate_hz > 0 ? fmt::format("{:.0f}", r.paper_rate_hz) : "–",
                          fmt::format("{:.0f}", r.steps_per_s)});
  }
  return table;
}

}  // namespace

fs::path write_rates_report(const std::vector<RateRow>& rows, const fs::path& out_dir) {
  require_usable(rows);
  create_folder(out_dir / "figures");
  const Figure figure = draw_rates_figure(rows, out_dir / "figures");
  write_rates_csv(out_dir / "rates.csv", rows);
  std::string body = html_paragraph(plain_words(rows)) + html_paragraph(std::string(kWhatRatesMean));
  body += html_figure(figure.svg,
                      "Steps a second against resolution, on a logarithmic scale. The paper's section 8.1.");
  body += html_table(rates_table(rows));
  const fs::path page = out_dir / "rates.html";
  write_text_atomically(page,
                        [&](std::ostream& out) { out << html_page("Haptic rate against resolution", body); });
  return page;
}

}  // namespace osteomill
