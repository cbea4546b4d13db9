#include "osteomill/base/field.h"

#include <array>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

enum class Kind : unsigned char { none, one, two };

struct Part {
  double length_mm = 1;
  bool on = false;
};

struct Sample {
  Part part;
  int count = 3;
  Kind kind = Kind::none;
  std::array<double, 2> ends{4, 5};
};

constexpr unsigned kShown = 1;

std::vector<Field<Part>> part_fields() {
  return {field<Part>({"length", "mm", NumberRange::positive(), "How long", kShown, "part-length"},
                      &Part::length_mm),
          field<Part>({"on", "", NumberRange::on_or_off(), "Whether it is on"}, &Part::on)};
}

TEST(Field, NamesTheValuesOfChoicesAndSwitches) {
  const FieldDescription law{.range = NumberRange::count(0, 1), .choices = {"constant-energy", "chips"}};
  EXPECT_EQ(law.name_of_value(1), "chips") << "two choices have the range of a switch";
  EXPECT_EQ(law.name_of_value(2), std::nullopt);
  EXPECT_EQ((FieldDescription{.range = NumberRange::on_or_off()}.name_of_value(0)), "off");
  EXPECT_EQ((FieldDescription{.range = NumberRange::count(0)}.name_of_value(1)), std::nullopt);
}

TEST(Field, EveryRangeExcludesNan) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const NumberRange open{-kInfinity, kInfinity, false};
  for (const NumberRange& range : {open, NumberRange::finite(), NumberRange::positive(),
                                   NumberRange::not_negative(), NumberRange::on_or_off()})
    EXPECT_FALSE(range.contains(kNan));
  EXPECT_TRUE(open.contains(kInfinity));
  EXPECT_FALSE(NumberRange::finite().contains(-kInfinity));
}

TEST(Field, RangeIncludesItsLimitsAndNothingBeyond) {
  EXPECT_FALSE(NumberRange::positive().contains(0));
  EXPECT_TRUE(NumberRange::not_negative().contains(0));
  EXPECT_FALSE(NumberRange::not_negative().contains(-1e-300));
  const NumberRange count = NumberRange::count(2, 4);
  EXPECT_TRUE(count.contains(2) && count.contains(4));
  EXPECT_FALSE(count.contains(1) || count.contains(5) || count.contains(2.5));
  EXPECT_FALSE(NumberRange::on_or_off().contains(2));
}

TEST(Field, ReadsAndWritesNumbersAndEnumerations) {
  Sample sample;
  const auto count = field<Sample>({"count", "", NumberRange::count(0), ""}, &Sample::count);
  const auto kind = field<Sample>({"kind", "", NumberRange::count(0, 2), ""}, &Sample::kind);
  const auto end = field<Sample>(
      {"end", "mm", NumberRange::finite(), ""}, [](auto& w) -> auto& { return w.ends[1]; });
  EXPECT_EQ(count.get(sample), 3);
  EXPECT_EQ(end.get(sample), 5);
  count.set(sample, 7);
  kind.set(sample, 2);
  end.set(sample, -0.5);
  EXPECT_EQ(sample.count, 7);
  EXPECT_EQ(sample.kind, Kind::two);
  EXPECT_EQ(sample.ends, (std::array<double, 2>{4, -0.5}));
}

TEST(Field, MemberFieldsBecomeFieldsOfTheStruct) {
  const auto fields = fields_within<Sample>(&Sample::part, part_fields());
  ASSERT_EQ(fields.size(), 2u);
  Sample sample;
  find_field(fields, "length")->set(sample, 2.5);
  find_field(fields, "on")->set(sample, 1);
  EXPECT_EQ(sample.part.length_mm, 2.5);
  EXPECT_TRUE(sample.part.on);
  EXPECT_EQ(find_field(fields, "on")->get(sample), 1);
  EXPECT_TRUE(fields[0].has(kShown));
  EXPECT_FALSE(fields[1].has(kShown));
  EXPECT_EQ(fields[0].unit, "mm");
  EXPECT_EQ(find_field(fields, "width"), nullptr);
  EXPECT_EQ(field_of_option(fields, "part-length"), &fields[0]);
  EXPECT_EQ(field_of_option(fields, ""), nullptr) << "although a field has an empty option";
}

TEST(Field, DescribesARangeInWords) {
  EXPECT_EQ(range_text(NumberRange::positive()), "a number above 0");
  EXPECT_EQ(range_text(NumberRange::not_negative()), "a number of 0 or more");
  EXPECT_EQ(range_text(NumberRange::finite()), "a number");
  EXPECT_EQ(range_text(NumberRange::count(1, 32)), "a whole number from 1 to 32");
  EXPECT_EQ(range_text(NumberRange::on_or_off()), "on or off");
  EXPECT_EQ(range_text({0.03, 1}), "a number from 0.03 to 1");
}

}  // namespace
}  // namespace osteomill
