#include "osteomill/view/scene_renderer.h"

#include <optional>

#include "osteomill/view/bone_ground.h"
#include "osteomill/view/solid_shapes.h"

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

// Twice: faint through the bone, clearer where nothing is before it. Only its outermost face, so that it is
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

  void fit(const PixelSize& size) {
    if (target && target->size().width == size.width && target->size().height == size.height) return;
    target.emplace(size);
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

  BoneGround ground;
  SolidShapes shapes;
  gl::Program to_window = gl::make_screen_program(kPictureFragment);
  gl::VertexArray nothing = gl::make_vertex_array();
  std::optional<FrameTarget> target;
  PixelSize asked_size;
};

SceneRenderer::SceneRenderer(const SurfaceBricks& layout, const GridGeometry& geometry,
                             std::shared_ptr<const LabelMap> labels)
    : impl_(std::make_unique<Impl>(layout, geometry, std::move(labels))) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::set_brick(std::size_t brick, const BrickMesh& mesh, const BrickLevels& levels) {
  impl_->ground.set_brick(brick, mesh, levels);
}

void SceneRenderer::set_clip_face(std::size_t cut, const ClipFace& face) {
  impl_->ground.set_clip_face(cut, face);
}

void SceneRenderer::draw(const ViewScene& scene, const PixelSize& size) {
  Impl& own = *impl_;
  own.asked_size = size;
  own.ground.draw(scene, size);
  const PixelSize drawn = own.ground.picture().size();
  own.fit(drawn);
  const Projection projection = projection_of(scene, drawn);
  own.copy_ground();
  own.shapes.begin(projection);
  if (scene.X_WT) draw_tool(own.shapes, scene.tool, *scene.X_WT, kBurr, kShaft);
  if (scene.X_WD) draw_ghost(own.shapes, scene.tool, *scene.X_WD);
  if (scene.X_WT) own.draw_wrench(scene);
}

Image SceneRenderer::picture() const {
  return impl_->target->read();
}

// Drawn, since a processor that draws takes twice as long for glBlitFramebuffer, and half as long again where
// what lies between a moving picture's wide pixels is filled in.
void SceneRenderer::copy_to_window() const {
  const PixelSize& to = impl_->asked_size;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, to.width, to.height);
  glDisable(GL_DEPTH_TEST);
  glUseProgram(impl_->to_window.get());
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, impl_->target->colours());
  glBindVertexArray(impl_->nothing.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glEnable(GL_DEPTH_TEST);
}

bool SceneRenderer::settled() const {
  return impl_->ground.settled();
}

std::size_t SceneRenderer::triangle_count() const {
  return impl_->ground.triangle_count();
}

}  // namespace osteomill
