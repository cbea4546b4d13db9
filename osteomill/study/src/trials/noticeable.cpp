#include "osteomill/study/noticeable.h"

#include <cmath>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace osteomill {

namespace {

// A published threshold: the smallest noticeable difference, relative or absolute.
struct Threshold {
  bool (*is_of)(const FieldDescription& figure);
  double share;
  double difference;
  const char* of;
  const char* source;
};

bool begins_with(const FieldDescription& figure, std::string_view word) {
  return figure.name.starts_with(word);
}

// The first match applies.
constexpr Threshold kThresholds[] = {
    {[](const auto& figure) { return figure.name.find("_hp_") != std::string::npos; }, 0.20, 0,
     "a vibration above 20 Hz", "Forta, Griffin and Morioka 2012"},
    {[](const auto& figure) { return begins_with(figure, "force_"); }, 0.07, 0, "a force",
     "Pang, Tan and Durlach 1991"},
    {[](const auto& figure) { return begins_with(figure, "torque_"); }, 0.13, 0, "a torque",
     "Jandura and Srinivasan 1994"},
    {[](const auto& figure) { return begins_with(figure, "shaft_") && figure.unit == "degrees"; }, 0, 2,
     "the shaft's direction",
     "the wrist's, Tan, Srinivasan, Eberman and Cheng 1994; an eye on the tool sees less"}};

}  // namespace

double least_noticeable(const FieldDescription& figure, double value) {
  for (const Threshold& threshold : kThresholds)
    if (threshold.is_of(figure)) return threshold.share * std::abs(value) + threshold.difference;
  return 0;
}

std::string about_noticeable() {
  std::string list;
  for (const Threshold& threshold : kThresholds) {
    list += fmt::format("{}{} of {} ({})", list.empty() ? "" : ", ",
                        threshold.share > 0 ? fmt::format("{:g} %", 100 * threshold.share)
                                            : fmt::format("{:g} degrees", threshold.difference),
                        threshold.of, threshold.source);
  }
  return fmt::format(
      "A difference counts as the same for a hand if it is less than a hand notices: {}. They were measured "
      "with attention on a single quantity; a hand that mills notices less.",
      list);
}

}  // namespace osteomill
