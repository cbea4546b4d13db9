#pragma once

#include <memory>

#include "osteomill/visual/image.h"

namespace osteomill {

/// An image as a texture of the OpenGL context, which must be current at construction and destruction.
class PictureTexture {
 public:
  explicit PictureTexture(const Image& image);
  ~PictureTexture();
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;

  /// Returns the OpenGL texture name.
  unsigned name() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
