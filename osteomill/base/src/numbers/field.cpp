#include "osteomill/base/field.h"

#include <sstream>

namespace osteomill {

std::string range_text(const NumberRange& range) {
  if (range == NumberRange::on_or_off()) return "on or off";
  const bool has_begin = range.min > std::numeric_limits<double>::lowest();
  const bool has_end = range.max < std::numeric_limits<double>::max();
  std::ostringstream text;
  text << (range.whole ? "a whole number" : "a number");
  if (range.min == NumberRange::positive().min) {
    text << " above 0";
  } else if (has_begin) {
    text << (has_end ? " from " : " of ") << range.min << (has_end ? "" : " or more");
  }
  if (has_end) text << " to " << range.max;
  return text.str();
}

}  // namespace osteomill
