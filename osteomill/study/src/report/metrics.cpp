#include "osteomill/study/metrics.h"

#include <algorithm>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "report/signals.h"

namespace osteomill {

namespace {

constexpr double kFelt_N = 0.02;
constexpr double kFelt_Nmm = 0.2;
constexpr double kLost_s = 1;

// Returns the angle between two unit vectors; acos would lose small angles.
double angle_rad(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double path_mm(std::span<const TickRecord> records) {
  constexpr double kEvery_s = 0.02;
  double path = 0;
  const TickRecord* last = &records.front();
  for (const TickRecord& record : records) {
    if (record.time_s - last->time_s < kEvery_s) continue;
    path += (record.X_WT.position_mm - last->X_WT.position_mm).norm();
    last = &record;
  }
  return path;
}

double burr_excursion_mm(std::span<const TickRecord> records, double tick_s) {
  constexpr double kMeanOver_s = 0.1;
  const auto each = static_cast<std::size_t>(std::max(1.0, std::round(kMeanOver_s / tick_s)));
  const auto mean_of = [](std::span<const TickRecord> some) {
    Vec3 sum_mm = Vec3::Zero();
    for (const TickRecord& record : some) sum_mm += record.X_WT.position_mm;
    return Vec3(sum_mm / static_cast<double>(some.size()));
  };
  const Vec3 mean_mm = mean_of(records);
  double farthest_mm = 0;
  for (std::size_t n = 0; n + each <= records.size(); n += each)
    farthest_mm = std::max(farthest_mm, (mean_of(records.subspan(n, each)) - mean_mm).norm());
  return farthest_mm;
}

ShaftTurns shaft_turns(std::span<const TickRecord> records, const std::vector<bool>& touches,
                       double rate_hz) {
  constexpr double kWithin_s = 0.05;
  const auto half = static_cast<std::size_t>(std::max(1.0, std::round(kWithin_s / 2 * rate_hz)));
  const auto turn_deg = [&](std::size_t n) {
    const TickRecord& before = records[n - std::min(n, half)];
    const TickRecord& after = records[std::min(n + half, records.size() - 1)];
    return 180 / std::numbers::pi * angle_rad(shaft_direction(before.X_WT), shaft_direction(after.X_WT));
  };
  ShaftTurns turns;
  double step_max = 0;
  for (std::size_t n = 1; n < records.size(); ++n) {
    if (!touches[n] && !touches[n - 1]) continue;
    const double turn = turn_deg(n);
    turns.max_deg = std::max(turns.max_deg, turn);
    const double step = (records[n].wrench.torque_Nmm - records[n - 1].wrench.torque_Nmm).norm();
    if (step <= step_max) continue;
    step_max = step;
    turns.at_torque_step_deg = turn;
  }
  return turns;
}

double torque_following_force(std::span<const Vec3> torque_Nmm, std::span<const Vec3> force_N,
                              const std::vector<bool>& shaft_touches, double rate_hz) {
  constexpr double kWithin_s = 0.01;
  const auto reach = static_cast<std::size_t>(std::max(2.0, std::round(kWithin_s * rate_hz)));
  return multiple_correlation(high_pass(torque_Nmm, rate_hz, kBuzzAbove_hz),
                              high_pass(force_N, rate_hz, kBuzzAbove_hz), reach, shaft_touches);
}

// Ignores the device's pose, which a device may report as not finite.
bool all_finite(const TickRecord& r) {
  return std::isfinite(r.time_s) && is_finite(r.X_WT) && r.wrench.force_N.allFinite() &&
         r.wrench.torque_Nmm.allFinite() && std::isfinite(r.removed_mm3) && std::isfinite(r.compute_us) &&
         std::isfinite(r.milling_us) && std::isfinite(r.tick_cpu_us);
}

void require_usable(const Recording& recording, std::span<const TickRecord> records) {
  const std::string name = recording.path.string();
  if (records.size() < 2) throw InputError(name, "has fewer than two ticks, too few for a report");
  if (!(recording.description.tick_period_s * kBuzzAbove_hz < 0.4)) {
    throw InputError(name, fmt::format("has a tick every {} s, too few to resolve 20 Hz",
                                       recording.description.tick_period_s));
  }
  for (std::size_t row = 0; row < records.size(); ++row) {
    if (!all_finite(records[row]))
      throw InputError(name, fmt::format("a number of tick {} is not finite", row));
    if (row > 0 && !(records[row].time_s > records[row - 1].time_s)) {
      throw InputError(name,
                       fmt::format("the time of tick {} is not later than that of the tick before", row));
    }
  }
}

// Sums the bone restored by undo or reset within a session, and the change from one session to the next,
// which may also redo a cut. This counts the bone milled in the first tick of a session too; one tick is
// negligible.
double put_back_mm3(std::span<const TickRecord> records) {
  double sum_mm3 = 0;
  for (std::size_t n = 1; n < records.size(); ++n) {
    const double back_mm3 = records[n - 1].removed_mm3 - records[n].removed_mm3;
    sum_mm3 += records[n].session == records[n - 1].session ? std::max(0.0, back_mm3) : back_mm3;
  }
  return sum_mm3;
}

}  // namespace

Contact contact_of(const TickRecord& record) {
  Contact contact;
  contact.burr = record.burr_force_W_N.norm() >= kFelt_N;
  contact.shaft = (record.wrench.torque_Nmm - record.cutting_torque_W_Nmm).norm() >= kFelt_Nmm;
  contact.force = contact.burr || record.wrench.force_N.norm() >= kFelt_N;
  contact.torque = record.wrench.torque_Nmm.norm() >= kFelt_Nmm;
  return contact;
}

namespace {

ContactShares contact_shares(std::span<const TickRecord> records) {
  ContactShares shares;
  if (records.empty()) return shares;
  const double began_s = records.front().time_s;
  double last_s = began_s;
  for (const TickRecord& record : records) {
    const Contact contact = contact_of(record);
    shares.any += contact.any();
    shares.burr += contact.burr;
    shares.shaft += contact.shaft;
    shares.force += contact.force;
    shares.torque += contact.torque;
    if (contact.any()) last_s = record.time_s;
  }
  if (shares.any == 0 || records.back().time_s - last_s >= kLost_s) shares.lost_after_s = last_s - began_s;
  shares.lost_while_milling = shares.any > 0 && shares.is_lost() && records.back().spindle_on;
  for (double* share : {&shares.any, &shares.burr, &shares.shaft, &shares.force, &shares.torque}) {
    *share /= static_cast<double>(records.size());
  }
  return shares;
}

}  // namespace

namespace {

// Reason why nothing was measured; `words` has a placeholder for the number.
struct Reason {
  const char* words;
  double number = 0;
};

Reason reason_of(const ContactShares& contact) {
  if (contact.any == 0) return {contact.lost_while_milling ? "lost while milling" : "never touched"};
  if (contact.is_lost() && contact.lost_while_milling)
    return {"lost while milling, after {seconds}", contact.lost_after_s};
  if (contact.is_lost()) return {"lost contact after {seconds}", contact.lost_after_s};
  if (!is_enough_contact(contact.any)) return {"touched {share}", contact.any};
  if (!is_enough_contact(contact.shaft)) return {"the shaft touched {share}", contact.shaft};
  if (!is_enough_contact(contact.torque)) return {"felt a torque {share}", contact.torque};
  if (!is_enough_contact(contact.force)) return {"felt a force {share}", contact.force};
  return {"felt too little of it"};
}

std::string words_of(const Reason& reason) {
  const std::string share =
      reason.number < 0.005 ? "for less than 1 % of the time"
                            : fmt::format("for {:.0f} % of the time", std::floor(100 * reason.number + 1e-9));
  return fmt::format(fmt::runtime(reason.words), fmt::arg("share", share),
                     fmt::arg("seconds", fmt::format("{:.1f} s", reason.number)));
}

}  // namespace

std::string contact_words(const ContactShares& contact) {
  return words_of(reason_of(contact));
}

std::string contact_words(std::span<const ContactShares> unmeasured, std::size_t hands) {
  std::map<std::string_view, std::vector<double>> reasons;
  for (const ContactShares& contact : unmeasured) {
    const Reason reason = reason_of(contact);
    reasons[reason.words].push_back(reason.number);
  }
  std::string text;
  for (const auto& [words, numbers] : reasons) {
    text += fmt::format("{}{} in {} of {} hands", text.empty() ? "" : "; ",
                        words_of({words.data(), distribution_of(numbers).median}), numbers.size(), hands);
  }
  return text;
}

VectorMetrics vector_metrics(std::span<const Vec3> samples, double rate_hz,
                             const std::vector<bool>& counted) {
  const auto counts = [&](std::size_t n) { return counted.empty() || counted[n]; };
  const std::vector<Vec3> high = high_pass(samples, rate_hz, kBuzzAbove_hz);
  VectorMetrics metrics;
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (n > 0 && (counts(n) || counts(n - 1))) {
      metrics.step_max = std::max(metrics.step_max, (samples[n] - samples[n - 1]).norm());
    }
    if (!counts(n)) continue;
    const double size = samples[n].norm();
    metrics.mean += size;
    metrics.max = std::max(metrics.max, size);
    squares += high[n].squaredNorm();
    ++count;
  }
  if (count == 0) return metrics;
  metrics.mean /= static_cast<double>(count);
  metrics.hp_rms = std::sqrt(squares / static_cast<double>(count));
  metrics.hp_share = metrics.mean == 0 ? 0 : metrics.hp_rms / metrics.mean;
  return metrics;
}

DirectionMetrics direction_metrics(std::span<const Vec3> directions) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& direction : directions) sum += direction;
  const Vec3 mean = sum.normalized();
  double square = 0;
  double max = 0;
  for (const Vec3& direction : directions) {
    const double angle = angle_rad(mean, direction);
    square += angle * angle;
    max = std::max(max, angle);
  }
  const double degrees = 180.0 / std::numbers::pi;
  if (directions.empty()) return {};
  return {degrees * std::sqrt(square / static_cast<double>(directions.size())), degrees * max};
}

RunMetrics run_metrics(const Recording& recording, std::size_t first) {
  const auto records = std::span(recording.records).subspan(std::min(first, recording.records.size()));
  require_usable(recording, records);
  std::vector<Vec3> force_N, torque_Nmm, shaft_W, shaft_D;
  std::vector<bool> touches, shaft_touches;
  std::vector<double> step_us, tick_us;
  double contacts = 0, cutting_s = 0;
  SustainedRate held(1e6 * recording.description.tick_period_s);
  for (const TickRecord& record : records) {
    force_N.push_back(record.wrench.force_N);
    torque_Nmm.push_back(record.wrench.torque_Nmm);
    const Contact contact = contact_of(record);
    touches.push_back(contact.any());
    shaft_touches.push_back(contact.shaft);
    if (touches.back()) contacts += record.contacts;
    if (touches.back()) shaft_W.push_back(shaft_direction(record.X_WT));
    if (touches.back() && is_finite(record.X_WD))
      shaft_D.push_back(record.X_WD.orientation.conjugate() * shaft_W.back());
    if (contact.burr && record.spindle_on) cutting_s += record.dt_s;
    step_us.push_back(record.compute_us);
    tick_us.push_back(record.busy_us());
    held.add(record.busy_us());
  }
  const double rate_hz = 1.0 / recording.description.tick_period_s;
  RunMetrics metrics;
  metrics.steps = static_cast<double>(records.size());
  metrics.counted_from_s = records.front().time_s - recording.records.front().time_s;
  metrics.step_us = distribution_of(step_us);
  metrics.tick_us = distribution_of(tick_us);
  metrics.rate_hz = held.rate_hz();
  metrics.contact = contact_shares(records);
  metrics.force_N = metrics.torque_Nmm = kNotFelt;
  metrics.shaft = {kNotMeasured, kNotMeasured};
  metrics.shaft_from_handle_deg = kNotMeasured;
  const ContactShares& contact = metrics.contact;
  if (is_enough_contact(contact.force)) metrics.force_N = vector_metrics(force_N, rate_hz, touches);
  if (is_enough_contact(contact.torque)) metrics.torque_Nmm = vector_metrics(torque_Nmm, rate_hz, touches);
  if (is_enough_contact(contact.shaft)) {
    metrics.shaft = direction_metrics(shaft_W);
    // The spread is only rounding if an algorithm shows the tool at the handle.
    constexpr double kRounding_deg = 1e-6;
    const double spread_deg = direction_metrics(shaft_D).spread_deg;
    metrics.shaft_from_handle_deg = spread_deg < kRounding_deg ? 0 : spread_deg;
  }
  metrics.turns = shaft_turns(records, touches, rate_hz);
  if (!is_enough_contact(contact.torque)) metrics.turns.at_torque_step_deg = kNotMeasured;
  metrics.torque_follows_force = torque_following_force(torque_Nmm, force_N, shaft_touches, rate_hz);
  if (is_enough_contact(contact.any)) {
    metrics.contacts_mean = contacts / static_cast<double>(shaft_W.size());
  } else {
    metrics.contacts_mean = kNotMeasured;
    metrics.turns = {kNotMeasured, kNotMeasured};
  }
  metrics.put_back_mm3 = put_back_mm3(records);
  metrics.removed_mm3 = records.back().removed_mm3 - records.front().removed_mm3 + metrics.put_back_mm3;
  if (cutting_s > 0) metrics.removal_mm3_per_s = metrics.removed_mm3 / cutting_s;
  metrics.path_mm = path_mm(records);
  metrics.burr_excursion_mm = burr_excursion_mm(records, recording.description.tick_period_s);
  return metrics;
}

}  // namespace osteomill
