#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "osteomill/image/image.h"
#include "osteomill/view/camera.h"

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
/// For one triangle over the whole picture and behind everything, without any buffer. The fragment takes `in
/// vec2 place`, 0 to 1 across the picture.
Program make_screen_program(std::string_view fragment_source);

/// Binds the buffer to `target` and fills it.
template <typename Value>
void fill(GLenum target, const Buffer& buffer, std::span<const Value> values, GLenum usage) {
  glBindBuffer(target, buffer.get());
  glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), usage);
}

/// An attribute of `count` floats, so many bytes into each vertex, in the buffer and array that are bound.
void set_attribute(GLuint place, GLint count, std::size_t vertex_bytes, std::size_t offset_bytes);

}  // namespace osteomill::gl

namespace osteomill {

/// What is drawn into: colours and depths of one size, as textures.
class FrameTarget {
 public:
  explicit FrameTarget(const PixelSize& size);

  const PixelSize& size() const { return size_; }
  void bind() const;
  GLuint framebuffer() const { return framebuffer_.get(); }
  GLuint colours() const { return colours_.get(); }
  GLuint depths() const { return depths_.get(); }
  Image read() const;
  /// 0 to 1, row by row from the bottom.
  std::vector<float> read_depths() const;

 private:
  PixelSize size_;
  gl::Texture colours_;
  gl::Texture depths_;
  gl::Framebuffer framebuffer_;
};

}  // namespace osteomill
