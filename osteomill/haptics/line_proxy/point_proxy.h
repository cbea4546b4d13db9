#pragma once

#include "osteomill/haptics/line_proxy/bone_surface.h"
#include "osteomill/volume/volume.h"

namespace osteomill::line_proxy {

/// The 3-DOF point proxy on the isosurface: a point that follows a probe but never enters the bone. The paper
/// takes it from earlier work without describing it; this is the usual one (Zilles and Salisbury 1995,
/// Ruspini 1997) on an isosurface. In turns it
/// - marches straight toward the probe until bone is in the way, also where milling has taken the bone from
/// under it;
/// - slides in the tangent plane to the point nearest to the probe, and comes back to the isosurface along
/// the normal. It rests where the line to the probe is within the cone of friction about the surface's normal
/// (Harwin and Melder 2002): `friction` is the coefficient, 0 for none. The answer is the probe itself
/// where the way to it is free. A proxy that starts in bone is first brought out along the normal; where that
/// fails it stays. Safe in the haptic tick.
Vec3 move_point_proxy(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W,
                      const NormalRule& normal, double friction);

}  // namespace osteomill::line_proxy
