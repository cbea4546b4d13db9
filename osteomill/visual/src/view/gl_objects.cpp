#include "view/gl_objects.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include "osteomill/visual/scene_renderer.h"

namespace osteomill::gl {

namespace {

constexpr std::string_view kScreenVertex = R"(#version 330 core
out vec2 place;
void main() {
  place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2.0 * place - 1.0, 1.0, 1.0);
}
)";

GLuint compiled(GLenum kind, std::string_view source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.data();
  const auto length = static_cast<GLint>(source.size());
  glShaderSource(shader, 1, &text, &length);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == 0) {
    std::array<char, 2000> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glDeleteShader(shader);
    throw std::runtime_error(std::string("OpenGL refuses a shader: ") + log.data());
  }
  return shader;
}

}  // namespace

Texture make_texture(GLint internal_format, GLenum format, GLenum type, int width, int height, GLint filter) {
  Texture texture = Texture::make();
  glBindTexture(GL_TEXTURE_2D, texture.get());
  glTexImage2D(GL_TEXTURE_2D, 0, internal_format, width, height, 0, format, type, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return texture;
}

Program make_program(std::string_view vertex_source, std::string_view fragment_source) {
  const GLuint vertex = compiled(GL_VERTEX_SHADER, vertex_source);
  const GLuint fragment = compiled(GL_FRAGMENT_SHADER, fragment_source);
  Program program = Program::make();
  for (const GLuint shader : {vertex, fragment}) {
    glAttachShader(program.get(), shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program.get());
  GLint good = 0;
  glGetProgramiv(program.get(), GL_LINK_STATUS, &good);
  if (good == 0) {
    std::array<char, 2000> log{};
    glGetProgramInfoLog(program.get(), static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("OpenGL refuses a program: ") + log.data());
  }
  return program;
}

ScreenProgram::ScreenProgram(std::string_view fragment_source)
    : program_(make_program(kScreenVertex, fragment_source)) {}

void ScreenProgram::draw() const {
  glUseProgram(program_.get());
  glBindVertexArray(no_buffers_.get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void set_attribute(GLuint place, GLint count, std::size_t vertex_bytes, std::size_t offset_bytes) {
  glEnableVertexAttribArray(place);
  glVertexAttribPointer(place, count, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(vertex_bytes),
                        reinterpret_cast<const void*>(offset_bytes));
}

}  // namespace osteomill::gl

namespace osteomill {

FrameTarget::FrameTarget(const PixelSize& size)
    : size_(size),
      // Same channel order as a window's framebuffer, which avoids a conversion when copying.
      colours_(gl::make_texture(GL_RGBA8, GL_BGRA, GL_UNSIGNED_BYTE, size.width, size.height, GL_NEAREST)),
      depths_(gl::make_texture(GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, size.width,
                               size.height, GL_NEAREST)),
      framebuffer_(gl::Framebuffer::make()) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colours_.get(), 0);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depths_.get(), 0);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL refuses a framebuffer");
  }
}

void FrameTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.get());
  glViewport(0, 0, size_.width, size_.height);
}

Image FrameTarget::read() const {
  return read_framebuffer(framebuffer_.get(), size_);
}

std::vector<float> FrameTarget::read_depths() const {
  std::vector<float> depths(static_cast<std::size_t>(size_.width) * static_cast<std::size_t>(size_.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_.get());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size_.width, size_.height, GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
  return depths;
}

Image read_framebuffer(unsigned framebuffer, const PixelSize& size) {
  Image image{size.width, size.height, {}};
  const std::size_t row = 3 * static_cast<std::size_t>(size.width);
  std::vector<unsigned char> upside_down(row * static_cast<std::size_t>(size.height));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, size.width, size.height, GL_RGB, GL_UNSIGNED_BYTE, upside_down.data());
  image.rgb.resize(upside_down.size());
  for (std::size_t y = 0; y < static_cast<std::size_t>(size.height); ++y) {
    std::copy_n(upside_down.end() - static_cast<std::ptrdiff_t>((y + 1) * row), row,
                image.rgb.begin() + static_cast<std::ptrdiff_t>(y * row));
  }
  return image;
}

}  // namespace osteomill
