#include "osteomill/view/image_annotations.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>

#include <imgui.h>

namespace osteomill {

namespace {

using Eigen::Vector2d;

void blend(Image& image, int x, int y, unsigned char level, double coverage) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  unsigned char* pixel = image.pixel(x, y);
  for (int channel = 0; channel < 3; ++channel) {
    pixel[channel] =
        static_cast<unsigned char>(std::lround(pixel[channel] + coverage * (level - pixel[channel])));
  }
}

double distance_px(const Annotation::Line& line, const Vector2d& point) {
  const Vector2d along = line.to - line.from;
  const double share = (point - line.from).dot(along) / std::max(along.squaredNorm(), 1e-12);
  return (point - line.from - std::clamp(share, 0.0, 1.0) * along).norm();
}

void draw_line(Image& image, const Annotation::Line& line, double width_px, unsigned char level) {
  const double reach = 0.5 * width_px + 1;
  const Vector2d first = (line.from.cwiseMin(line.to).array() - reach).max(0.0);
  const Vector2d last =
      (line.from.cwiseMax(line.to).array() + reach).matrix().cwiseMin(Vector2d(image.width, image.height));
  for (int y = static_cast<int>(first.y()); y < last.y(); ++y) {
    for (int x = static_cast<int>(first.x()); x < last.x(); ++x) {
      const double outside = distance_px(line, {x + 0.5, y + 0.5}) - 0.5 * width_px;
      blend(image, x, y, level, std::clamp(0.5 - outside, 0.0, 1.0));
    }
  }
}

// The letters of one size, as ImGui draws them for its windows, but without a window.
class Letters {
 public:
  explicit Letters(float size_px) {
    // ImGui unpacks the font that comes with it in memory that all threads share.
    static std::mutex mutex;
    const std::scoped_lock lock(mutex);
    ImFontConfig config;
    config.SizePixels = size_px;
    config.OversampleH = config.OversampleV = 1;
    config.PixelSnapH = true;
    font_ =
        std::filesystem::exists(kFontFile) ? atlas_.AddFontFromFileTTF(kFontFile, size_px, &config) : nullptr;
    if (font_ == nullptr) font_ = atlas_.AddFontDefault(&config);
    atlas_.GetTexDataAsAlpha8(&coverages_, &width_, &height_);
  }

  Vector2d size_of(const std::string& text) const {
    double width = 0;
    for (const char letter : text) width += static_cast<double>(glyph(letter).AdvanceX);
    return {width, static_cast<double>(font_->FontSize)};
  }

  void draw(Image& image, const std::string& text, Vector2d pen, unsigned char level) const {
    for (const char letter : text) {
      const ImFontGlyph& g = glyph(letter);
      const auto column = std::lround(g.U0 * static_cast<float>(width_));
      const auto row = std::lround(g.V0 * static_cast<float>(height_));
      const int left = static_cast<int>(std::lround(pen.x() + static_cast<double>(g.X0)));
      const int top = static_cast<int>(std::lround(pen.y() + static_cast<double>(g.Y0)));
      for (int y = 0; y < static_cast<int>(g.Y1 - g.Y0); ++y) {
        for (int x = 0; x < static_cast<int>(g.X1 - g.X0); ++x) {
          blend(image, left + x, top + y, level, coverages_[(row + y) * width_ + column + x] / 255.0);
        }
      }
      pen.x() += static_cast<double>(g.AdvanceX);
    }
  }

 private:
  const ImFontGlyph& glyph(char letter) const {
    return *font_->FindGlyph(static_cast<unsigned char>(letter));
  }

  ImFontAtlas atlas_;
  ImFont* font_ = nullptr;
  unsigned char* coverages_ = nullptr;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace

void draw_annotation(Image& image, const Annotation& annotation, const Ink& ink, double scale) {
  std::vector<Annotation::Line> lines = annotation.lines;
  for (Annotation::Line& line : lines) line = {scale * line.from, scale * line.to};
  for (const Annotation::Line& line : lines) draw_line(image, line, 4 * scale, ink.edge);
  for (const Annotation::Line& line : lines) draw_line(image, line, 2 * scale, ink.level);
  const Letters letters(static_cast<float>(scale) * kFontSize_px);
  const Vector2d pen = scale * annotation.place - 0.5 * letters.size_of(annotation.text);
  for (const Vector2d& aside : {Vector2d(1, 1), Vector2d(-1, 1), Vector2d(1, -1), Vector2d(-1, -1)}) {
    letters.draw(image, annotation.text, pen + scale * aside, ink.edge);
  }
  letters.draw(image, annotation.text, pen, ink.level);
}

}  // namespace osteomill
