#include "osteomill/report/picture_figure.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

struct PictureSize {
  int width;
  int height;
};

// From the header chunk, which stands at the same place in every PNG; the rest is for gnuplot to judge.
PictureSize png_size(const Recording& recording, const RunPicture& picture) {
  constexpr std::array<unsigned char, 8> kSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const std::vector<unsigned char>& png = picture.png;
  const auto number = [&](std::size_t at) {
    return (png[at] << 24) | (png[at + 1] << 16) | (png[at + 2] << 8) | png[at + 3];
  };
  if (png.size() < 24 || !std::equal(kSignature.begin(), kSignature.end(), png.begin())) {
    throw InputError(recording.path.string(), fmt::format("the picture '{}' is not a PNG", picture.name));
  }
  const PictureSize size{number(16), number(20)};
  if (size.width < 1 || size.height < 1 || size.width > 8192 || size.height > 8192) {
    throw InputError(recording.path.string(),
                     fmt::format("the picture '{}' has an impossible size", picture.name));
  }
  return size;
}

struct Panel {
  std::string label;
  const Recording* recording;
  const RunPicture* picture;
};

const RunPicture* picture_named(const Recording& recording, std::string_view name) {
  for (const RunPicture& picture : recording.pictures) {
    if (picture.name == name) return &picture;
  }
  return nullptr;
}

// The runs are ordered with milling first, so the first that has a picture is the one to take.
std::vector<Panel> panels_of(const RunGroup& group) {
  std::vector<Panel> panels;
  for (const MeasuredRun& run : group.runs) {
    if (const RunPicture* before = picture_named(*run.recording, kPictureBefore)) {
      panels.push_back({"Before", run.recording, before});
      break;
    }
  }
  for (const AlgorithmId algorithm : group.algorithms()) {
    for (const RunPhase phase : group.phases()) {
      const MeasuredRun* run = group.find(algorithm, phase);
      const RunPicture* after = run ? picture_named(*run->recording, kPictureAfter) : nullptr;
      if (after == nullptr) continue;
      panels.push_back(
          {fmt::format("After {} ({:.1f} mm³ removed)", numbered_name(algorithm), run->metrics.removed_mm3),
           run->recording, after});
      break;
    }
  }
  return panels;
}

}  // namespace

std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  const std::vector<Panel> panels = panels_of(group);
  if (panels.empty()) return std::nullopt;
  const int columns = panels.size() == 1 ? 1 : 2;
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  const PictureSize first = png_size(*panels[0].recording, *panels[0].picture);
  const int wide = columns == 1 ? 800 : 560;
  const int high = std::clamp(wide * first.height / first.width, 200, 1000) + 40;
  FigureScript script{fmt::format("bone_{}", name_of(group.mode)), columns * wide, rows * high, ""};
  script.body =
      "set multiplot\nunset tics\nunset border\nset size ratio -1\nset lmargin 0.5\nset rmargin 0.5\n"
      "set tmargin 2\nset bmargin 0.3\nset autoscale xfix\nset autoscale yfix\n";
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const PictureSize size = png_size(*panels[n].recording, *panels[n].picture);
    const std::string file = fmt::format("picture{}.png", n);
    const std::vector<unsigned char>& png = panels[n].picture->png;
    write_figure_data(work / file, {reinterpret_cast<const char*>(png.data()), png.size()});
    // Large pictures would make the SVG, which holds them whole, too large.
    const int every = std::max(1, size.width / 640);
    const int column = static_cast<int>(n) % columns;
    const int row = static_cast<int>(n) / columns;
    script.body += fmt::format(
        "set origin {:.4f},{:.4f}\nset size {:.4f},{:.4f}\nset title {} offset 0,-0.5 noenhanced\n"
        "plot '{}' binary filetype=png every {}:{} with rgbimage notitle\n",
        static_cast<double>(column) / columns, 1.0 - (row + 1.0) / rows, 1.0 / columns, 1.0 / rows,
        gnuplot_quoted(panels[n].label), file, every, every);
  }
  script.body += "unset multiplot\n";
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
