#include "app/exercise_file.h"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"

namespace osteomill::app {
namespace {

constexpr const char* kWhole = R"(title = "Access cavity"
task = "Open the pulp's roof"
scan = "builtin:tooth"
iso = 700
tools = [0.5, 1, "diamond-2"]
time_s = 600
entry = [0, 0, 20.5]
[target]
cylinder = { from = [0, 0, 20], to = [0, 0, 15], radius = 2 }
[keep]
margin_mm = 0.5
box = { min = [-1, -1, 0], max = [1, 1, 12] }
[[no_go]]
name = "floor"
sphere = { center = [0, 0, 5], radius = 1 }
[[no_go]]
name = "nerve"
warn_mm = 2
[[step]]
text = "Outline"
box = { min = [-2, -2, 18], max = [2, 2, 22] }
done_percent = 80
[[item]]
measure = "target_removed_percent"
at_least = 95
source = "a book"
[[item]]
measure = "no_go_contacts"
structure = "nerve"
at_most = 0
weight = 2
)";

class ExerciseFile : public ::testing::Test {
 protected:
  Exercise read(const std::string& text) {
    std::ofstream(file()) << text;
    return read_exercise_file(file());
  }
  /// Returns the fault, without the path, of kWhole with `replaced` replaced by `line`.
  std::string fault(const std::string& replaced, const std::string& line) {
    std::string text = kWhole;
    text.replace(text.find(replaced), replaced.size(), line);
    try {
      read(text);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(file().size() + 2);
    }
    return "";
  }
  std::string file() const { return (folder_.path() / "e.toml").string(); }

 private:
  TemporaryFolder folder_;
};

TEST_F(ExerciseFile, ReadsEverySectionOfAFile) {
  const Exercise exercise = read(kWhole);
  EXPECT_EQ(exercise.title, "Access cavity");
  EXPECT_EQ(exercise.scan, "builtin:tooth");
  EXPECT_EQ(exercise.isovalue, 700);
  ASSERT_EQ(exercise.burrs.size(), 3u);
  EXPECT_EQ(exercise.burrs[0].radius_mm, 0.5);
  EXPECT_EQ(exercise.burrs[1].radius_mm, 1);
  EXPECT_EQ(exercise.burrs[2].named, find_burr("diamond-2"));
  EXPECT_EQ(exercise.time_s, 600);
  ASSERT_EQ(exercise.target.shapes.size(), 1u);
  const auto& cylinder = std::get<CylinderShape>(exercise.target.shapes.front());
  EXPECT_EQ(cylinder.to_W, Vec3(0, 0, 15));
  EXPECT_EQ(cylinder.radius_mm, 2);
  EXPECT_EQ(exercise.target.line, 8);
  EXPECT_EQ(exercise.margin_mm, 0.5);
  ASSERT_TRUE(exercise.keep);
  ASSERT_EQ(exercise.no_go.size(), 2u);
  EXPECT_EQ(exercise.no_go[0].warn_mm, 3);
  EXPECT_EQ(std::get<LabelShape>(exercise.no_go[1].region.shapes.front()).label, "nerve");
  EXPECT_EQ(exercise.no_go[1].warn_mm, 2);
  ASSERT_EQ(exercise.steps.size(), 1u);
  EXPECT_EQ(exercise.steps[0].done_percent, 80);
  ASSERT_EQ(exercise.items.size(), 2u);
  EXPECT_EQ(exercise.items[0].at_least, 95);
  EXPECT_FALSE(exercise.items[0].at_most);
  EXPECT_EQ(exercise.items[1].part, "nerve");
  EXPECT_EQ(exercise.items[1].weight, 2);
}

TEST_F(ExerciseFile, ReadsATargetOfSeveralShapes) {
  const Exercise exercise = read(
      "title = 'a'\nscan = 's.nrrd'\n[target]\nlabel = 'crown'\nshell = { of = 'bone', thickness = 1.5 }\n"
      "recordings = ['a.h5', 'b.h5']\nat_least = 2\n");
  ASSERT_EQ(exercise.target.shapes.size(), 3u);
  EXPECT_EQ(std::get<ShellShape>(exercise.target.shapes[1]).thickness_mm, 1.5);
  EXPECT_EQ(std::get<RecordedShape>(exercise.target.shapes[2]).at_least, 2);
}

TEST_F(ExerciseFile, ReportsTheLineOfAFaultAndTheNearestName) {
  EXPECT_EQ(fault("time_s", "times_s"), "line 6: an exercise has no times_s; did you mean time_s?");
  EXPECT_EQ(fault("margin_mm", "margin"), "line 11: keep has no margin; did you mean margin_mm?");
  EXPECT_EQ(fault("warn_mm = 2", "warn = 2"), "line 18: no_go has no warn; did you mean warn_mm?");
  EXPECT_EQ(fault("radius = 2", "radus = 2"), "line 9: a cylinder has no radus; did you mean radius?");
  EXPECT_EQ(fault("radius = 2", "radius = 0"), "line 9: radius is not a number above 0");
  EXPECT_EQ(fault("[0, 0, 15]", "[0, 15]"), "line 9: to is not three numbers, mm");
  EXPECT_EQ(fault("max = [1, 1, 12]", "max = [-1, 1, 12]"), "line 12: the box's min is not below its max");
  EXPECT_EQ(fault("measure = \"no_go_contacts\"\n", ""), "line 27: an item needs measure");
  EXPECT_EQ(fault("target_removed_percent", "target_remove_percent"),
            "line 24: there is no measure target_remove_percent; did you mean target_removed_percent?");
  EXPECT_EQ(fault("at_least = 95\n", ""),
            "line 23: the item target_removed_percent needs at_least or at_most");
  EXPECT_EQ(fault("structure = \"nerve\"", "structure = \"nerv\""),
            "line 29: there is no no_go nerv; did you mean nerve?");
  EXPECT_EQ(fault("title = \"Access cavity\"", ""), "line 1: an exercise needs title");
  EXPECT_EQ(fault("cylinder =", "at_least = 1 #"), "line 9: at_least needs recordings");
  EXPECT_EQ(fault("cylinder =", "#"),
            "line 8: target needs a label, box, sphere, cylinder, outside_cone, shell or recordings");
  EXPECT_EQ(fault("[target]", "[targets]"), "line 8: an exercise has no targets; did you mean target?");
}

}  // namespace
}  // namespace osteomill::app
