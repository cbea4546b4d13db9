#include "osteomill/visual/picture_texture.h"

#include "view/gl_objects.h"

namespace osteomill {

struct PictureTexture::Impl {
  gl::Texture texture;
};

PictureTexture::PictureTexture(const Image& image) : impl_(std::make_unique<Impl>()) {
  impl_->texture = gl::make_texture(GL_RGB8, GL_RGB, GL_UNSIGNED_BYTE, image.width, image.height, GL_LINEAR);
  // RGB rows are not padded to four bytes.
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, image.width, image.height, GL_RGB, GL_UNSIGNED_BYTE,
                  image.rgb.data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

PictureTexture::~PictureTexture() = default;

unsigned PictureTexture::name() const {
  return impl_->texture.get();
}

}  // namespace osteomill
