#include "osteomill/view/scene_renderer.h"

#include <optional>

#include "osteomill/view/bone_layer.h"
#include "osteomill/view/cavity_pass.h"
#include "osteomill/view/cut_faces.h"
#include "osteomill/view/frame_target.h"
#include "osteomill/view/shaders.h"
#include "osteomill/view/solid_shapes.h"

namespace osteomill {

namespace {

constexpr Colour kBurr{0.80f, 0.72f, 0.50f, 1};
constexpr Colour kShaft{0.66f, 0.69f, 0.73f, 1};
constexpr Colour kGhost{0.45f, 0.75f, 1.0f, 0.30f};
constexpr Colour kGhostInBone{0.45f, 0.75f, 1.0f, 0.16f};
constexpr Colour kContact{0.92f, 0.10f, 0.08f, 1};
constexpr Colour kForce{0.15f, 0.80f, 0.25f, 1};
constexpr Colour kTorque{0.98f, 0.72f, 0.10f, 1};
constexpr double kArrowRadius_mm = 0.22;
// Reading the depths makes a processor that draws wait for itself, and what is blurred changes little.
constexpr unsigned kPicturesPerBlur = 4;

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
  Impl(const SurfaceBricks& layout, const GridGeometry& geometry)
      : bone(layout, geometry),
        background(gl::make_program(shaders::kScreenVertex, shaders::kBackgroundFragment)),
        nothing(gl::make_vertex_array()) {}

  void fit(const PixelSize& size) {
    if (target && target->size().width == size.width && target->size().height == size.height) return;
    target.emplace(size);
    cavities.emplace(size);
    drawn = 0;
  }

  void draw_background() const {
    glDepthFunc(GL_LEQUAL);
    glUseProgram(background.get());
    glBindVertexArray(nothing.get());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_LESS);
  }

  // Over everything, since a contact lies where tool and bone hide it.
  void draw_wrench(const ViewScene& scene) const {
    glClear(GL_DEPTH_BUFFER_BIT);
    if (const auto contact = point_of_action(scene.tool, *scene.X_WT, scene.wrench)) {
      shapes.sphere(*contact, 0.22 * scene.tool.burr_radius_mm, kContact);
    }
    const Vec3 burr_W = scene.X_WT->position_mm;
    shapes.arrow(burr_W, kArrow_mm_per_N * scene.wrench.force_N, kArrowRadius_mm, kForce);
    shapes.arrow(burr_W, kArrow_mm_per_Nmm * scene.wrench.torque_Nmm, 0.8 * kArrowRadius_mm, kTorque, 2);
  }

  BoneLayer bone;
  SolidShapes shapes;
  CutFaces cut_faces;
  gl::Program background;
  gl::VertexArray nothing;
  std::optional<FrameTarget> target;
  std::optional<CavityPass> cavities;
  unsigned drawn = 0;
};

SceneRenderer::SceneRenderer(const SurfaceBricks& layout, const GridGeometry& geometry)
    : impl_(std::make_unique<Impl>(layout, geometry)) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::clear() {
  impl_->bone.clear();
}

void SceneRenderer::set_brick(std::size_t brick, const BrickMesh& mesh) {
  impl_->bone.set_brick(brick, mesh);
}

void SceneRenderer::set_cut_face(std::size_t cut, const CutFace& face) {
  impl_->cut_faces.set(cut, face);
}

void SceneRenderer::draw(const ViewScene& scene, const PixelSize& size) {
  Impl& own = *impl_;
  own.fit(size);
  const Projection projection = projection_of(scene, size);
  own.target->bind();
  glDepthMask(GL_TRUE);
  glEnable(GL_DEPTH_TEST);
  glClear(GL_DEPTH_BUFFER_BIT);
  own.bone.draw(scene, projection, own.cavities->blurred_depths());
  if (own.drawn++ % kPicturesPerBlur == 0) {
    own.cavities->blur(own.target->depths(), projection.near_mm, projection.far_mm);
    own.target->bind();
  }
  own.draw_background();
  own.cut_faces.draw(scene, projection);
  own.shapes.begin(projection);
  if (scene.X_WT) draw_tool(own.shapes, scene.tool, *scene.X_WT, kBurr, kShaft);
  if (scene.X_WD) draw_ghost(own.shapes, scene.tool, *scene.X_WD);
  if (scene.X_WT) own.draw_wrench(scene);
}

Image SceneRenderer::picture() const {
  return impl_->target->read();
}

void SceneRenderer::copy_to_window() const {
  const PixelSize size = impl_->target->size();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, impl_->target->framebuffer());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, size.width, size.height, 0, 0, size.width, size.height, GL_COLOR_BUFFER_BIT,
                    GL_NEAREST);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

std::size_t SceneRenderer::triangle_count() const {
  return impl_->bone.triangle_count();
}

}  // namespace osteomill
