#pragma once
// How long Morton keys must be in a scene. Short ones are sorted by counting, in a third of the time; but
// they tell only about as many cells apart as there are bodies, evenly over the extent, and within a crowded
// cell neighbours in the order are no neighbours in space: queries then visit every body of the cell.
// Decided once, on the host, by what is known before the first step; says how fast a tree is, never what it
// finds.

#include "sim_cuda/scene/initial_bodies.h"

namespace collidoscope {

/// 30, or 63 where more bodies than a sort by counting keeps in order could come to lie in one cell: where
/// the box is so large that a heap of them would, packed as densely as spheres pack at random; or where there
/// is no box, since one body that flies away stretches the cells of all others.
int key_bits_called_for(const InitialBodies& bodies);

}  // namespace collidoscope
