#pragma once

#include <string_view>

namespace osteomill::shaders {

/// GLSL 3.30. What each takes and gives is said in its text.
extern const std::string_view kBoneVertex;
extern const std::string_view kBoneFragment;
extern const std::string_view kSolidVertex;
extern const std::string_view kSolidFragment;
extern const std::string_view kScreenVertex;
extern const std::string_view kDepthFragment;
extern const std::string_view kBlurFragment;
extern const std::string_view kBackgroundFragment;
extern const std::string_view kPictureFragment;
extern const std::string_view kCutVertex;
extern const std::string_view kCutFragment;

}  // namespace osteomill::shaders
