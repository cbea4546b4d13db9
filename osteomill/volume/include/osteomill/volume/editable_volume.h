#pragma once

#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Changes a bone that nothing follows, in ways that milling cannot: densities may rise, and the isovalue may
/// change. No session mills or feels the bone from when this is made until its last call; an algorithm that
/// is prepared later sees the bone as it then is. Not for the tick.
class EditableVolume {
 public:
  /// Makes the bone editable. `bone` outlives this object.
  explicit EditableVolume(Volume& bone) : bone_(bone) {}

  /// Puts the block's densities into the bone, and the bone's into the block: a second call undoes the first.
  /// Returns which voxels changed. The bone's ranges are exact again if a density rose.
  VoxelBox swap(DensityBlock& block);
  /// Sets the density above which there is bone from now on. Throws std::invalid_argument if it is not
  /// finite.
  void set_isovalue(double isovalue) { bone_.set_isovalue(isovalue); }

 private:
  Volume& bone_;
};

}  // namespace osteomill
