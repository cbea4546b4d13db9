#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "osteomill/visual/scene_renderer.h"

#include "app/simulate/playback.h"
#include "app/simulate/simulation.h"
#include "app/simulate/view_state.h"

namespace osteomill::app {

/// Returns the plane of a cut; its `other_side` turns it round.
ClipPlane plane_of(const ViewState::Cut& cut);
/// Returns the planes of the cuts that are on.
std::vector<ClipPlane> planes_of(const ViewState& view);

/// Returns the scene to be drawn now.
ViewScene scene_of(const ViewState& view, Simulation& simulation);
ViewScene scene_of(const ViewState& view, const Playback& playback);

/// Samples the grey values on the cuts again as their planes move, and a few times a second as bone is
/// milled.
class CutUpdates {
 public:
  /// `labels` colour the cuts; null for none.
  void update(const ViewState& view, const BoneFollower& bone, const WindowLevel& grey_window,
              const LabelMap* labels, SceneRenderer& renderer);

 private:
  struct Shown {
    ClipPlane plane;
    const LabelMap* labels;
    WindowLevel grey;
    std::uint64_t bone_version;
  };
  std::array<std::optional<Shown>, kMaxClipPlanes> shown_;
  int pictures_ = 0;
};

/// Three planes across the patient and one that faces the camera, all off, in the first grey values.
void reset_cuts(ViewState& view);

/// A cut that is switched on begins at the burr's centre, or at the end of the bone nearest to it; on the
/// side that leaves bone to be seen.
void begin_cut_at(const ViewState& view, ViewState::Cut& cut, const Vec3& tool_W);

}  // namespace osteomill::app
