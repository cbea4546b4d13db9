#pragma once

#include <string_view>
#include <utility>

#include <epoxy/gl.h>

namespace osteomill::gl {

/// Owns an OpenGL object of the context that is current now and at its end.
template <void (*Delete)(GLuint)>
class Handle {
 public:
  Handle() = default;
  explicit Handle(GLuint name) : name_(name) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Handle& operator=(Handle&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = std::exchange(other.name_, 0);
    }
    return *this;
  }
  GLuint get() const { return name_; }

 private:
  void reset() {
    if (name_ != 0) Delete(name_);
    name_ = 0;
  }
  GLuint name_ = 0;
};

inline void delete_buffer(GLuint name) {
  glDeleteBuffers(1, &name);
}
inline void delete_vertex_array(GLuint name) {
  glDeleteVertexArrays(1, &name);
}
inline void delete_texture(GLuint name) {
  glDeleteTextures(1, &name);
}
inline void delete_framebuffer(GLuint name) {
  glDeleteFramebuffers(1, &name);
}
inline void delete_program(GLuint name) {
  glDeleteProgram(name);
}

using Buffer = Handle<delete_buffer>;
using VertexArray = Handle<delete_vertex_array>;
using Texture = Handle<delete_texture>;
using Framebuffer = Handle<delete_framebuffer>;
using Program = Handle<delete_program>;

Buffer make_buffer();
VertexArray make_vertex_array();
Framebuffer make_framebuffer();

/// A texture of one level. Edges are clamped.
Texture make_texture(GLint internal_format, GLenum format, GLenum type, int width, int height, GLint filter);

/// Throws std::runtime_error with the driver's complaint.
Program make_program(std::string_view vertex_source, std::string_view fragment_source);

}  // namespace osteomill::gl
