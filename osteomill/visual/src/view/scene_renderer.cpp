#include "osteomill/visual/scene_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "view/bone_ground.h"

namespace osteomill {

namespace {

constexpr std::string_view kSolidVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 camera_from_shape;
uniform mat3 normal_from_shape;
uniform mat4 clip_from_camera;
out vec3 normal_C;
void main() {
  gl_Position = clip_from_camera * (camera_from_shape * vec4(position, 1.0));
  normal_C = normal_from_shape * normal;
}
)";

constexpr std::string_view kSolidFragment = R"(#version 330 core
in vec3 normal_C;
uniform vec4 base;
uniform float gloss;
out vec4 colour;
void main() {
  vec3 n = normalize(normal_C);
  vec3 towards_light = normalize(vec3(-0.45, 0.60, 0.66));
  float light = 0.50 + 0.10 * n.y + 0.50 * max(dot(n, towards_light), 0.0);
  float shine = gloss * pow(max(dot(n, normalize(towards_light + vec3(0.0, 0.0, 1.0))), 0.0), 40.0);
  colour = vec4(base.rgb * light + shine, base.a);
}
)";

constexpr std::string_view kPictureFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D picture;
out vec4 colour;
void main() { colour = texture(picture, place); }
)";

constexpr int kSides = 32;
constexpr int kRings = 16;
constexpr double kHeadLength = 5.0;
constexpr double kHeadWidth = 2.4;

Mat3 axes_along(const Vec3& direction) {
  return smallest_rotation(Vec3::UnitZ(), direction).toRotationMatrix();
}

constexpr float kGloss = 0.25f;

// Red, green, blue, and how much it covers what is behind.
using Colour = std::array<float, 4>;

}  // namespace

struct SolidShape {
  gl::VertexArray vertex_array;
  gl::Buffer vertices;
  GLsizei vertex_count = 0;
};

// Turns an outline about z: points of radius, height, and the normal's radius and height, two for each piece.
static SolidShape turned(const std::vector<std::array<float, 4>>& outline) {
  std::vector<float> corners;
  const auto corner = [&](const std::array<float, 4>& point, int side) {
    const double angle = 2 * std::numbers::pi * side / kSides;
    const auto c = static_cast<float>(std::cos(angle));
    const auto s = static_cast<float>(std::sin(angle));
    corners.insert(corners.end(),
                   {c * point[0], s * point[0], point[1], c * point[2], s * point[2], point[3]});
  };
  for (std::size_t n = 0; n + 1 < outline.size(); n += 2) {
    for (int side = 0; side < kSides; ++side) {
      for (const auto& [end, turn] : {std::pair{0u, 0}, {0u, 1}, {1u, 1}, {0u, 0}, {1u, 1}, {1u, 0}}) {
        corner(outline[n + end], side + turn);
      }
    }
  }
  SolidShape shape{gl::VertexArray::make(), gl::Buffer::make(), static_cast<GLsizei>(corners.size() / 6)};
  glBindVertexArray(shape.vertex_array.get());
  gl::fill<float>(GL_ARRAY_BUFFER, shape.vertices, corners, GL_STATIC_DRAW);
  gl::set_attribute(0, 3, 6 * sizeof(float), 0);
  gl::set_attribute(1, 3, 6 * sizeof(float), 3 * sizeof(float));
  return shape;
}

// Draws spheres, cylinders and arrows: the tool, its ghost, contacts, forces.
class SolidShapes {
 public:
  SolidShapes() {
    std::vector<std::array<float, 4>> round;
    for (int ring = 0; ring < kRings; ++ring) {
      for (const int end : {ring, ring + 1}) {
        const double angle = std::numbers::pi * (static_cast<double>(end) / kRings - 0.5);
        const auto radius = static_cast<float>(std::cos(angle));
        const auto height = static_cast<float>(std::sin(angle));
        round.push_back({radius, height, radius, height});
      }
    }
    sphere_ = turned(round);
    cylinder_ =
        turned({{0, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, 1, 0}, {1, 1, 1, 0}, {1, 1, 0, 1}, {0, 1, 0, 1}});
    cone_ = turned({{0, 0, 0, -1}, {1, 0, 0, -1}, {1, 0, 0.9f, 0.43f}, {0, 1, 0.9f, 0.43f}});
  }

  void begin(const Projection& projection) const {
    glUseProgram(program_.get());
    camera_from_world_ = projection.camera_from_world;
    glUniformMatrix4fv(glGetUniformLocation(program_.get(), "clip_from_camera"), 1, GL_FALSE,
                       projection.clip_from_camera.data());
  }

  void sphere(const Vec3& centre_W, double radius_mm, const Colour& colour) const {
    draw(sphere_, centre_W, Mat3::Identity(), Vec3::Constant(radius_mm), colour, kGloss);
  }

  // Adds a cylinder from `from_W` to `to_W`, closed by flat ends.
  void cylinder(const Vec3& from_W, const Vec3& to_W, double radius_mm, const Colour& colour,
                float gloss = kGloss) const {
    const Vec3 along = to_W - from_W;
    if (!(along.norm() > 0)) return;
    draw(cylinder_, from_W, axes_along(along), {radius_mm, radius_mm, along.norm()}, colour, gloss);
  }

  // Adds an arrow with a head; none if it is shorter than its head would be thick.
  void arrow(const Vec3& from_W, const Vec3& along_mm, double radius_mm, const Colour& colour,
             int heads = 1) const {
    const double length_mm = along_mm.norm();
    const double head_mm = kHeadLength * radius_mm;
    if (length_mm < radius_mm) return;
    const Vec3 unit = along_mm / length_mm;
    const double shaft_mm = std::max(length_mm - heads * head_mm, 0.0);
    cylinder(from_W, from_W + shaft_mm * unit, radius_mm, colour, 0);
    const double width_mm = kHeadWidth * radius_mm;
    const double each_mm = std::min(head_mm, (length_mm - shaft_mm) / heads);
    for (int n = 0; n < heads; ++n) {
      draw(cone_, from_W + (shaft_mm + n * each_mm) * unit, axes_along(unit), {width_mm, width_mm, each_mm},
           colour, 0);
    }
  }

 private:
  void draw(const SolidShape& shape, const Vec3& place_W, const Mat3& axes, const Vec3& sizes_mm,
            const Colour& colour, float gloss) const {
    Eigen::Matrix4f world_from_shape = Eigen::Matrix4f::Identity();
    world_from_shape.topLeftCorner<3, 3>() = (axes * sizes_mm.asDiagonal()).cast<float>();
    world_from_shape.topRightCorner<3, 1>() = place_W.cast<float>();
    const Eigen::Matrix4f camera_from_shape = camera_from_world_ * world_from_shape;
    const Eigen::Matrix3f normals = camera_from_world_.topLeftCorner<3, 3>() *
                                    (axes * sizes_mm.cwiseInverse().asDiagonal()).cast<float>();
    const GLuint program = program_.get();
    glUniformMatrix4fv(glGetUniformLocation(program, "camera_from_shape"), 1, GL_FALSE,
                       camera_from_shape.data());
    glUniformMatrix3fv(glGetUniformLocation(program, "normal_from_shape"), 1, GL_FALSE, normals.data());
    glUniform4fv(glGetUniformLocation(program, "base"), 1, colour.data());
    glUniform1f(glGetUniformLocation(program, "gloss"), gloss);
    glBindVertexArray(shape.vertex_array.get());
    glDrawArrays(GL_TRIANGLES, 0, shape.vertex_count);
  }

  gl::Program program_ = gl::make_program(kSolidVertex, kSolidFragment);
  SolidShape sphere_;
  SolidShape cylinder_;
  SolidShape cone_;
  mutable Eigen::Matrix4f camera_from_world_;
};

namespace {

constexpr Colour kBurr{0.80f, 0.72f, 0.50f, 1};
constexpr Colour kShaft{0.66f, 0.69f, 0.73f, 1};
constexpr Colour kGhost{0.45f, 0.75f, 1.0f, 0.30f};
constexpr Colour kGhostInBone{0.45f, 0.75f, 1.0f, 0.16f};
constexpr Colour kRedPoint{0.92f, 0.10f, 0.08f, 1};
constexpr Colour kForce{0.15f, 0.80f, 0.25f, 1};
constexpr Colour kTorque{0.98f, 0.72f, 0.10f, 1};
constexpr double kArrowRadius_mm = 0.22;

void draw_tool(const SolidShapes& shapes, const MillingTool& tool, const Pose& X_WT, const Colour& burr,
               const Colour& shaft) {
  const Vec3 end_W = X_WT * Vec3(0, 0, tool.shaft_length_mm);
  shapes.sphere(X_WT.position_mm, tool.burr_radius_mm, burr);
  shapes.cylinder(X_WT.position_mm, end_W, tool.shaft_radius_mm, shaft);
}

// Twice: faint through the bone, clearer if nothing is before it. Only its outermost face, so that it is
// as clear everywhere.
void draw_ghost(const SolidShapes& shapes, const MillingTool& tool, const Pose& X_WD) {
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_CULL_FACE);
  glDepthMask(GL_FALSE);
  glDisable(GL_DEPTH_TEST);
  draw_tool(shapes, tool, X_WD, kGhostInBone, kGhostInBone);
  glEnable(GL_DEPTH_TEST);
  draw_tool(shapes, tool, X_WD, kGhost, kGhost);
  glDepthMask(GL_TRUE);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
}

}  // namespace

struct SceneRenderer::Impl {
  Impl(const SurfaceBricks& layout, const GridGeometry& geometry, std::shared_ptr<const LabelMap> labels)
      : ground(layout, geometry, std::move(labels)) {}

  void copy_ground() const {
    const PixelSize& size = target->size();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, ground.picture().framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target->framebuffer());
    glBlitFramebuffer(0, 0, size.width, size.height, 0, 0, size.width, size.height,
                      GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    target->bind();
  }

  // Over everything, since a contact lies where tool and bone hide it.
  void draw_wrench(const ViewScene& scene) const {
    glClear(GL_DEPTH_BUFFER_BIT);
    if (const auto point_W = red_point_W(scene)) {
      shapes.sphere(*point_W, 0.22 * scene.tool.burr_radius_mm, kRedPoint);
    }
    const Vec3 burr_W = scene.X_WT->position_mm;
    shapes.arrow(burr_W, kArrow_mm_per_N * scene.wrench.force_N, kArrowRadius_mm, kForce);
    shapes.arrow(burr_W, kArrow_mm_per_Nmm * scene.wrench.torque_Nmm, 0.8 * kArrowRadius_mm, kTorque, 2);
  }

  // Into the picture that is bound.
  void draw_solids(const ViewScene& scene, const PixelSize& size) const {
    shapes.begin(projection_of(scene, size));
    if (scene.X_WT) draw_tool(shapes, scene.tool, *scene.X_WT, kBurr, kShaft);
    if (scene.X_WD) draw_ghost(shapes, scene.tool, *scene.X_WD);
    if (scene.X_WT) draw_wrench(scene);
  }

  void copy_to_window(const FrameTarget& picture, int left_px, int bottom_px, const PixelSize& size) const {
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(left_px, bottom_px, size.width, size.height);
    glDisable(GL_DEPTH_TEST);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, picture.colours());
    to_window.draw();
    glEnable(GL_DEPTH_TEST);
  }

  BoneGround ground;
  SolidShapes shapes;
  gl::ScreenProgram to_window{kPictureFragment};
  std::optional<FrameTarget> target;
  PixelSize asked_size;
};

std::optional<Vec3> point_of_action(const MillingTool& tool, const Pose& X_WT, const Wrench& wrench) {
  constexpr double kMinForce_N = 0.02;
  constexpr int kSteps = 200;
  const double force_N = wrench.force_N.norm();
  if (!(force_N > kMinForce_N)) return std::nullopt;
  const Vec3 along = wrench.force_N / force_N;
  const Vec3 lever = wrench.force_N.cross(wrench.torque_Nmm) / (force_N * force_N);
  // The force pushes the tool away from the bone: it comes from outside, against the tool.
  const double reach_mm = lever.norm() + tool.shaft_length_mm + tool.burr_radius_mm;
  const Pose X_TW = X_WT.inverse();
  for (int n = 0; n <= kSteps; ++n) {
    const double way_mm = -reach_mm + 2 * reach_mm * n / kSteps;
    const Vec3 point_W = X_WT.position_mm + lever + way_mm * along;
    const double distance_mm = tool_distance(tool, X_TW * point_W).distance_mm;
    if (distance_mm <= reach_mm / kSteps) return Vec3(point_W + std::max(distance_mm, 0.0) * along);
  }
  return Vec3(X_WT.position_mm - tool.burr_radius_mm * along);
}

std::optional<Vec3> red_point_W(const ViewScene& scene) {
  if (scene.intersection_W || !scene.X_WT) return scene.intersection_W;
  return point_of_action(scene.tool, *scene.X_WT, scene.wrench);
}

SceneRenderer::SceneRenderer(const SurfaceBricks& layout, const GridGeometry& geometry,
                             std::shared_ptr<const LabelMap> labels)
    : impl_(std::make_unique<Impl>(layout, geometry, std::move(labels))) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::set_brick(std::size_t brick, const BrickLevels& levels) {
  impl_->ground.set_brick(brick, levels);
}

void SceneRenderer::set_clip_face(std::size_t cut, const ClipFace& face) {
  impl_->ground.set_clip_face(cut, face);
}

void SceneRenderer::draw(const ViewScene& scene, const PixelSize& size) {
  Impl& own = *impl_;
  own.asked_size = size;
  own.ground.draw(scene, size);
  const PixelSize drawn = own.ground.picture().size();
  if (!own.target || own.target->size() != drawn) own.target.emplace(drawn);
  own.copy_ground();
  own.draw_solids(scene, drawn);
}

void SceneRenderer::draw_inset(const ViewScene& scene, const PixelSize& size) {
  impl_->ground.draw_inset(scene, size);
  impl_->ground.inset().bind();
  impl_->draw_solids(scene, size);
}

void SceneRenderer::copy_inset_to_window(int left_px, int bottom_px) const {
  const FrameTarget& inset = impl_->ground.inset();
  impl_->copy_to_window(inset, left_px, bottom_px, inset.size());
}

Image SceneRenderer::picture() const {
  return impl_->target->read();
}

// Drawn, since a processor that draws takes twice as long for glBlitFramebuffer, and half as long again where
// what lies between a moving picture's wide pixels is filled in.
void SceneRenderer::copy_to_window() const {
  impl_->copy_to_window(*impl_->target, 0, 0, impl_->asked_size);
}

bool SceneRenderer::is_settled() const {
  return impl_->ground.is_settled();
}

std::size_t SceneRenderer::triangle_count() const {
  return impl_->ground.triangle_count();
}

}  // namespace osteomill
