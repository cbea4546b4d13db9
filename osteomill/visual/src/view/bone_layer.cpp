#include "view/bone_layer.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>
#include <string>
#include <utility>

namespace osteomill {

namespace {

constexpr std::string_view kBoneVertex = R"(
layout(location = 0) in vec3 position_W;
layout(location = 1) in vec3 normal_W;
layout(location = 2) in float density;
layout(location = 3) in vec4 label;
uniform mat4 camera_from_world;
uniform mat4 clip_from_camera;
#ifdef CUT
uniform vec4 cuts[4];
out float gl_ClipDistance[4];
#endif
out vec3 normal_C;
out float depth_mm;
out float bone_density;
out vec4 label_colour;
void main() {
  vec4 position_C = camera_from_world * vec4(position_W, 1.0);
  gl_Position = clip_from_camera * position_C;
  normal_C = mat3(camera_from_world) * normal_W;
  depth_mm = -position_C.z;
  bone_density = density;
  label_colour = vec4(label.rgb * label.a, label.a);
#ifdef CUT
  for (int n = 0; n < 4; ++n) gl_ClipDistance[n] = dot(cuts[n].xyz, position_W) - cuts[n].w;
#endif
}
)";

// Key light over the viewer's left shoulder, weaker fill light from the right, and ambient light with another
// colour from below. Bone that lies deeper than its surroundings in the previous frame (blurred_depth) gets
// less of all of them.
constexpr std::string_view kBoneFragment = R"(#version 330 core
in vec3 normal_C;
in float depth_mm;
in float bone_density;
in vec4 label_colour;  // premultiplied by its opacity
uniform float label_share;
uniform float isovalue;
uniform float reference_density;
uniform vec2 picture_size;
uniform vec3 light_from_below;
uniform float cavity_scale;  // 1 / mm, at a depth of 1 mm
uniform sampler2D blurred_depth;
out vec4 colour;
const vec3 kSoft = vec3(0.76, 0.52, 0.40);
const vec3 kBone = vec3(0.87, 0.76, 0.58);
const vec3 kEnamel = vec3(0.93, 0.91, 0.86);
const vec3 kTowardsKey = vec3(-0.4504, 0.6005, 0.6606);
const vec3 kTowardsFill = vec3(0.8053, -0.0537, 0.5905);
const vec3 kHalfWay = vec3(-0.2471, 0.3295, 0.9113);
void main() {
  vec3 n = normalize(normal_C);
  float share = (bone_density - isovalue) / max(reference_density - isovalue, 1e-6);
  vec3 base = share < 1.0 ? mix(kSoft, kBone, smoothstep(0.05, 0.85, share))
                          : mix(kBone, kEnamel, smoothstep(1.05, 2.1, share));
  base = (1.0 - label_share * label_colour.a) * base + label_share * label_colour.rgb;
  if (!gl_FrontFacing) {
    colour = vec4(0.42 * base, 1.0);
    return;
  }
  vec2 around = texture(blurred_depth, gl_FragCoord.xy / picture_size).rg;
  float sunk = around.g > 0.05 ? (depth_mm - around.r / around.g) * cavity_scale / depth_mm : 0.0;
  // Near its outline all bone lies deeper than the blurred middle: that is not a cavity.
  sunk *= smoothstep(0.3, 0.8, n.z);
  float open = 1.0 - 0.5 * smoothstep(0.0, 1.0, sunk) + 0.06 * smoothstep(0.0, 1.0, -sunk);
  float key = max(dot(n, kTowardsKey), 0.0);
  float fill = max(dot(n, kTowardsFill), 0.0);
  vec3 ambient = mix(light_from_below, vec3(0.33, 0.35, 0.39), 0.5 + 0.5 * n.y);
  float gloss = max(dot(n, kHalfWay), 0.0);
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= 0.10 * gloss;
  vec3 light = ambient + 0.62 * key * vec3(1.0, 0.98, 0.94) + 0.22 * fill * vec3(0.88, 0.93, 1.0);
  colour = vec4((base * light + gloss) * open, 1.0);
}
)";

// Leaves room for the tool around the bone.
constexpr double kSceneMargin_mm = 60;
constexpr double kMinDepth_mm = 1;
// Depth, as a fraction of the blur radius, at which darkening saturates.
constexpr double kDarkestAt = 0.55;

// Frustum planes (n, d) with unit normals; the inside is n . p + d >= 0.
std::array<Eigen::Vector4d, 6> view_planes(const Projection& projection) {
  const Eigen::Matrix4d clip = (projection.clip_from_camera * projection.camera_from_world).cast<double>();
  std::array<Eigen::Vector4d, 6> planes;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      Eigen::Vector4d plane = clip.row(3) + (side == 0 ? 1 : -1) * clip.row(axis);
      plane /= plane.head<3>().norm();
      planes[static_cast<std::size_t>(2 * axis + side)] = plane;
    }
  }
  return planes;
}

bool can_be_visible(const std::array<Eigen::Vector4d, 6>& planes, const Sphere& sphere) {
  return std::all_of(planes.begin(), planes.end(), [&](const Eigen::Vector4d& plane) {
    return plane.head<3>().dot(sphere.centre_W) + plane.w() >= -sphere.radius_mm;
  });
}

// Red, green, blue, and 255 with a label or 0 without.
using LabelColour = std::array<std::uint8_t, 4>;

LabelColour label_colour_below(const LabelMap& labels, const MeshVertex& vertex) {
  const LabelMap::LabelIndex place =
      labels.under_surface(vec3_of(vertex.position_mm), vec3_of(vertex.normal));
  if (place == 0) return {};
  const auto& [red, green, blue] = labels.label(place).colour;
  return {red, green, blue, 255};
}

NormalCone facing_of(const BrickLevels& brick) {
  std::vector<Vec3> normals;
  normals.reserve(brick.levels[0].count / 3);
  Vec3 sum = Vec3::Zero();
  const auto corner = [&](std::size_t n) { return vec3_of(brick.vertices[brick.indices[n]].position_mm); };
  for (std::size_t n = 0; n < brick.levels[0].count; n += 3) {
    const Vec3 normal = (corner(n + 1) - corner(n)).cross(corner(n + 2) - corner(n));
    if (!(normal.norm() > 0)) continue;
    normals.push_back(normal.normalized());
    sum += normals.back();
  }
  if (!(sum.norm() > 0)) return {};
  const Vec3 axis = sum.normalized();
  double min = 1;
  for (const Vec3& normal : normals) min = std::min(min, axis.dot(normal));
  return {axis, std::acos(std::clamp(min, -1.0, 1.0))};
}

gl::Program bone_program(const char* definitions) {
  const std::string vertex = std::string("#version 330 core\n") + definitions + std::string(kBoneVertex);
  return gl::make_program(vertex, kBoneFragment);
}

void set_uniforms(GLuint program, const ViewScene& scene, const Projection& projection, double reach_px) {
  set_projection(program, projection);
  const auto place = [&](const char* name) { return glGetUniformLocation(program, name); };
  glUniform1f(place("isovalue"), static_cast<float>(scene.isovalue));
  glUniform1f(place("reference_density"), static_cast<float>(scene.reference_density));
  constexpr float kLabelShare = 0.8f;
  glUniform1f(place("label_share"), scene.show_labels ? kLabelShare : 0.0f);
  glUniform3fv(place("light_from_below"), 1, scene.light_from_below.data());
  glUniform2f(place("picture_size"), static_cast<float>(projection.size.width),
              static_cast<float>(projection.size.height));
  const double reach_mm = reach_px * mm_per_pixel(scene.camera, projection.size, 1.0);
  glUniform1f(place("cavity_scale"), static_cast<float>(1 / (kDarkestAt * reach_mm)));
}

bool is_cut(const ViewScene& scene) {
  return std::any_of(scene.cuts.begin(), scene.cuts.end(), [](const auto& cut) { return cut.has_value(); });
}

}  // namespace

Projection projection_of(const ViewScene& scene, const PixelSize& size) {
  Projection projection{size, 0, 0, view_matrix(scene.camera), {}};
  const double depth_mm = depth_of(scene.camera, scene.bounds.centre_W);
  const double reach_mm = scene.bounds.radius_mm + kSceneMargin_mm;
  projection.near_mm = std::max(depth_mm - reach_mm, kMinDepth_mm);
  projection.far_mm = std::max(depth_mm + reach_mm, projection.near_mm + reach_mm);
  projection.clip_from_camera = projection_matrix(scene.camera, size, projection.near_mm, projection.far_mm);
  return projection;
}

void set_projection(GLuint program, const Projection& projection) {
  glUniformMatrix4fv(glGetUniformLocation(program, "camera_from_world"), 1, GL_FALSE,
                     projection.camera_from_world.data());
  glUniformMatrix4fv(glGetUniformLocation(program, "clip_from_camera"), 1, GL_FALSE,
                     projection.clip_from_camera.data());
}

Sphere bounding_sphere(const GridGeometry& geometry, const VoxelBox& cells) {
  const Vec3 first(cells.first.i, cells.first.j, cells.first.k);
  const Vec3 last(cells.last.i + 1, cells.last.j + 1, cells.last.k + 1);
  return {geometry.world_from_voxel(Vec3(0.5 * (first + last))),
          0.5 * geometry.spacing_mm.cwiseProduct(last - first).norm()};
}

Eigen::AlignedBox2d projected_bounds(const ViewScene& scene, const Projection& projection,
                                     const Sphere& sphere) {
  const double front_mm = depth_of(scene.camera, sphere.centre_W) - sphere.radius_mm;
  const Eigen::Vector2d all(projection.size.width, projection.size.height);
  if (front_mm < projection.near_mm) return {Eigen::Vector2d::Zero(), all};
  Eigen::Vector2d middle = pixel_of(scene.camera, projection.size, sphere.centre_W);
  middle.y() = projection.size.height - middle.y();
  // Perspective elongates a sphere away from the picture's centre.
  const double aside = (middle - 0.5 * all).norm() * mm_per_pixel(scene.camera, projection.size, 1.0);
  const double reach_px =
      std::hypot(1.0, aside) * sphere.radius_mm / mm_per_pixel(scene.camera, projection.size, front_mm);
  return {middle.array() - reach_px, middle.array() + reach_px};
}

DepthTiles::DepthTiles(const FrameTarget& target, const Projection& projection, const Camera& camera)
    : projection_(projection),
      camera_(camera),
      columns_((projection.size.width + kTile_px - 1) / kTile_px),
      rows_((projection.size.height + kTile_px - 1) / kTile_px),
      depths_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.0f) {
  const PixelSize& size = projection.size;
  const std::vector<float> drawn = target.read_depths();
  auto depth = drawn.begin();
  for (int y = size.height - 1; y >= 0; --y) {
    for (int x = 0; x < size.width; ++x, ++depth) {
      float& tile = depths_[static_cast<std::size_t>(x / kTile_px + columns_ * (y / kTile_px))];
      tile = std::max(tile, *depth);
    }
  }
}

bool DepthTiles::is_hidden(const Sphere& sphere) const {
  const double front_mm = depth_of(camera_, sphere.centre_W) - sphere.radius_mm;
  if (front_mm <= projection_.near_mm) return false;
  const auto front = static_cast<float>(projection_.far_mm * (front_mm - projection_.near_mm) /
                                        (front_mm * (projection_.far_mm - projection_.near_mm)));
  const Eigen::Vector2d middle = pixel_of(camera_, projection_.size, sphere.centre_W);
  const double reach_px = sphere.radius_mm / mm_per_pixel(camera_, projection_.size, front_mm) + 1;
  const auto tile = [](double pixel, int count) {
    return static_cast<int>(std::clamp(pixel / kTile_px, 0.0, count - 1.0));
  };
  for (int row = tile(middle.y() - reach_px, rows_); row <= tile(middle.y() + reach_px, rows_); ++row) {
    for (int column = tile(middle.x() - reach_px, columns_); column <= tile(middle.x() + reach_px, columns_);
         ++column) {
      if (depths_[static_cast<std::size_t>(column + columns_ * row)] >= front) return false;
    }
  }
  return true;
}

void begin_cuts(GLuint program, const ViewScene& scene) {
  // A disabled cut clips nothing: 0 . p >= -1.
  std::array<std::array<float, 4>, kMaxClipPlanes> cuts;
  for (std::size_t n = 0; n < kMaxClipPlanes; ++n) {
    cuts[n] = {0, 0, 0, -1};
    if (!scene.cuts[n]) continue;
    const Eigen::Vector3f normal = scene.cuts[n]->normal_W.cast<float>();
    cuts[n] = {normal.x(), normal.y(), normal.z(), static_cast<float>(scene.cuts[n]->offset_mm)};
    glEnable(static_cast<GLenum>(GL_CLIP_DISTANCE0 + n));
  }
  glUniform4fv(glGetUniformLocation(program, "cuts"), kMaxClipPlanes, cuts.front().data());
}

void end_cuts() {
  for (std::size_t n = 0; n < kMaxClipPlanes; ++n) glDisable(static_cast<GLenum>(GL_CLIP_DISTANCE0 + n));
}

BoneLayer::BoneLayer(const SurfaceBricks& layout, const GridGeometry& geometry,
                     std::shared_ptr<const LabelMap> labels)
    : whole_(bone_program("")),
      cut_(bone_program("#define CUT\n")),
      geometry_(geometry),
      labels_(std::move(labels)),
      bricks_(layout.count()) {
  for (std::size_t n = 0; n < bricks_.size(); ++n)
    bricks_[n].bounds = bounding_sphere(geometry, layout.cells(n));
}

void BoneLayer::set_brick(std::size_t number, const BrickLevels& levels) {
  Brick& brick = bricks_[number];
  brick.levels = levels.levels;
  if (levels.empty()) {
    brick.vertex_array = {};
    brick.vertices = {};
    brick.indices = {};
    return;
  }
  if (brick.vertex_array.get() == 0) {
    brick.vertex_array = gl::VertexArray::make();
    brick.vertices = gl::Buffer::make();
    brick.indices = gl::Buffer::make();
  }
  brick.facing = facing_of(levels);
  glBindVertexArray(brick.vertex_array.get());
  gl::fill<MeshVertex>(GL_ARRAY_BUFFER, brick.vertices, levels.vertices, GL_DYNAMIC_DRAW);
  // A brick has fewer than 2^16 grid edges, hence fewer vertices.
  const std::vector<GLushort> indices(levels.indices.begin(), levels.indices.end());
  gl::fill<GLushort>(GL_ELEMENT_ARRAY_BUFFER, brick.indices, indices, GL_DYNAMIC_DRAW);
  gl::set_attribute(0, 3, sizeof(MeshVertex), offsetof(MeshVertex, position_mm));
  gl::set_attribute(1, 3, sizeof(MeshVertex), offsetof(MeshVertex, normal));
  gl::set_attribute(2, 1, sizeof(MeshVertex), offsetof(MeshVertex, density));
  if (labels_) set_label_colours(brick, levels.vertices);
}

void BoneLayer::set_label_colours(Brick& brick, const std::vector<MeshVertex>& vertices) {
  if (brick.label_colours.get() == 0) brick.label_colours = gl::Buffer::make();
  std::vector<LabelColour> colours;
  colours.reserve(vertices.size());
  for (const MeshVertex& vertex : vertices) colours.push_back(label_colour_below(*labels_, vertex));
  gl::fill<LabelColour>(GL_ARRAY_BUFFER, brick.label_colours, colours, GL_DYNAMIC_DRAW);
  glEnableVertexAttribArray(3);
  glVertexAttribPointer(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, sizeof(LabelColour), nullptr);
}

// Returns whether all triangles of the brick are back-facing.
bool BoneLayer::Brick::is_facing_away(const Vec3& eye_W) const {
  const Vec3 sight = bounds.centre_W - eye_W;
  const double way_mm = sight.norm();
  if (way_mm <= bounds.radius_mm) return false;
  const double angle = std::acos(std::clamp(facing.axis_W.dot(sight) / way_mm, -1.0, 1.0));
  return angle + facing.spread_rad + std::asin(bounds.radius_mm / way_mm) < 0.5 * std::numbers::pi;
}

template <typename Wanted>
std::vector<std::size_t> BoneLayer::bricks_in_view(const ViewScene& scene, const Projection& projection,
                                                   const Wanted& wanted) const {
  const auto planes = view_planes(projection);
  const Vec3 eye_W = scene.camera.eye_W();
  std::vector<std::pair<double, std::size_t>> found;
  for (std::size_t n = 0; n < bricks_.size(); ++n) {
    const Sphere& bounds = bricks_[n].bounds;
    if (wanted(bricks_[n]) && can_be_visible(planes, bounds))
      found.emplace_back((bounds.centre_W - eye_W).squaredNorm(), n);
  }
  std::ranges::sort(found);
  std::vector<std::size_t> numbers;
  for (const auto& [distance_mm2, number] : found) numbers.push_back(number);
  return numbers;
}

std::vector<std::size_t> BoneLayer::bricks_in_view(const ViewScene& scene,
                                                   const Projection& projection) const {
  return bricks_in_view(scene, projection, [](const Brick&) { return true; });
}

// Nearest first, so that hidden fragments need not be shaded.
std::vector<VisibleBrick> BoneLayer::visible_bricks(const ViewScene& scene, const Projection& projection,
                                                    const Detail& detail) const {
  const Vec3 eye_W = scene.camera.eye_W();
  const bool cut = is_cut(scene);
  const auto faces_us = [&](const Brick& brick) {
    return !brick.empty() && (cut || !brick.is_facing_away(eye_W));
  };
  std::vector<VisibleBrick> bricks;
  for (const std::size_t n : bricks_in_view(scene, projection, faces_us)) {
    const Brick& brick = bricks_[n];
    const double front_mm =
        std::max(depth_of(scene.camera, brick.bounds.centre_W) - brick.bounds.radius_mm, projection.near_mm);
    const bool sharp = detail.sharp && (detail.sharp->centre_W - brick.bounds.centre_W).norm() <
                                           detail.sharp->radius_mm + brick.bounds.radius_mm;
    const double cell_px =
        geometry_.spacing_mm.maxCoeff() / mm_per_pixel(scene.camera, projection.size, front_mm);
    bricks.push_back({n, 0, cell_px, sharp});
  }
  choose_levels(bricks, detail);
  return bricks;
}

void BoneLayer::choose_levels(std::span<VisibleBrick> bricks, const Detail& detail) const {
  for (VisibleBrick& visible : bricks) {
    const double widest_px = visible.sharp ? std::min(detail.cell_px, 1.0) : detail.cell_px;
    visible.level = 0;
    for (double cell_px = 2 * visible.cell_px;
         visible.level + 1 < BrickLevels::kCount && cell_px <= widest_px; cell_px *= 2) {
      ++visible.level;
    }
  }
}

std::size_t BoneLayer::triangle_count(std::span<const VisibleBrick> bricks) const {
  std::size_t count = 0;
  for (const VisibleBrick& visible : bricks) count += bricks_[visible.brick].levels[visible.level].count / 3;
  return count;
}

void BoneLayer::draw(const ViewScene& scene, const Projection& projection, const CavityPass& cavities,
                     std::span<const VisibleBrick> bricks) const {
  const bool cut = is_cut(scene);
  const GLuint program = (cut ? cut_ : whole_).get();
  glUseProgram(program);
  set_uniforms(program, scene, projection, cavities.reach_px(projection.size));
  if (cut) begin_cuts(program, scene);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, cavities.blurred_depths());
  if (!cut) glEnable(GL_CULL_FACE);
  // Colour for vertices without labels.
  glVertexAttrib4f(3, 0, 0, 0, 0);
  for (const VisibleBrick& visible : bricks) {
    glBindVertexArray(bricks_[visible.brick].vertex_array.get());
    const BrickLevels::Range& range = bricks_[visible.brick].levels[visible.level];
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_SHORT,
                   reinterpret_cast<const void*>(range.first * sizeof(GLushort)));
  }
  glDisable(GL_CULL_FACE);
  end_cuts();
}

std::size_t BoneLayer::triangle_count() const {
  std::size_t count = 0;
  for (const Brick& brick : bricks_) count += brick.levels[0].count / 3;
  return count;
}

}  // namespace osteomill
