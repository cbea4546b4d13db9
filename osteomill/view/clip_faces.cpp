#include "osteomill/view/clip_faces.h"

#include <vector>

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

// Grey values, or labels' colours; what is as dark as air lets the view through.
constexpr std::string_view kCutFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D pixels;
out vec4 colour;
void main() {
  colour = vec4(texture(pixels, place).rgb, 1.0);
  if (max(colour.r, max(colour.g, colour.b)) < 0.14) discard;
}
)";

// A label's colour over its grey value, and never quite dark: a nerve's canal may be as dark as air.
std::vector<std::array<unsigned char, 3>> pixels_of(const ClipFace& face) {
  constexpr double kLabel = 0.55, kLeast = 0.35;
  std::vector<std::array<unsigned char, 3>> pixels;
  pixels.reserve(face.greys.size());
  for (std::size_t n = 0; n < face.greys.size(); ++n) {
    const unsigned char grey = face.greys[n];
    pixels.push_back({grey, grey, grey});
    if (face.label_colours.empty() || face.label_colours[n] == std::array<unsigned char, 3>{}) continue;
    const double light = kLeast + (1 - kLeast) * grey / 255;
    for (std::size_t c = 0; c < 3; ++c) {
      const double tinted = (1 - kLabel) * grey + kLabel * light * face.label_colours[n][c];
      pixels.back()[c] = static_cast<unsigned char>(tinted);
    }
  }
  return pixels;
}

}  // namespace

ClipFaces::ClipFaces() : program_(gl::make_program(kCutVertex, kCutFragment)) {
  for (Face& face : faces_) {
    face.vertex_array = gl::make_vertex_array();
    face.corners = gl::make_buffer();
  }
}

void ClipFaces::set(std::size_t cut, const ClipFace& face) {
  Face& kept = faces_.at(cut);
  if (face.greys.empty()) {
    kept.pixels = {};
    return;
  }
  kept.pixels = gl::make_texture(GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, face.width, face.height, GL_LINEAR);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, face.width, face.height, GL_RGB, GL_UNSIGNED_BYTE,
                  pixels_of(face).data());
  // As a fan; the outermost pixels' middles lie half a pixel within the texture.
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

}  // namespace osteomill
