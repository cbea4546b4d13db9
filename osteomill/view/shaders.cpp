#include "osteomill/view/shaders.h"

namespace osteomill::shaders {

const std::string_view kBoneVertex = R"(
layout(location = 0) in vec3 position_W;
layout(location = 1) in vec3 normal_W;
layout(location = 2) in float density;
layout(location = 3) in vec4 label;
uniform mat4 camera_from_world;
uniform mat4 clip_from_camera;
#ifdef CUT
uniform vec4 cuts[4];
out float gl_ClipDistance[4];
#endif
out vec3 normal_C;
out float depth_mm;
out float bone_density;
out vec4 label_colour;
void main() {
  vec4 position_C = camera_from_world * vec4(position_W, 1.0);
  gl_Position = clip_from_camera * position_C;
  normal_C = mat3(camera_from_world) * normal_W;
  depth_mm = -position_C.z;
  bone_density = density;
  label_colour = vec4(label.rgb * label.a, label.a);
#ifdef CUT
  for (int n = 0; n < 4; ++n) gl_ClipDistance[n] = dot(cuts[n].xyz, position_W) - cuts[n].w;
#endif
}
)";

// A key light over the viewer's left shoulder, a weaker one from the right, and light from all around that is
// another from below. Bone that lies deeper than what is around it in the picture (blurred_depth,
// of the picture before) gets less of all of them.
const std::string_view kBoneFragment = R"(#version 330 core
in vec3 normal_C;
in float depth_mm;
in float bone_density;
in vec4 label_colour;  // times its share
uniform float label_share;
uniform float isovalue;
uniform float reference_density;
uniform vec2 picture_size;
uniform vec3 light_from_below;
uniform float cavity_scale;  // 1 / mm, at a depth of 1 mm
uniform sampler2D blurred_depth;
out vec4 colour;
const vec3 kSoft = vec3(0.76, 0.52, 0.40);
const vec3 kBone = vec3(0.87, 0.76, 0.58);
const vec3 kEnamel = vec3(0.93, 0.91, 0.86);
const vec3 kTowardsKey = vec3(-0.4504, 0.6005, 0.6606);
const vec3 kTowardsFill = vec3(0.8053, -0.0537, 0.5905);
const vec3 kHalfWay = vec3(-0.2471, 0.3295, 0.9113);
void main() {
  vec3 n = normalize(normal_C);
  float share = (bone_density - isovalue) / max(reference_density - isovalue, 1e-6);
  vec3 base = share < 1.0 ? mix(kSoft, kBone, smoothstep(0.05, 0.85, share))
                          : mix(kBone, kEnamel, smoothstep(1.05, 2.1, share));
  base = (1.0 - label_share * label_colour.a) * base + label_share * label_colour.rgb;
  if (!gl_FrontFacing) {
    colour = vec4(0.42 * base, 1.0);
    return;
  }
  vec2 around = texture(blurred_depth, gl_FragCoord.xy / picture_size).rg;
  float sunk = around.g > 0.05 ? (depth_mm - around.r / around.g) * cavity_scale / depth_mm : 0.0;
  // Towards its outline everything lies deeper than the middle of the picture's bone: that is no cavity.
  sunk *= smoothstep(0.3, 0.8, n.z);
  float open = 1.0 - 0.62 * smoothstep(0.0, 1.0, sunk) + 0.06 * smoothstep(0.0, 1.0, -sunk);
  float key = max(dot(n, kTowardsKey), 0.0);
  float fill = max(dot(n, kTowardsFill), 0.0);
  vec3 ambient = mix(light_from_below, vec3(0.33, 0.35, 0.39), 0.5 + 0.5 * n.y);
  float gloss = max(dot(n, kHalfWay), 0.0);
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= gloss;
  gloss *= 0.10 * gloss;
  vec3 light = ambient + 0.62 * key * vec3(1.0, 0.98, 0.94) + 0.22 * fill * vec3(0.88, 0.93, 1.0);
  colour = vec4((base * light + gloss) * open, 1.0);
}
)";

const std::string_view kSolidVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 camera_from_shape;
uniform mat3 normal_from_shape;
uniform mat4 clip_from_camera;
out vec3 normal_C;
void main() {
  gl_Position = clip_from_camera * (camera_from_shape * vec4(position, 1.0));
  normal_C = normal_from_shape * normal;
}
)";

const std::string_view kSolidFragment = R"(#version 330 core
in vec3 normal_C;
uniform vec4 base;
uniform float gloss;
out vec4 colour;
void main() {
  vec3 n = normalize(normal_C);
  vec3 towards_light = normalize(vec3(-0.45, 0.60, 0.66));
  float light = 0.50 + 0.10 * n.y + 0.50 * max(dot(n, towards_light), 0.0);
  float shine = gloss * pow(max(dot(n, normalize(towards_light + vec3(0.0, 0.0, 1.0))), 0.0), 40.0);
  colour = vec4(base.rgb * light + shine, base.a);
}
)";

// One triangle over the whole picture and behind everything, without any buffer.
const std::string_view kScreenVertex = R"(#version 330 core
out vec2 place;
void main() {
  place = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(2.0 * place - 1.0, 1.0, 1.0);
}
)";

// Depth in mm and 1, or zeros where there is nothing.
const std::string_view kDepthFragment = R"(#version 330 core
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

const std::string_view kBlurFragment = R"(#version 330 core
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

const std::string_view kBackgroundFragment = R"(#version 330 core
in vec2 place;
out vec4 colour;
void main() {
  colour = vec4(mix(vec3(0.075, 0.085, 0.105), vec3(0.20, 0.23, 0.28), place.y), 1.0);
}
)";

const std::string_view kPictureFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D picture;
out vec4 colour;
void main() { colour = texture(picture, place); }
)";

const std::string_view kCutVertex = R"(#version 330 core
layout(location = 0) in vec3 position_W;
layout(location = 1) in vec2 place_on_cut;
uniform mat4 camera_from_world;
uniform mat4 clip_from_camera;
uniform vec4 cuts[4];
out float gl_ClipDistance[4];
out vec2 place;
void main() {
  gl_Position = clip_from_camera * (camera_from_world * vec4(position_W, 1.0));
  place = place_on_cut;
  for (int n = 0; n < 4; ++n) gl_ClipDistance[n] = dot(cuts[n].xyz, position_W) - cuts[n].w;
}
)";

// Grey values, or labels' colours; what is as dark as air lets the view through.
const std::string_view kCutFragment = R"(#version 330 core
in vec2 place;
uniform sampler2D pixels;
out vec4 colour;
void main() {
  colour = vec4(texture(pixels, place).rgb, 1.0);
  if (max(colour.r, max(colour.g, colour.b)) < 0.14) discard;
}
)";

}  // namespace osteomill::shaders
