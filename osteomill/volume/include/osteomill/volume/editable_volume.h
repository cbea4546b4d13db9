#pragma once

#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Edits a bone in ways that milling cannot: densities may rise and the isovalue may change. No session may
/// mill or render the bone from this object's construction until its last call; algorithms prepared
/// afterwards see the edited bone. Not for the tick.
class EditableVolume {
 public:
  /// `bone` must outlive this object.
  explicit EditableVolume(Volume& bone) : bone_(bone) {}

  /// Swaps the block's densities with the bone's: a second call undoes the first. Returns a box that contains
  /// the changed voxels. If a density rose, the bone's ranges around it are recomputed exactly.
  VoxelBox swap(DensityBlock& block);
  /// Sets the isovalue. Throws std::invalid_argument if it is not finite.
  void set_isovalue(double isovalue) { bone_.set_isovalue(isovalue); }

 private:
  Volume& bone_;
};

}  // namespace osteomill
