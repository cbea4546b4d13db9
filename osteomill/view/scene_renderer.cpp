#include "osteomill/view/scene_renderer.h"

#include <algorithm>
#include <optional>

#include "osteomill/view/bone_layer.h"
#include "osteomill/view/cavity_pass.h"
#include "osteomill/view/clip_faces.h"
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

namespace {

bool same_cut(const std::optional<ClipPlane>& a, const std::optional<ClipPlane>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->normal_W == b->normal_W && a->offset_mm == b->offset_mm;
}

// As far as the bone is drawn by it.
bool same_view(const ViewScene& a, const ViewScene& b) {
  return a.camera.focus_W == b.camera.focus_W && a.camera.distance_mm == b.camera.distance_mm &&
         a.camera.orientation.coeffs() == b.camera.orientation.coeffs() &&
         a.camera.field_of_view_rad == b.camera.field_of_view_rad && a.bounds.centre_W == b.bounds.centre_W &&
         a.bounds.radius_mm == b.bounds.radius_mm && a.isovalue == b.isovalue &&
         a.reference_density == b.reference_density && a.light_from_below == b.light_from_below &&
         std::equal(a.cuts.begin(), a.cuts.end(), b.cuts.begin(), same_cut);
}

}  // namespace

struct SceneRenderer::Impl {
  Impl(const SurfaceBricks& layout, const GridGeometry& geometry)
      : bone(layout, geometry),
        background(gl::make_program(shaders::kScreenVertex, shaders::kBackgroundFragment)),
        nothing(gl::make_vertex_array()) {}

  // The bone with all that stands still beside it, in a picture of its own, to which the tool is added. It is
  // drawn anew where the view changed, in every second picture while bone is milled, and until its shading
  // has settled.
  void keep_ground(const ViewScene& scene, const Projection& projection) {
    if (!ground_scene || !same_view(*ground_scene, scene)) steady_pictures = 0;
    const bool due = steady_pictures < 3 || (bone_changed && drawn % 2 == 0);
    if (due) {
      draw_ground(scene, projection, steady_pictures == 1 || drawn % kPicturesPerBlur == 0);
      ground_scene = scene;
      bone_changed = false;
      ++steady_pictures;
    }
    ++drawn;
  }

  void draw_ground(const ViewScene& scene, const Projection& projection, bool look_for_cavities) {
    ground->bind();
    glDepthMask(GL_TRUE);
    glEnable(GL_DEPTH_TEST);
    glClear(GL_DEPTH_BUFFER_BIT);
    bone.draw(scene, projection, *cavities);
    if (look_for_cavities) {
      cavities->blur(ground->depths(), projection.near_mm, projection.far_mm);
      ground->bind();
    }
    draw_background();
    cut_faces.draw(scene, projection);
  }

  void copy_ground() const {
    const PixelSize& size = target->size();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, ground->framebuffer());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target->framebuffer());
    glBlitFramebuffer(0, 0, size.width, size.height, 0, 0, size.width, size.height,
                      GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    target->bind();
  }

  void fit(const PixelSize& size) {
    if (target && target->size().width == size.width && target->size().height == size.height) return;
    target.emplace(size);
    ground.emplace(size);
    cavities.emplace(size);
    drawn = 0;
    ground_scene.reset();
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
  ClipFaces cut_faces;
  gl::Program background;
  gl::VertexArray nothing;
  std::optional<FrameTarget> target;
  std::optional<FrameTarget> ground;
  std::optional<CavityPass> cavities;
  std::optional<ViewScene> ground_scene;
  int steady_pictures = 0;
  bool bone_changed = false;
  unsigned drawn = 0;
};

SceneRenderer::SceneRenderer(const SurfaceBricks& layout, const GridGeometry& geometry)
    : impl_(std::make_unique<Impl>(layout, geometry)) {}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::clear() {
  impl_->bone.clear();
  impl_->ground_scene.reset();
}

void SceneRenderer::set_brick(std::size_t brick, const BrickMesh& mesh) {
  impl_->bone.set_brick(brick, mesh);
  impl_->bone_changed = true;
}

void SceneRenderer::set_clip_face(std::size_t cut, const ClipFace& face) {
  impl_->cut_faces.set(cut, face);
  impl_->ground_scene.reset();
}

void SceneRenderer::draw(const ViewScene& scene, const PixelSize& size) {
  Impl& own = *impl_;
  own.fit(size);
  const Projection projection = projection_of(scene, size);
  own.keep_ground(scene, projection);
  own.copy_ground();
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
