// Marks of contacts, as they reach the picture.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/gl_fixture.h"
#include "viewer/render/colors.h"

namespace collidoscope {
namespace {

constexpr int size = 200;

/// One contact in the middle of the box, seen along its normal: the ring, and of the needle only its end.
Image contact_of(float impulse, double strongest, bool from_the_side = false) {
  test_context();
  Renderer renderer(size, size);
  Scene scene;
  scene.box = Box{};
  InitialBodies bodies;
  bodies.box = scene.box;
  renderer.set_scene(frame_scene(scene, bodies));
  ContactInstance contact{};
  for (float& x : contact.point) x = 50;
  contact.normal[2] = 1;
  contact.radius = 40;
  contact.impulse = impulse;
  renderer.instances().upload(std::span<const ContactInstance>(&contact, 1));
  OrbitCamera camera = frame_all(renderer.scene().bounds, 1, {});
  camera.azimuth = -0.5 * M_PI;
  camera.elevation = from_the_side ? 0 : 0.5 * M_PI;
  camera.orthographic = true;
  const FrameLayers layers{.contacts = true, .grid = false, .walls = false, .overlay = false};
  renderer.draw(camera, layers, {0, 1, strongest});
  return renderer.read_picture();
}

/// Pixels that are nothing of the backdrop, which is grey.
int reddish(const Image& image) {
  int count = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) count += image.rgba[i] > image.rgba[i + 1] + 40;
  return count;
}
int near_white(const Image& image) {
  int count = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    count += image.rgba[i] > 200 && image.rgba[i + 1] > 150 && image.rgba[i + 2] > 130;
  return count;
}

/// Greatest red, green and blue of the ring's rim.
Rgb ring_color(const Image& image) {
  Rgb most;
  for (int x = size / 2 + 6; x < size; ++x) {  // beyond the needle's end
    const std::size_t at = 4 * static_cast<std::size_t>(size * (size / 2) + x);
    most = {std::max(most.r, image.rgba[at] / 255.0f), std::max(most.g, image.rgba[at + 1] / 255.0f),
            std::max(most.b, image.rgba[at + 2] / 255.0f)};
  }
  return most;
}

TEST(ContactMark, TakesTheColourOfItsImpulse) {
  for (const auto& [impulse, share] : {std::pair{1000.0f, 1.0}, {31.623f, 0.5}, {1.0f, 0.0}, {0.0f, 0.0}}) {
    const Rgb seen = ring_color(contact_of(impulse, 1000)), expected = contact_color(share);
    EXPECT_NEAR(seen.r, expected.r, 0.06) << impulse;
    EXPECT_NEAR(seen.g, std::max(expected.g, 0.2f), 0.08) << impulse;
  }
  // Unknown: as the middle of the scale.
  EXPECT_EQ(contact_of(0, 0), contact_of(5, 0));
  EXPECT_NEAR(ring_color(contact_of(0, 0)).g, contact_color(0.5).g, 0.06);
}

TEST(ContactMark, ItsNeedleGrowsWithTheImpulse) {
  const int weak = near_white(contact_of(1, 1000, true)),
            middling = near_white(contact_of(31.623f, 1000, true)),
            strong = near_white(contact_of(1000, 1000, true));
  EXPECT_GT(middling, 1.2 * weak);
  EXPECT_GT(strong, 1.2 * middling);
  EXPECT_GT(reddish(contact_of(31.623f, 1000)), 100);
}

}  // namespace
}  // namespace collidoscope
