#pragma once

#include "osteomill/surface/brick_mesh.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

/// The label, by its place in the map, of the bone just under a vertex of the surface, no more than 1.5
/// voxels deep: of a scan's label map the outermost voxels are often left out. 0 where there is none.
LabelMap::Place label_below(const LabelMap& labels, const MeshVertex& vertex);

}  // namespace osteomill
