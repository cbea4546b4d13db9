#include "osteomill/ct/read_labels.h"

#include <cstring>

#include <fmt/format.h>

#include "tests/support/folder_test.h"

namespace osteomill {
namespace {

using testing_support::contains;

class ReadLabels : public testing_support::FolderTest {
 protected:
  // 2 x 2 x 2 voxels of 1 mm.
  static std::string map_of(const std::string& values, const std::string& fields = "",
                            const std::string& type = "float") {
    return "NRRD0004\ntype: " + type +
           "\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\nspace: LPS\n"
           "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n" +
           fields + "\n" + values + "\n";
  }
  static GridGeometry scan() {
    GridGeometry geometry;
    geometry.dims = {2, 2, 2};
    return geometry;
  }
  std::string refusal_of(const LabelFiles& files, const GridGeometry& geometry = scan()) const {
    try {
      read_labels(files, geometry);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_FALSE(contains(what, "\n"));
      return what;
    }
    return "";
  }
};

TEST_F(ReadLabels, ReadsNamesAndColoursOfSlicerSegmentations) {
  const auto file = write("jaw.seg.nrrd", map_of("0 4 4 7 0 0 -2 7",
                                                 "Segment0_Name:=Lower jaw\nSegment0_LabelValue:=4\n"
                                                 "Segment0_Color:=1 0.5 0\nSegment1_Name:=Nerve\n"
                                                 "Segment1_LabelValue:=7\nSegment1_Color:=0 0 1\n",
                                                 "short"));
  const LabelsRead read = read_labels({file, {}, {"NERVE"}}, scan());
  ASSERT_EQ(read.map->labels().size(), 3u);
  EXPECT_EQ(read.map->labels()[1], (Label{4, "Lower jaw", {255, 128, 0}, false}));
  EXPECT_EQ(read.map->labels()[2], (Label{7, "Nerve", {0, 0, 255}, true}));
  EXPECT_EQ(read.map->labels()[0].name, "label -2");
  EXPECT_EQ(read.map->voxel_counts(), (std::vector<std::size_t>{0, 1, 2, 2}));
  EXPECT_EQ(read.map->at({1, 1, 0}), 3);
  EXPECT_TRUE(read.warnings.empty());
}

// Two layers of 2 x 2 x 2 voxels as 3D Slicer writes them, with the values of a voxel adjacent.
TEST_F(ReadLabels, MergesLayersThatDoNotOverlap) {
  const auto layered = [&](const std::string& values, const std::string& fields, const std::string& first,
                           const std::string& second) {
    return write(
        "a.seg.nrrd",
        "NRRD0004\ntype: uchar\ndimension: 4\nsizes: 2 2 2 2\nencoding: ascii\nspace: LPS\n" + fields +
            "space origin: (0,0,0)\nSegment0_ID:=s\nSegment0_Name:=Jaw\nSegment0_LabelValue:=" + first +
            "\nSegment0_Layer:=0\nSegment1_Name:=Nerve\nSegment1_LabelValue:=" + second +
            "\nSegment1_Layer:=1\n\n" + values);
  };
  const std::string axes = "(1,0,0) (0,1,0) (0,0,1)";
  const std::string fastest = "kinds: list domain domain domain\nspace directions: none " + axes + "\n";
  const std::string slowest = "kinds: domain domain domain list\nspace directions: " + axes + " none\n";
  const auto expect_labels = [&](const std::filesystem::path& file, int jaw, int nerve,
                                 std::size_t warnings) {
    const LabelsRead read = read_labels({file, {}, {}}, scan());
    ASSERT_EQ(read.map->labels().size(), 2u);
    EXPECT_EQ(read.map->labels()[0].value, jaw);
    EXPECT_EQ(read.map->labels()[0].name, "Jaw");
    EXPECT_EQ(read.map->labels()[1].value, nerve);
    EXPECT_EQ(read.map->labels()[1].name, "Nerve");
    EXPECT_EQ(read.map->at({1, 0, 0}), 1);
    EXPECT_EQ(read.map->at({0, 1, 1}), 2);
    EXPECT_EQ(read.map->voxel_counts(), (std::vector<std::size_t>{0, 1, 1}));
    EXPECT_EQ(read.warnings.size(), warnings);
    const Scan labels = read_scan(file);
    EXPECT_TRUE(labels.is_labels);
    const VoxelIndex of_nerve{0, 1, 1};
    EXPECT_EQ(labels.grid[of_nerve], static_cast<float>(nerve));
  };
  expect_labels(layered("0 0 3 0 0 0 0 0  0 0 0 0 0 5 0 0", fastest, "3", "5"), 3, 5, 0);
  expect_labels(layered("0 3 0 0 0 0 0 0  0 0 0 0 0 0 5 0", slowest, "3", "5"), 3, 5, 0);
  expect_labels(layered("0 0 1 0 0 0 0 0  0 0 0 0 0 1 0 0", fastest, "1", "1"), 1, 2, 1);
  EXPECT_TRUE(contains(refusal_of({layered("0 0 1 1 0 0 0 0  0 0 0 0 0 1 0 1", fastest, "1", "1"), {}, {}}),
                       "overlapping segments, in 2 layers; save it as a label map of one layer"));
}

TEST_F(ReadLabels, TableOverridesNamesAndColoursOfTheFile) {
  const auto file = write("a.seg.nrrd", map_of("0 1 2 3 0 0 0 0",
                                               "Segment0_Name:=Old\nSegment0_LabelValue:=1\n"
                                               "Segment1_Name:=Kept\nSegment1_LabelValue:=2\n"));
  const auto table =
      write("a.ctbl", "# Color table file\r\n0 Background 0 0 0 0\r\n\r\n1 left_facial nerve 10 20 30 255\n");
  const LabelsRead read = read_labels({file, table, {"3", "left facial nerve"}}, scan());
  EXPECT_EQ(read.map->labels()[0], (Label{1, "left facial nerve", {10, 20, 30}, true}));
  EXPECT_EQ(read.map->labels()[1].name, "Kept");
  EXPECT_EQ(read.map->labels()[2].name, "label 3");
  EXPECT_TRUE(read.map->labels()[2].no_go);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_TRUE(contains(read.warnings[0], "a.ctbl: has no entry for label 3")) << read.warnings[0];
}

TEST_F(ReadLabels, ReadsNamesAndColoursOfItkSnapLabelFiles) {
  const auto file = write("a.nrrd", map_of("0 26 93 26 0 0 0 0"));
  const auto table = write("snap.txt",
                           "################\n# ITK-SnAP Label Description File\n"
                           "    0     0    0    0        0  0  0    \"Clear Label\"\r\n"
                           "   26   230  230  150        1  1  1    \"mandible, left\"\n"
                           "   93   100  100  230      0.5  1  1    \"the \"canal\"\"\n");
  const LabelsRead read = read_labels({file, table, {"mandible, left"}}, scan());
  EXPECT_EQ(read.map->labels()[0], (Label{26, "mandible, left", {230, 230, 150}, true}));
  EXPECT_EQ(read.map->labels()[1], (Label{93, "the \"canal\"", {100, 100, 230}, false}));
  EXPECT_TRUE(read.warnings.empty());
  for (const char* line :
       {"1 2 3 4 1 1 \"six\"", "1 2 3 400 1 1 1 \"bright\"", "1.5 2 3 4 1 1 1 \"half\"", "\""})
    EXPECT_TRUE(contains(refusal_of({file, write("bad.txt", line), {}}), "line 1 is neither")) << line;
}

TEST_F(ReadLabels, ReadsSegmentNamesWithAnyNumbering) {
  for (const auto& [first, second] : {std::pair{"0", "1"}, {"1", "2"}, {"0", "12"}}) {
    const auto file = write("a.seg.nrrd", map_of("0 4 4 7 0 0 0 7", fmt::format("Segment{0}_Name:=Jaw\n"
                                                                                "Segment{0}_LabelValue:=4\n"
                                                                                "Segment{1}_Name:=Nerve\n"
                                                                                "Segment{1}_LabelValue:=7\n",
                                                                                first, second)));
    const LabelsRead read = read_labels({file, {}, {}}, scan());
    EXPECT_EQ(read.map->labels().at(0).name, "Jaw") << first;
    EXPECT_EQ(read.map->labels().at(1).name, "Nerve") << second;
  }
}

TEST_F(ReadLabels, ConvertsNamesOfATableToUtf8) {
  const auto file = write("a.nrrd", map_of("0 26 26 26 0 0 0 0"));
  const std::string a = "\xC3\xA4";
  const auto name_of = [&](const std::string& said) {
    const auto table = write("a.txt", "\xEF\xBB\xBF# names\n26 1 2 3 1 1 1 \"" + said + "\"\n");
    return read_labels({file, table, {}}, scan()).map->labels().at(0).name;
  };
  EXPECT_EQ(name_of("Z\xE4hne"), "Z" + a + "hne");
  EXPECT_EQ(name_of("Z" + a + "hne"), "Z" + a + "hne");
  EXPECT_EQ(name_of("a\x1B[1mb\xC2\x9B"
                    "c"),
            "a [1mb c");
  const std::string letters(99, 'x');
  EXPECT_EQ(name_of(letters + a), letters);
}

// Returns a NIfTI-1 file of 2 x 2 x 2 labels with `text` in an extension.
std::string nifti_with(std::string text) {
  std::string bytes(352, '\0');
  const auto set = [&](std::size_t offset, auto value) {
    std::memcpy(bytes.data() + offset, &value, sizeof(value));
  };
  text.resize((text.size() + 8 + 15) / 16 * 16 - 8);
  set(0, std::int32_t{348});
  for (const auto& [offset, value] : {std::pair{40, 3}, {42, 2}, {44, 2}, {46, 2}, {70, 2}, {72, 8}})
    set(static_cast<std::size_t>(offset), static_cast<std::int16_t>(value));
  for (const std::size_t offset : {76u, 80u, 84u, 88u}) set(offset, 1.0F);
  set(108, static_cast<float>(352 + 8 + text.size()));
  set(252, std::int16_t{1});
  bytes.replace(344, 3, "n+1");
  bytes[348] = 1;
  const auto size = static_cast<std::int32_t>(8 + text.size());
  bytes.append(reinterpret_cast<const char*>(&size), 4);
  return bytes + std::string(4, '\0') + text + std::string("\0\x1a\x5d\0\0\0\0\0", 8);
}

TEST_F(ReadLabels, ReadsNamesOfANiftiExtension) {
  const std::string head = "<?xml version=\"1.0\"?><CaretExtension><VolumeInformation><LabelTable>";
  const std::string tail = "</LabelTable></VolumeInformation></CaretExtension>\n";
  for (const std::string& text :
       {head +
            "<Label Key=\"26\" Red=\"1\" Green=\"0.5\" Blue=\"0\" Alpha=\"1\"><![CDATA[S1 & L5]]></Label>"
            "<Label Alpha='1' Key='93'>rib</Label>" +
            tail,
        head +
            "<Label\n Key=\"26\" Red=\"1\" Green=\"0.5\" Blue=\"0\">S1 &amp; "
            "L5</Label>\n<Label\tKey=\"93\">rib"
            "</Label>" +
            tail,
        head +
            "<Label Blue=\"0\" Green=\"0.5\" Red=\"1\" Key=\"26\">S1 &amp; L5</Label><Label "
            "Key=\"93\">rib</Label>" +
            tail,
        std::string("{\"26\": \"S1 & L5\", \"93\": \"rib\"}"),
        std::string("{\"version\": 2, \"labels\": {\"background\": 0, \"S1 & L5\": 26, \"rib\": 93}}"),
        std::string("{\"segments\": [{\"value\": 26, \"name\": \"S1 & L5\", \"color\": [255, 128, 0]},"
                    "{\"value\": \"93\", \"name\": \"rib\"}]}")}) {
    const auto file = write("a.nii", nifti_with(text));
    GridGeometry lps = scan();
    lps.direction.diagonal() = Vec3(-1, -1, 1);
    const LabelsRead read = read_labels({file, {}, {"rib"}}, lps);
    ASSERT_EQ(read.map->labels().size(), 2u);
    EXPECT_EQ(read.map->labels()[0].name, "S1 & L5") << text;
    EXPECT_EQ(read.map->labels()[1].name, "rib") << text;
    const bool has_colour = contains(text, "Red") || contains(text, "color");
    EXPECT_EQ((read.map->labels()[0].colour == std::array<std::uint8_t, 3>{255, 128, 0}), has_colour) << text;
    EXPECT_TRUE(read_scan(file).is_labels);
  }
  for (const char* text :
       {"{\"version\": 2}", "{\"26\": ", "<Label Key=\"26\"", "AFNI 26", "[[[[[[[[[[[[[[1]]]]"}) {
    const auto file = write("b.nii", nifti_with(text));
    EXPECT_FALSE(read_scan(file).is_labels) << text;
  }
}

TEST_F(ReadLabels, RefusesAnInvalidLabelMapInOneLine) {
  const auto refused = [&](const std::string& values, const std::string& fields = "") {
    return refusal_of({write("m.nrrd", map_of(values, fields)), {}, {}});
  };
  EXPECT_TRUE(contains(refused("0 1 1.5 2 0 0 0 0"), "it holds 1.5, and labels are whole numbers"));
  EXPECT_TRUE(contains(refused("0 1 nan 2 0 0 0 0"), "m.nrrd: is not a label map"));
  EXPECT_TRUE(contains(refused("0 1 2e7 2 0 0 0 0"), "labels are whole numbers up to a million"));
  EXPECT_TRUE(contains(refused("0 0 0 0 0 0 0 0"), "has no labels: all its voxels are 0"));
  EXPECT_TRUE(contains(refused("0 1 2 3 0 0 0"), "is cut short"));
  EXPECT_TRUE(contains(refused("0 1 2 3 0 0 0 0", "kinds: list domain domain\n"), "several layers"));
  GridGeometry elsewhere = scan();
  elsewhere.origin_mm = {50, 0, 0};
  const auto one = write("m.nrrd", map_of("0 1 2 3 0 0 0 0"));
  EXPECT_TRUE(
      contains(refusal_of({one, {}, {}}, elsewhere),
               "does not overlap the scan: its extent is 0 to 1, 0 to 1, 0 to 1 mm, the scan's 50 to 51"));
  EXPECT_TRUE(contains(refusal_of({one, {}, {"dura"}}),
                       "has no label \"dura\" for --no-go; it has 1 label 1, 2 label 2, 3 label 3"));
  EXPECT_TRUE(contains(refusal_of({folder_ / "none.nrrd", {}, {}}), "no such file"));
  EXPECT_TRUE(contains(refusal_of({write("labels.txt", "1"), {}, {}}), "is not a label map"));
  EXPECT_TRUE(contains(refusal_of({one, write("t.ctbl", "1 a 0 0 0 255\n2 b 0 0 900 255\n"), {}}),
                       "t.ctbl: line 2 is neither"));
  EXPECT_TRUE(contains(refusal_of({one, write("t.ctbl", "# nothing\n"), {}}), "t.ctbl: holds no labels"));
}

TEST_F(ReadLabels, RefusesMoreThan255Labels) {
  std::string values;
  for (int n = 0; n < 343; ++n) values += std::to_string(n) + " ";
  std::string map = map_of(values);
  map.replace(map.find("2 2 2"), 5, "7 7 7");
  EXPECT_TRUE(contains(refusal_of({write("many.nrrd", map), {}, {}}), "has more than 255 labels"));
}

TEST_F(ReadLabels, WarnsIfAMapReachesBeyondTheScan) {
  GridGeometry half = scan();
  half.dims = {1, 2, 2};
  const LabelsRead read = read_labels({write("m.nrrd", map_of("1 1 1 1 1 1 1 1")), {}, {}}, half);
  ASSERT_EQ(read.warnings.size(), 1u);
  EXPECT_TRUE(contains(read.warnings[0], "50 % of its labelled volume is outside the scan"))
      << read.warnings[0];
}

}  // namespace
}  // namespace osteomill
