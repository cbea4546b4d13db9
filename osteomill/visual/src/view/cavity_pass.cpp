#include "view/cavity_pass.h"

#include <algorithm>

namespace osteomill {

namespace {

// Outputs depth in mm and 1, or zeros for the background.
constexpr std::string_view kDepthFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D depths;
uniform vec2 near_far;
out vec2 depth;
void main() {
  float d = texture(depths, place).r;
  float mm = near_far.x * near_far.y / (near_far.y - d * (near_far.y - near_far.x));
  depth = d < 1.0 ? vec2(mm, 1.0) : vec2(0.0);
}
)";

constexpr std::string_view kBlurFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D source;
uniform vec2 pace;
out vec2 blurred;
void main() {
  vec2 sum = vec2(0.0);
  sum += 0.0702 * (texture(source, place - 3.0 * pace).rg + texture(source, place + 3.0 * pace).rg);
  sum += 0.1311 * (texture(source, place - 2.0 * pace).rg + texture(source, place + 2.0 * pace).rg);
  sum += 0.1907 * (texture(source, place - pace).rg + texture(source, place + pace).rg);
  blurred = sum + 0.2160 * texture(source, place).rg;
}
)";

// Blur radius in reduced pixels.
constexpr int kBlurSteps = 3;

int shrunk(int pixels, int reach_px) {
  return std::max(1, pixels * kBlurSteps / reach_px);
}

}  // namespace

CavityPass::Layer::Layer(const PixelSize& size, GLint filter)
    : texture(gl::make_texture(GL_RG32F, GL_RG, GL_FLOAT, size.width, size.height, filter)),
      framebuffer(gl::Framebuffer::make()) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture.get(), 0);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
}

CavityPass::CavityPass(const PixelSize& size, int reach_px)
    : reach_of_height_(static_cast<double>(reach_px) / size.height),
      size_{shrunk(size.width, reach_px), shrunk(size.height, reach_px)},
      small_(size_, GL_NEAREST),
      half_blurred_(size_, GL_NEAREST),
      blurred_(size_, GL_LINEAR),
      linear_depth_(kDepthFragment),
      blur_(kBlurFragment) {}

void CavityPass::blur(GLuint depths, double near_mm, double far_mm) const {
  glDisable(GL_DEPTH_TEST);
  glUseProgram(linear_depth_.get());
  glUniform2f(glGetUniformLocation(linear_depth_.get(), "near_far"), static_cast<float>(near_mm),
              static_cast<float>(far_mm));
  draw(linear_depth_, small_, depths);
  glUseProgram(blur_.get());
  const GLint pace = glGetUniformLocation(blur_.get(), "pace");
  glUniform2f(pace, 1.0f / static_cast<float>(size_.width), 0);
  draw(blur_, half_blurred_, small_.texture.get());
  glUniform2f(pace, 0, 1.0f / static_cast<float>(size_.height));
  draw(blur_, blurred_, half_blurred_.texture.get());
  glEnable(GL_DEPTH_TEST);
}

void CavityPass::draw(const gl::ScreenProgram& program, const Layer& target, GLuint source) const {
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.get());
  glViewport(0, 0, size_.width, size_.height);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, source);
  program.draw();
}

}  // namespace osteomill
