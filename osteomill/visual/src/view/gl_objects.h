#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <epoxy/gl.h>

#include "osteomill/visual/camera.h"
#include "osteomill/visual/image.h"

namespace osteomill::gl {

/// Owns an OpenGL object. The same context must be current at creation and destruction.
template <auto& Create, auto& Delete>
class GlObject {
 public:
  /// Holds no object (name 0).
  GlObject() = default;
  static GlObject make() {
    GlObject made;
    Create(1, &made.name_);
    return made;
  }
  ~GlObject() {
    if (name_ != 0) Delete(1, &name_);
  }
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  GLuint get() const { return name_; }

 private:
  GLuint name_ = 0;
};

inline void create_program(GLsizei, GLuint* name) {
  *name = glCreateProgram();
}
inline void delete_program(GLsizei, const GLuint* name) {
  glDeleteProgram(*name);
}

using Buffer = GlObject<glGenBuffers, glDeleteBuffers>;
using VertexArray = GlObject<glGenVertexArrays, glDeleteVertexArrays>;
using Texture = GlObject<glGenTextures, glDeleteTextures>;
using Framebuffer = GlObject<glGenFramebuffers, glDeleteFramebuffers>;
using Program = GlObject<create_program, delete_program>;

/// Creates a texture without mipmaps, clamped to its edge.
Texture make_texture(GLint internal_format, GLenum format, GLenum type, int width, int height, GLint filter);

/// Compiles and links a program. Throws std::runtime_error with the driver's log.
Program make_program(std::string_view vertex_source, std::string_view fragment_source);

/// Draws one triangle that covers the whole picture, at maximum depth. The fragment shader receives `in vec2
/// place`, 0 to 1 across the picture.
class ScreenProgram {
 public:
  explicit ScreenProgram(std::string_view fragment_source);
  GLuint get() const { return program_.get(); }
  /// Draws with the bound texture and current uniforms.
  void draw() const;

 private:
  Program program_;
  // OpenGL core draws nothing without a vertex array, even if the shader needs no buffers.
  VertexArray no_buffers_ = VertexArray::make();
};

/// Binds the buffer to `target` and uploads the values.
template <typename Value>
void fill(GLenum target, const Buffer& buffer, std::span<const Value> values, GLenum usage) {
  glBindBuffer(target, buffer.get());
  glBufferData(target, static_cast<GLsizeiptr>(values.size_bytes()), values.data(), usage);
}

/// Sets an attribute of `count` floats, `offset_bytes` into each vertex, for the bound buffer and vertex
/// array.
void set_attribute(GLuint place, GLint count, std::size_t vertex_bytes, std::size_t offset_bytes);

}  // namespace osteomill::gl

namespace osteomill {

/// Offscreen render target: colour and depth textures of one size.
class FrameTarget {
 public:
  explicit FrameTarget(const PixelSize& size);

  const PixelSize& size() const { return size_; }
  void bind() const;
  GLuint framebuffer() const { return framebuffer_.get(); }
  GLuint colours() const { return colours_.get(); }
  GLuint depths() const { return depths_.get(); }
  Image read() const;
  /// Returns the depths, 0 to 1, row by row from the bottom.
  std::vector<float> read_depths() const;

 private:
  PixelSize size_;
  gl::Texture colours_;
  gl::Texture depths_;
  gl::Framebuffer framebuffer_;
};

}  // namespace osteomill
