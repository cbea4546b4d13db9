#include "osteomill/numbers/field.h"

#include <array>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

enum class Kind : unsigned char { none, one, two };

struct Part {
  double length_mm = 1;
  bool on = false;
};

struct Whole {
  Part part;
  int count = 3;
  Kind kind = Kind::none;
  std::array<double, 2> ends{4, 5};
};

constexpr unsigned kShown = 1;

std::vector<Field<Part>> part_fields() {
  return {field<Part>("length", "mm", &Part::length_mm, NumberRange::positive(), "How long", kShown),
          field<Part>("on", "", &Part::on, NumberRange::on_or_off(), "Whether it is on")};
}

TEST(Field, NotANumberIsAllowedByNoRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const NumberRange open{-kInfinity, kInfinity, false};
  for (const NumberRange& range : {open, NumberRange::finite(), NumberRange::positive(),
                                   NumberRange::not_negative(), NumberRange::on_or_off()})
    EXPECT_FALSE(range.contains(kNan));
  EXPECT_TRUE(open.contains(kInfinity));
  EXPECT_FALSE(NumberRange::finite().contains(-kInfinity));
}

TEST(Field, ARangeHasBothItsEndsAndNothingBeside) {
  EXPECT_FALSE(NumberRange::positive().contains(0));
  EXPECT_TRUE(NumberRange::not_negative().contains(0));
  EXPECT_FALSE(NumberRange::not_negative().contains(-1e-300));
  const NumberRange count = NumberRange::count(2, 4);
  EXPECT_TRUE(count.contains(2) && count.contains(4));
  EXPECT_FALSE(count.contains(1) || count.contains(5) || count.contains(2.5));
  EXPECT_FALSE(NumberRange::on_or_off().contains(2));
}

TEST(Field, ItReadsAndWritesNumbersSwitchesAndEnumerations) {
  Whole whole;
  const auto count = field<Whole>("count", "", &Whole::count, NumberRange::count(0), "");
  const auto kind = field<Whole>("kind", "", &Whole::kind, NumberRange::count(0, 2), "");
  const auto end = field<Whole>(
      "end", "mm", [](auto& w) -> auto& { return w.ends[1]; }, NumberRange::finite(), "");
  EXPECT_EQ(count.get(whole), 3);
  EXPECT_EQ(end.get(whole), 5);
  count.set(whole, 7);
  kind.set(whole, 2);
  end.set(whole, -0.5);
  EXPECT_EQ(whole.count, 7);
  EXPECT_EQ(whole.kind, Kind::two);
  EXPECT_EQ(whole.ends, (std::array<double, 2>{4, -0.5}));
}

TEST(Field, ThoseOfAPartAreFieldsOfTheWhole) {
  const auto fields = fields_within<Whole>(&Whole::part, part_fields());
  ASSERT_EQ(fields.size(), 2u);
  Whole whole;
  find_field(fields, "length")->set(whole, 2.5);
  find_field(fields, "on")->set(whole, 1);
  EXPECT_EQ(whole.part.length_mm, 2.5);
  EXPECT_TRUE(whole.part.on);
  EXPECT_EQ(find_field(fields, "on")->get(whole), 1);
  EXPECT_TRUE(fields[0].has(kShown));
  EXPECT_FALSE(fields[1].has(kShown));
  EXPECT_EQ(fields[0].unit, "mm");
  EXPECT_EQ(find_field(fields, "width"), nullptr);
}

}  // namespace
}  // namespace osteomill
