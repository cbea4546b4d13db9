#include "osteomill/visual/scene_renderer.h"

#include <algorithm>
#include <optional>

#include "view/bone_ground.h"
#include "view/solid_shapes.h"
#include "view/tool_passes.h"

namespace osteomill {

namespace {

constexpr std::string_view kPictureFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D picture;
out vec4 colour;
void main() { colour = texture(picture, place); }
)";

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

// Drawn twice: faint through the bone, clearer if not hidden by it. Draws only the outermost surface, for
// uniform opacity.
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

  // Draws the simulated tool and its shadow, and if the scene requests it the tool through bone in front of
  // it.
  void draw_simulated_tool(const ViewScene& scene, const Projection& projection,
                           const FrameTarget& bone) const {
    shadow.draw(scene, projection, bone, shapes);
    Colour burr = kBurr, shaft = kShaft;
    if (scene.see_through) {
      veil.begin(scene, projection);
      burr[3] = shaft[3] = BoneVeil::kShare;
    }
    shapes.begin(projection);
    draw_tool(shapes, scene.tool, *scene.X_WT, burr, shaft);
    if (scene.see_through) veil.end(bone);
  }

  // Drawn over everything, because tool and bone hide the contact.
  void draw_wrench(const ViewScene& scene) const {
    glClear(GL_DEPTH_BUFFER_BIT);
    if (const auto point_W = red_point_W(scene)) {
      shapes.sphere(*point_W, 0.22 * scene.tool.burr_radius_mm, kRedPoint);
    }
    const Vec3 burr_W = scene.X_WT->position_mm;
    shapes.arrow(burr_W, kArrow_mm_per_N * scene.wrench.force_N, kArrowRadius_mm, kForce);
    shapes.arrow(burr_W, kArrow_mm_per_Nmm * scene.wrench.torque_Nmm, 0.8 * kArrowRadius_mm, kTorque, 2);
  }

  // Copies a picture of the bone and draws tool, ghost and wrench over it.
  void compose(const ViewScene& scene, const FrameTarget& bone, std::optional<FrameTarget>& picture) const {
    const PixelSize& size = bone.size();
    if (!picture || picture->size() != size) picture.emplace(size);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, bone.framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture->framebuffer());
    glBlitFramebuffer(0, 0, size.width, size.height, 0, 0, size.width, size.height,
                      GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    picture->bind();
    const Projection projection = projection_of(scene, size);
    if (scene.X_WT) draw_simulated_tool(scene, projection, bone);
    shapes.begin(projection);
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
  BoneVeil veil;
  ContactShadow shadow;
  gl::ScreenProgram to_window{kPictureFragment};
  std::optional<FrameTarget> target;
  std::optional<FrameTarget> inset;
  PixelSize asked_size;
};

std::optional<Vec3> point_of_action(const MillingTool& tool, const Pose& X_WT, const Wrench& wrench) {
  constexpr double kMinForce_N = 0.02;
  constexpr int kSteps = 200;
  const double force_N = wrench.force_N.norm();
  if (!(force_N > kMinForce_N)) return std::nullopt;
  const Vec3 along = wrench.force_N / force_N;
  const Vec3 lever = wrench.force_N.cross(wrench.torque_Nmm) / (force_N * force_N);
  // The force pushes the tool away from the bone: its line of action, followed along the force, enters the
  // tool at the contact.
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
  own.compose(scene, own.ground.picture(), own.target);
}

void SceneRenderer::draw_inset(const ViewScene& scene, const PixelSize& size) {
  impl_->ground.draw_inset(scene, size);
  impl_->compose(scene, impl_->ground.inset(), impl_->inset);
}

void SceneRenderer::copy_inset_to_window(int left_px, int bottom_px) const {
  impl_->copy_to_window(*impl_->inset, left_px, bottom_px, impl_->inset->size());
}

Image SceneRenderer::picture() const {
  return impl_->target->read();
}

// Draws a textured triangle: with a software renderer glBlitFramebuffer takes twice as long, and half as long
// again if it upscales a moving view's coarse pixels.
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
