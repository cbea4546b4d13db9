#include "osteomill/visual/annotations.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <utility>

#include <imgui.h>

#include "osteomill/base/round_numbers.h"

namespace osteomill {

namespace {

constexpr double kMargin_px = 24;
constexpr double kTick_px = 5;
// Half the width of the longest text.
constexpr double kTextReach_px = 84;
constexpr double kAxis_px = 30;
constexpr double kLetter_px = 44;
constexpr double kMinAxis = 0.25;

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

// Glyphs of one size, rasterized by ImGui without a window.
class Letters {
 public:
  explicit Letters(float size_px) {
    // ImGui decompresses its built-in font in memory shared by all threads.
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

Annotation scale_bar_annotation(const Camera& camera, const PixelSize& size) {
  const double pixel_mm = mm_per_pixel(camera, size, camera.distance_mm);
  const double length_mm = round_down(0.25 * size.width * pixel_mm);
  const Eigen::Vector2d left(kMargin_px, size.height - kMargin_px);
  const Eigen::Vector2d right = left + Eigen::Vector2d(length_mm / pixel_mm, 0);
  const Eigen::Vector2d tick(0, kTick_px);
  std::array<char, 32> text{};
  // Field of view above which lengths change noticeably (more than a few per cent) with depth.
  constexpr double kWide_rad = 0.1;
  const char* const where = camera.field_of_view_rad > kWide_rad ? " at the centre" : "";
  std::snprintf(text.data(), text.size(), "%g mm%s", length_mm, where);
  Eigen::Vector2d place = 0.5 * (left + right) - Eigen::Vector2d(0, 14);
  place.x() = std::max(place.x(), kTextReach_px);
  return {{{left, right}, {left - tick, left + tick}, {right - tick, right + tick}}, place, text.data()};
}

std::vector<Annotation> orientation_letters(const Camera& camera, const PixelSize& size) {
  const std::pair<const char*, Vec3> axes[] = {{"L", Vec3::UnitX()}, {"R", -Vec3::UnitX()},
                                               {"P", Vec3::UnitY()}, {"A", -Vec3::UnitY()},
                                               {"S", Vec3::UnitZ()}, {"I", -Vec3::UnitZ()}};
  const Eigen::Vector2d middle(size.width - kMargin_px - kLetter_px, size.height - kMargin_px - kLetter_px);
  std::vector<Annotation> letters;
  for (const auto& [name, axis_W] : axes) {
    const Eigen::Vector2d seen(axis_W.dot(camera.right_W()), -axis_W.dot(camera.up_W()));
    if (seen.norm() < kMinAxis) continue;
    letters.push_back({{{middle, middle + kAxis_px * seen}}, middle + kLetter_px * seen, name});
  }
  return letters;
}

void draw_annotation(Image& image, const Annotation& annotation, const Ink& ink, double scale) {
  std::vector<Annotation::Line> lines = annotation.lines;
  for (Annotation::Line& line : lines) line = {scale * line.from, scale * line.to};
  for (const Annotation::Line& line : lines) draw_line(image, line, 4 * scale, ink.edge);
  for (const Annotation::Line& line : lines) draw_line(image, line, 2 * scale, ink.level);
  const Letters letters(static_cast<float>(scale) * kFontSize_px);
  const Vector2d pen = scale * annotation.text_centre_px - 0.5 * letters.size_of(annotation.text);
  for (const Vector2d& aside : {Vector2d(1, 1), Vector2d(-1, 1), Vector2d(1, -1), Vector2d(-1, -1)}) {
    letters.draw(image, annotation.text, pen + scale * aside, ink.edge);
  }
  letters.draw(image, annotation.text, pen, ink.level);
}

void annotate(Image& image, const Camera& camera, bool of_patient, const Ink& ink, double scale) {
  const PixelSize size{static_cast<int>(image.width / scale), static_cast<int>(image.height / scale)};
  draw_annotation(image, scale_bar_annotation(camera, size), ink, scale);
  if (!of_patient) return;
  for (const Annotation& letter : orientation_letters(camera, size))
    draw_annotation(image, letter, ink, scale);
}

}  // namespace osteomill
