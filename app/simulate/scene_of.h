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

/// Returns the plane of a cut, reversed if `other_side` is set.
ClipPlane plane_of(const ViewState::SectionPlane& cut);
/// Returns the planes of the active cuts.
std::vector<ClipPlane> planes_of(const ViewState& view);

/// Returns the scene to draw now.
ViewScene scene_of(const ViewState& view, Simulation& simulation);
ViewScene scene_of(const ViewState& view, const Playback& playback);

/// Resamples the grey values on the cuts when their planes move, and a few times a second while bone is
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

/// Resets the cuts: three along the patient's axes and one facing the camera, all off, with the initial grey
/// values.
void reset_cuts(ViewState& view);

/// Places a cut that is switched on at the burr's centre, or at the nearest end of the bone, and selects the
/// side that leaves bone visible.
void begin_cut_at(const ViewState& view, ViewState::SectionPlane& cut, const Vec3& tool_W);

}  // namespace osteomill::app
