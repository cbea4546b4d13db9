#include "view/bone_ground.h"

#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

namespace osteomill {

namespace {

constexpr std::string_view kCutVertex = R"(#version 330 core
layout(location = 0) in vec3 position_W;
layout(location = 1) in vec2 place_on_cut;
uniform mat4 camera_from_world;
uniform mat4 clip_from_camera;
uniform vec4 cuts[4];
out float gl_ClipDistance[4];
out vec2 place;
void main() {
  gl_Position = clip_from_camera * (camera_from_world * vec4(position_W, 1.0));
  place = place_on_cut;
  for (int n = 0; n < 4; ++n) gl_ClipDistance[n] = dot(cuts[n].xyz, position_W) - cuts[n].w;
}
)";

// Draws grey values or label colours; pixels as dark as air are transparent.
constexpr std::string_view kCutFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D pixels;
out vec4 colour;
void main() {
  colour = vec4(texture(pixels, place).rgb, 1.0);
  if (max(colour.r, max(colour.g, colour.b)) < 0.14) discard;
}
)";

constexpr std::string_view kBackgroundFragment = R"(#version 330 core
in vec2 place;
out vec4 colour;
void main() {
  colour = vec4(mix(vec3(0.075, 0.085, 0.105), vec3(0.20, 0.23, 0.28), place.y), 1.0);
}
)";

using Clock = std::chrono::steady_clock;

// At rest the depths are read only once in this number of frames: reading stalls a software renderer, and
// milling changes the depths little.
constexpr unsigned kPicturesPerBlur = 4;
constexpr double kMaxCell_px = 64;
constexpr int kMaxCoarseness = 4;

std::size_t pixels_of(const PixelSize& size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Returns whether the bone looks the same in both scenes.
bool same_view(const ViewScene& a, const ViewScene& b) {
  return a.camera == b.camera && a.bounds == b.bounds && a.isovalue == b.isovalue &&
         a.reference_density == b.reference_density && a.light_from_below == b.light_from_below &&
         a.show_labels == b.show_labels && a.cuts == b.cuts;
}

void clear_depths(const FrameTarget& target) {
  target.bind();
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
}

}  // namespace

ClipFaces::ClipFaces() : program_(gl::make_program(kCutVertex, kCutFragment)) {
  for (Face& face : faces_) {
    face.vertex_array = gl::VertexArray::make();
    face.corners = gl::Buffer::make();
  }
}

void ClipFaces::set(std::size_t cut, const ClipFace& face) {
  Face& kept = faces_.at(cut);
  if (face.pixels.empty()) {
    kept.pixels = {};
    return;
  }
  kept.pixels = gl::make_texture(GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, face.width, face.height, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, face.width, face.height, GL_RGB, GL_UNSIGNED_BYTE,
                  face.pixels.data());
  // Draw the face as a fan; the outermost pixel centres lie half a pixel inside the texture.
  const float u = 0.5f / static_cast<float>(face.width);
  const float v = 0.5f / static_cast<float>(face.height);
  const float places[4][2] = {{u, v}, {1 - u, v}, {1 - u, 1 - v}, {u, 1 - v}};
  std::array<std::array<float, 5>, 4> corners;
  for (std::size_t n = 0; n < 4; ++n) {
    const Eigen::Vector3f corner = face.corners_W[n].cast<float>();
    corners[n] = {corner.x(), corner.y(), corner.z(), places[n][0], places[n][1]};
  }
  glBindVertexArray(kept.vertex_array.get());
  gl::fill<std::array<float, 5>>(GL_ARRAY_BUFFER, kept.corners, corners, GL_DYNAMIC_DRAW);
  gl::set_attribute(0, 3, sizeof(corners[0]), 0);
  gl::set_attribute(1, 2, sizeof(corners[0]), 3 * sizeof(float));
}

void ClipFaces::draw(const ViewScene& scene, const Projection& projection) const {
  const GLuint program = program_.get();
  glUseProgram(program);
  set_projection(program, projection);
  glActiveTexture(GL_TEXTURE0);
  for (std::size_t n = 0; n < kMaxClipPlanes; ++n) {
    if (!scene.cuts[n] || faces_[n].pixels.get() == 0) continue;
    ViewScene others = scene;
    others.cuts[n].reset();
    begin_cuts(program, others);
    glBindTexture(GL_TEXTURE_2D, faces_[n].pixels.get());
    glBindVertexArray(faces_[n].vertex_array.get());
    glDrawArrays(GL_TRIANGLE_FAN, 0, 4);
    end_cuts();
  }
}

BoneGround::BoneGround(const SurfaceBricks& layout, const GridGeometry& geometry,
                       std::shared_ptr<const LabelMap> labels)
    : bone_(layout, geometry, std::move(labels)), background_(kBackgroundFragment) {}

void BoneGround::set_brick(std::size_t brick, const BrickLevels& levels) {
  bone_.set_brick(brick, levels);
  changed_.insert(brick);
  changed_while_refining_.insert(brick);
}

void BoneGround::set_clip_face(std::size_t cut, const ClipFace& face) {
  cut_faces_.set(cut, face);
  scene_.reset();
}

void BoneGround::fit(const PixelSize& size) {
  if (resting_ && resting_->size() == size) return;
  resting_.emplace(size);
  cavities_.emplace(size);
  drawn_ = 0;
  scene_.reset();
}

void BoneGround::draw(const ViewScene& scene, const PixelSize& size) {
  fit(size);
  const bool same = scene_ && same_view(*scene_, scene);
  if (same && draw_changed(scene, projection_of(scene, shown_->size()))) {
    if (!settled_) refine(scene, projection_of(scene, size));
  } else {
    draw_at_once(scene, size_within_budget(size));
  }
  scene_ = scene;
  ++drawn_;
}

void BoneGround::draw_inset(const ViewScene& scene, const PixelSize& size) {
  if (!inset_ || inset_->picture.size() != size) inset_.emplace(size);
  const Projection projection = projection_of(scene, size);
  Detail detail = kFullDetail;
  std::vector<VisibleBrick> visible = bone_.visible_bricks(scene, projection, detail);
  while (detail.cell_px < kMaxCell_px && bone_.triangle_count(visible) > triangles_.budget() / 2) {
    detail.cell_px *= std::numbers::sqrt2;
    bone_.choose_levels(visible, detail);
  }
  clear_depths(inset_->picture);
  bone_.draw(scene, projection, inset_->cavities, visible);
  draw_surroundings(scene, projection);
  inset_->cavities.blur(inset_->picture.depths(), projection.near_mm, projection.far_mm);
}

// Returns the largest size within the pixel budget. As for triangles, increases only if that leaves a
// reserve.
PixelSize BoneGround::size_within_budget(const PixelSize& size) {
  const auto coarse = [&](int n) { return PixelSize{(size.width + n - 1) / n, (size.height + n - 1) / n}; };
  const auto budget = static_cast<double>(pixels_.budget());
  int n = 1;
  for (; n < kMaxCoarseness && pixels_of(coarse(n + 1)) >= pixels_.min_count(); ++n) {
    const auto count = static_cast<double>(pixels_of(coarse(n)));
    if (count <= (n < coarseness_ ? 0.75 : 1.0) * budget) break;
  }
  coarseness_ = n;
  return coarse(n);
}

void BoneGround::draw_at_once(const ViewScene& scene, const PixelSize& size) {
  const auto start = Clock::now();
  if (!moving_ || moving_->size() != size) moving_.emplace(size);
  shown_ = &*moving_;
  const Projection projection = projection_of(scene, size);
  const std::vector<VisibleBrick> visible = visible_in_budget(scene, projection);
  clear_depths(*shown_);
  bone_.draw(scene, projection, *cavities_, visible);
  draw_surroundings(scene, projection);
  update_cavities(projection);
  // Otherwise drawing would continue after its time was measured.
  glFinish();
  const double passed_s = seconds_since(start);
  triangles_.record_draw(bone_.triangle_count(visible), passed_s);
  pixels_.record_draw(pixels_of(size), passed_s);
  settled_ = refining_ = false;
  changed_.clear();
  bricks_to_reshade_.clear();
}

// Returns the visible bricks at the finest detail within the budget. Detail increases only if that leaves a
// reserve, so that it does not oscillate.
std::vector<VisibleBrick> BoneGround::visible_in_budget(const ViewScene& scene,
                                                        const Projection& projection) {
  Detail detail = kFullDetail;
  if (scene.X_WT) detail.sharp = Sphere{scene.X_WT->position_mm, 2 * scene.tool.burr_radius_mm};
  std::vector<VisibleBrick> visible = bone_.visible_bricks(scene, projection, detail);
  const auto budget = static_cast<double>(triangles_.budget());
  while (detail.cell_px < kMaxCell_px) {
    const auto count = static_cast<double>(bone_.triangle_count(visible));
    if (count <= (detail.cell_px < cell_px_ ? 0.75 : 1.0) * budget) break;
    detail.cell_px *= std::numbers::sqrt2;
    bone_.choose_levels(visible, detail);
  }
  cell_px_ = detail.cell_px;
  return visible;
}

void BoneGround::begin_refining(const ViewScene& scene, const Projection& projection) {
  update_cavities(projection);
  to_refine_ = bone_.visible_bricks(scene, projection, kFullDetail);
  refined_ = 0;
  refining_ = true;
  changed_while_refining_.clear();
  clear_depths(*resting_);
}

// Refines the nearest bricks first, as many as the time budget allows.
void BoneGround::refine(const ViewScene& scene, const Projection& projection) {
  if (!refining_) begin_refining(scene, projection);
  const auto start = Clock::now();
  resting_->bind();
  glEnable(GL_DEPTH_TEST);
  std::optional<DepthTiles> before;
  if (refined_ > 0) before.emplace(*resting_, projection, scene.camera);
  std::vector<VisibleBrick> slice;
  std::size_t triangles = 0;
  for (; refined_ < to_refine_.size() && triangles < triangles_.budget(); ++refined_) {
    const VisibleBrick& visible = to_refine_[refined_];
    if (before && before->is_hidden(bone_.bounds(visible.brick))) continue;
    slice.push_back(visible);
    triangles += bone_.triangle_count({&visible, 1});
  }
  resting_->bind();
  bone_.draw(scene, projection, *cavities_, slice);
  if (refined_ == to_refine_.size()) {
    draw_surroundings(scene, projection);
    shown_ = &*resting_;
    settled_ = true;
    refining_ = false;
    changed_ = std::exchange(changed_while_refining_, {});
  }
  glFinish();
  triangles_.record_draw(triangles, seconds_since(start));
}

// Redraws the part of the picture in which bone changed, and once more when changes have ended, because
// cavity darkening uses the previous frame. Returns false if that would take too long.
bool BoneGround::draw_changed(const ViewScene& scene, const Projection& projection) {
  const bool last = changed_.empty();
  if (last && bricks_to_reshade_.empty()) return true;
  const auto start = Clock::now();
  if (last || drawn_ % kPicturesPerBlur == 0) update_cavities(projection);
  bricks_to_reshade_.insert(changed_.begin(), changed_.end());
  const Eigen::AlignedBox2i part = changed_part(last ? bricks_to_reshade_ : changed_, scene, projection);
  const Eigen::AlignedBox2d box = part.cast<double>();
  std::vector<VisibleBrick> visible = bone_.visible_bricks(scene, projection, kFullDetail);
  std::erase_if(visible, [&](const VisibleBrick& brick) {
    return !box.intersects(projected_bounds(scene, projection, bone_.bounds(brick.brick)));
  });
  const std::size_t triangles = bone_.triangle_count(visible);
  if (triangles > triangles_.budget()) return false;
  glEnable(GL_SCISSOR_TEST);
  glScissor(part.min().x(), part.min().y(), part.sizes().x(), part.sizes().y());
  clear_depths(*shown_);
  bone_.draw(scene, projection, *cavities_, visible);
  draw_surroundings(scene, projection);
  glDisable(GL_SCISSOR_TEST);
  glFinish();
  triangles_.record_draw(triangles, seconds_since(start));
  changed_.clear();
  if (last) bricks_to_reshade_.clear();
  return true;
}

Eigen::AlignedBox2i BoneGround::changed_part(const std::set<std::size_t>& bricks, const ViewScene& scene,
                                             const Projection& projection) const {
  Eigen::AlignedBox2d box;
  for (const std::size_t brick : bricks) box.extend(projected_bounds(scene, projection, bone_.bounds(brick)));
  // Removed bone also changes the darkening around it.
  const double more_px = cavities_->reach_px(projection.size);
  const Eigen::Array2d all(projection.size.width, projection.size.height);
  const Eigen::Array2d first = (box.min().array() - more_px).floor().max(0.0).min(all);
  const Eigen::Array2d last = (box.max().array() + more_px).ceil().min(all).max(first);
  return {first.cast<int>().matrix(), last.cast<int>().matrix()};
}

void BoneGround::update_cavities(const Projection& projection) {
  cavities_->blur(shown_->depths(), projection.near_mm, projection.far_mm);
}

// Draws into the bound framebuffer.
void BoneGround::draw_surroundings(const ViewScene& scene, const Projection& projection) {
  glDepthFunc(GL_LEQUAL);
  background_.draw();
  glDepthFunc(GL_LESS);
  cut_faces_.draw(scene, projection);
}

}  // namespace osteomill
