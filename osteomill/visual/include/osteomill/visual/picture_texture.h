#pragma once

#include <memory>

#include "osteomill/visual/image.h"

namespace osteomill {

/// A picture as a texture of the OpenGL context that is current when it is made and destroyed.
class PictureTexture {
 public:
  explicit PictureTexture(const Image& image);
  ~PictureTexture();
  PictureTexture(const PictureTexture&) = delete;
  PictureTexture& operator=(const PictureTexture&) = delete;

  /// Returns OpenGL's name of the texture.
  unsigned name() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteomill
