#pragma once
// A scene as the contents of a file in another folder.

#include <string>

#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// The scene with its relative paths from `folder`. Throws InputError if a file of bodies is not in that
/// folder or below it, where a scene may not refer to it.
Scene relocated_scene(Scene scene, const std::string& folder);

}  // namespace collidoscope
