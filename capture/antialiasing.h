#pragma once
// Recognises pixels of anti-aliased edges, after V. Vyšniauskas, Anti-aliased Pixel and Intensity Slope
// Detector, 2009.

#include <collidoscope/picture.h>

namespace collidoscope::capture {

/// Whether pixel (x, y) of `picture` lies on an anti-aliased edge: at most two of its neighbours are equal to
/// it, some are darker and some lighter, and the darkest or the lightest of them belongs to a flat area of
/// both pictures.
bool is_antialiased(const Pixels& picture, const Pixels& other, int x, int y);

}  // namespace collidoscope::capture
