#include "osteomill/view/gl_objects.h"

#include <array>
#include <stdexcept>
#include <string>

namespace osteomill::gl {

namespace {

template <typename Object>
Object made_by(void (*generate)(GLsizei, GLuint*)) {
  GLuint name = 0;
  generate(1, &name);
  return Object(name);
}

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

Buffer make_buffer() {
  return made_by<Buffer>([](GLsizei n, GLuint* names) { glGenBuffers(n, names); });
}

VertexArray make_vertex_array() {
  return made_by<VertexArray>([](GLsizei n, GLuint* names) { glGenVertexArrays(n, names); });
}

Framebuffer make_framebuffer() {
  return made_by<Framebuffer>([](GLsizei n, GLuint* names) { glGenFramebuffers(n, names); });
}

Texture make_texture(GLint internal_format, GLenum format, GLenum type, int width, int height, GLint filter) {
  Texture texture = made_by<Texture>([](GLsizei n, GLuint* names) { glGenTextures(n, names); });
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
  Program program(glCreateProgram());
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

}  // namespace osteomill::gl
