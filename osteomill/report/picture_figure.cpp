#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"
#include "osteomill/image/image.h"
#include "osteomill/report/figure.h"
#include "osteomill/report/run_figures.h"

namespace osteomill {

namespace {

// As wide as a panel of two columns, so that the SVG, which holds the pictures, stays small.
constexpr int kPanelWidth_px = 560;

Image shrunk(const Recording& recording, const RunPicture& picture) {
  const std::optional<Image> image = decode_png(picture.png);
  if (!image) {
    throw InputError(recording.path.string(),
                     fmt::format("the picture '{}' is not a whole PNG of sensible size", picture.name));
  }
  const int factor = (image->width + kPanelWidth_px - 1) / kPanelWidth_px;
  // A picture flatter than the factor would vanish.
  return averaged_down(*image, std::min(factor, image->height));
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

// Of several phases the first that has a picture is the one to take.
std::vector<Panel> panels_of(const RunGroup& group) {
  std::vector<Panel> panels, along_the_entry;
  for (const MeasuredRun& run : group.runs) {
    if (const RunPicture* before = picture_named(*run.recording, kPictureBefore)) {
      panels.push_back({"Before", run.recording, before});
      break;
    }
  }
  for (const AlgorithmId& algorithm : group.algorithms()) {
    for (const std::string& phase : group.phases()) {
      const MeasuredRun* run = group.find(algorithm.name, phase);
      const RunPicture* after = run ? picture_named(*run->recording, kPictureAfter) : nullptr;
      if (after == nullptr) continue;
      // The last part of several: cuts may have been taken back since the picture before.
      const bool whole = picture_named(*run->recording, kPictureBefore) != nullptr;
      panels.push_back(
          {whole ? fmt::format("After {} ({:.1f} mm³ removed)", algorithm.label, run->metrics.removed_mm3)
                 : std::string("At the end"),
           run->recording, after});
      if (const RunPicture* along = picture_named(*run->recording, kPictureAlong))
        along_the_entry.push_back(
            {fmt::format("{}, seen along the entry", algorithm.label), run->recording, along});
      break;
    }
  }
  panels.insert(panels.end(), along_the_entry.begin(), along_the_entry.end());
  return panels;
}

}  // namespace

std::optional<Figure> draw_picture_figure(const RunGroup& group, const std::filesystem::path& folder) {
  const TemporaryFolder work;
  const std::vector<Panel> panels = panels_of(group);
  if (panels.empty()) return std::nullopt;
  const int columns = panels.size() == 1 ? 1 : 2;
  const int rows = (static_cast<int>(panels.size()) + columns - 1) / columns;
  std::vector<Image> pictures;
  for (const Panel& panel : panels) pictures.push_back(shrunk(*panel.recording, *panel.picture));
  const int wide = columns == 1 ? 800 : kPanelWidth_px;
  const int high = std::clamp(wide * pictures[0].height / pictures[0].width, 200, 1000) + 40;
  FigureScript script{fmt::format("bone_{}", name_of(group.mode)), static_cast<double>(rows) * high,
                      static_cast<double>(columns) * wide};
  script.body =
      "set multiplot\nunset tics\nunset border\nset size ratio -1\nset lmargin 0.5\nset rmargin 0.5\n"
      "set tmargin 2\nset bmargin 0.3\nset autoscale xfix\nset autoscale yfix\n";
  for (std::size_t n = 0; n < panels.size(); ++n) {
    const std::string file = fmt::format("picture{}.png", n);
    const std::vector<unsigned char>& png = encode_png(pictures[n]);
    write_figure_data(work / file, {reinterpret_cast<const char*>(png.data()), png.size()});
    const int column = static_cast<int>(n) % columns;
    const int row = static_cast<int>(n) / columns;
    script.body += fmt::format(
        "set origin {:.4f},{:.4f}\nset size {:.4f},{:.4f}\nset title {} offset 0,-0.5 noenhanced\n"
        "plot '{}' binary filetype=png with rgbimage notitle\n",
        static_cast<double>(column) / columns, 1.0 - (row + 1.0) / rows, 1.0 / columns, 1.0 / rows,
        gnuplot_quoted(panels[n].label), file);
  }
  return draw_figure(script, work, folder);
}

}  // namespace osteomill
