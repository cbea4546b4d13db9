#include "view/tool_passes.h"

#include <algorithm>

namespace osteomill {

namespace {

// Distance from the sphere's centre, or the cylinder's axis, at which the shadow ends, in radii.
constexpr double kReach_radii = 2.5;
constexpr std::string_view kShadowFragment = R"(#version 330 core
uniform sampler2D depths;
uniform vec2 near_far;
uniform vec2 slope;  // of the line of sight to the picture's right and upper edge
uniform vec3 from_C;  // start of the axis of sphere or cylinder
uniform vec3 along_mm;
uniform float radius_mm;
uniform float ball;  // 1 for the sphere, 0 for the cylinder
uniform float reach;
uniform float darkest;
out vec4 colour;
void main() {
  float d = texelFetch(depths, ivec2(gl_FragCoord.xy), 0).r;
  vec2 place = gl_FragCoord.xy / vec2(textureSize(depths, 0));
  vec3 sight = vec3((2.0 * place - 1.0) * slope, -1.0);
  vec3 point = sight * (near_far.x * near_far.y / (near_far.y - d * (near_far.y - near_far.x)));
  vec3 n = normalize(cross(dFdx(point), dFdy(point)));
  vec3 towards = from_C - point;
  towards += clamp(-dot(towards, along_mm) / max(dot(along_mm, along_mm), 1e-9), 0.0, 1.0) * along_mm;
  float radii = length(towards) / radius_mm;
  // The sky hidden by a cylinder falls with the distance, that by a sphere with its square.
  float part = min(1.0 / (radii * mix(1.0, radii, ball)), 1.0);
  float fade = clamp((reach - radii) / (reach - 1.0), 0.0, 1.0);
  float hidden = part * fade * fade * max(dot(n, towards), 0.0) / (radii * radius_mm);
  // Across an outline the depth jumps to other bone: that slope does not belong to a surface.
  hidden *= smoothstep(0.02, 0.15, -dot(n, normalize(sight)));
  colour = vec4(vec3(1.0 - darkest * hidden), 1.0);
}
)";

constexpr std::string_view kVeilFragment = R"(#version 330 core
uniform sampler2D picture;
uniform sampler2D depths;
out vec4 colour;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  colour = vec4(texelFetch(picture, pixel, 0).rgb, 1.0);
  gl_FragDepth = texelFetch(depths, pixel, 0).r;
}
)";

void bind_texture(GLuint program, const char* name, int unit, GLuint texture) {
  glActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
  glBindTexture(GL_TEXTURE_2D, texture);
  glUniform1i(glGetUniformLocation(program, name), unit);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace

ContactShadow::ContactShadow() : program_(gl::make_program(SolidShapes::vertex_source(), kShadowFragment)) {}

// Draws the back faces of the shadow's volume where bone lies in front of them: only a few pixels if the tool
// is far from bone.
void ContactShadow::draw(const ViewScene& scene, const Projection& projection, const FrameTarget& ground,
                         const SolidShapes& shapes) const {
  const GLuint program = program_.get();
  shapes.begin(projection, program);
  const auto place = [&](const char* name) { return glGetUniformLocation(program, name); };
  bind_texture(program, "depths", 0, ground.depths());
  glUniform2f(place("near_far"), static_cast<float>(projection.near_mm),
              static_cast<float>(projection.far_mm));
  glUniform2f(place("slope"), 1 / projection.clip_from_camera(0, 0), 1 / projection.clip_from_camera(1, 1));
  glUniform1f(place("darkest"), static_cast<float>(kDarkest));
  glUniform1f(place("reach"), static_cast<float>(kReach_radii));
  const auto set_axis = [&](const Vec3& from_W, const Vec3& to_W, double radius_mm, float ball) {
    const Mat3 camera_from_world = scene.camera.orientation.conjugate().toRotationMatrix();
    const Eigen::Vector3f from_C = (camera_from_world * (from_W - scene.camera.eye_W())).cast<float>();
    const Eigen::Vector3f along = (camera_from_world * (to_W - from_W)).cast<float>();
    glUniform3fv(place("from_C"), 1, from_C.data());
    glUniform3fv(place("along_mm"), 1, along.data());
    glUniform1f(place("radius_mm"), static_cast<float>(radius_mm));
    glUniform1f(place("ball"), ball);
  };
  const MillingTool& tool = scene.tool;
  const Vec3 burr_W = scene.X_WT->position_mm;
  const Vec3 end_W = *scene.X_WT * Vec3(0, 0, tool.shaft_length_mm);
  const double burr_reach_mm = kReach_radii * tool.burr_radius_mm;
  const double shaft_reach_mm = kReach_radii * tool.shaft_radius_mm;
  const Vec3 beyond_mm = shaft_reach_mm * (end_W - burr_W).normalized();

  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ZERO, GL_SRC_COLOR);
  set_axis(burr_W, burr_W, tool.burr_radius_mm, 1);
  shapes.sphere(burr_W, burr_reach_mm, {});
  set_axis(burr_W, end_W, tool.shaft_radius_mm, 0);
  shapes.cylinder(burr_W - beyond_mm, end_W + beyond_mm, shaft_reach_mm, {});
  glDisable(GL_BLEND);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LESS);
  glCullFace(GL_BACK);
  glDisable(GL_CULL_FACE);
}

BoneVeil::BoneVeil() : program_(kVeilFragment) {}

void BoneVeil::begin(const ViewScene& scene, const Projection& projection) const {
  const MillingTool& tool = scene.tool;
  const Vec3 end_W = *scene.X_WT * Vec3(0, 0, tool.shaft_length_mm);
  Eigen::AlignedBox2d box = projected_bounds(
      scene, projection, {scene.X_WT->position_mm, std::max(tool.burr_radius_mm, tool.shaft_radius_mm)});
  box.extend(projected_bounds(scene, projection, {end_W, tool.shaft_radius_mm}));
  const Eigen::Array2d all(projection.size.width, projection.size.height);
  const Eigen::Array2i first = box.min().array().floor().max(0.0).min(all).cast<int>();
  const Eigen::Array2i size = box.max().array().ceil().max(0.0).min(all).cast<int>() - first;
  glEnable(GL_SCISSOR_TEST);
  glScissor(first.x(), first.y(), std::max(size.x(), 0), std::max(size.y(), 0));
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_TRUE);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

// The picture's alpha is `kShare` at the tool and 0 elsewhere.
void BoneVeil::end(const FrameTarget& ground) const {
  const GLuint program = program_.get();
  glUseProgram(program);
  bind_texture(program, "picture", 0, ground.colours());
  bind_texture(program, "depths", 1, ground.depths());
  glEnable(GL_BLEND);
  glBlendFunc(GL_DST_ALPHA, GL_ONE_MINUS_DST_ALPHA);
  program_.draw();
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
}

}  // namespace osteomill
