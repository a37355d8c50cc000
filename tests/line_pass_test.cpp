// Tests the drawing of boxes and contact marks. All boxes must be visible at any count: wide lines for few,
// thin lines for many.

#include "viewer/render/line_pass.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/gl_fixture.h"
#include "viewer/render/colors.h"

namespace collidoscope {
namespace {

constexpr int plan_width = 640, plan_height = 480;

/// An orthographic view from above, 120 m high: four pixels per metre.
OrbitCamera plan_view() {
  OrbitCamera camera;
  camera.orthographic = true;
  camera.field_of_view = 1;
  camera.distance = 60 / std::tan(0.5);
  camera.target = {50, 50, 50};
  camera.elevation = std::numbers::pi / 2;
  camera.azimuth = -std::numbers::pi / 2;
  return camera;
}

Image draw_plan(const std::vector<BoxInstance>& boxes, int last_level) {
  const TestBodies none = test_spheres(0, 1, 1);
  Renderer renderer(plan_width, plan_height, {.supersampling = 1, .light = Quality::quick});
  renderer.set_scene(frame_scene(none.scene, none.initial));
  renderer.instances().upload(std::span<const BoxInstance>(boxes));
  renderer.draw(plan_view(),
                {.boxes = !boxes.empty(), .last_level = last_level, .grid = false, .walls = false}, {0, 1});
  return renderer.read_picture();
}

/// Counts the pixels that differ within `reach` pixels of a point of the plan, in m.
int changed_near(const Image& a, const Image& b, double x, double y, int reach) {
  const int middle_x = static_cast<int>(4 * (x - 50) + plan_width / 2.0),
            middle_y = static_cast<int>(4 * (50 - y) + plan_height / 2.0);
  int changed = 0;
  for (int py = middle_y - reach; py <= middle_y + reach; ++py)
    for (int px = middle_x - reach; px <= middle_x + reach; ++px)
      for (int k = 0; k < 3; ++k) {
        const auto at = 4 * (static_cast<std::size_t>(py) * plan_width + static_cast<std::size_t>(px)) +
                        static_cast<std::size_t>(k);
        if (std::abs(a.rgba[at] - b.rgba[at]) > 12) {
          ++changed;
          break;
        }
      }
  return changed;
}

TEST(LinePass, EveryBoxLeavesItsMarkThinOrBroad) {
  test_context();
  const Image nothing = draw_plan({}, 0);
  // A root, and more children than the limit for wide lines.
  std::vector<BoxInstance> boxes{box_instance({-4, -4, 0}, {104, 104, 100}, 0)};
  for (int i = 0; i < 100 * 100; ++i)
    boxes.push_back(box_instance({i % 100 + 0.0, i / 100 + 0.0, 40}, {i % 100 + 0.6, i / 100 + 0.6, 60}, 1));
  ASSERT_GT(static_cast<std::int64_t>(boxes.size()), LinePass::max_broad_boxes);
  const Image many = draw_plan(boxes, 1);
  for (int i = 0; i < 100 * 100; ++i)
    ASSERT_GE(changed_near(many, nothing, i % 100 + 0.3, i / 100 + 0.3, 1), 3) << i;

  // The root keeps its line width. The children are thinner than in a small set.
  const std::vector<BoxInstance> few(boxes.begin(), boxes.begin() + 5000);
  const Image broad = draw_plan(few, 1);
  EXPECT_EQ(changed_near(broad, nothing, 50, -4, 4), changed_near(many, nothing, 50, -4, 4));
  EXPECT_GT(changed_near(broad, nothing, 49.3, 20.3, 8), changed_near(many, nothing, 49.3, 20.3, 8));
}

TEST(LinePass, BuffersLargerThanAShaderReachesAreDrawnToTheEnd) {
  test_context();
  const Image nothing = draw_plan({}, 0);
  // All but the first and the last few are behind the camera.
  std::vector<BoxInstance> boxes((1 << 20) + 9, box_instance({1000, 1000, 1000}, {1000, 1000, 1000}, 3));
  boxes.front() = box_instance({10, 10, 40}, {20, 20, 60}, 3);
  for (int i = 0; i < 12; ++i)
    boxes.end()[i - 12] = box_instance({10.0 + 6 * i, 50, 40}, {13.0 + 6 * i, 53, 60}, 3);
  const Image picture = draw_plan(boxes, 3);
  EXPECT_GT(changed_near(picture, nothing, 10, 10, 2), 0);
  for (int i = 0; i < 12; ++i) EXPECT_GT(changed_near(picture, nothing, 10.0 + 6 * i, 50, 2), 0) << i;
  EXPECT_EQ(changed_near(picture, nothing, 90, 90, 20), 0);
}

/// A box full of spheres, a box for each and for every eight of them, and as many contacts.
struct Crowd {
  TestBodies spheres = test_spheres(40'000, 2.5, 3);
  std::vector<BoxInstance> boxes;
  std::vector<ContactInstance> contacts;

  Crowd() {
    boxes.push_back(box_instance({0, 0, 0}, {100, 100, 100}, 0));
    for (const BodyInstance& body : spheres.instances) {
      const Vector3d center(body.center[0], body.center[1], body.center[2]);
      const double r = body.radius;
      if (boxes.size() % 8 == 0)
        boxes.push_back(box_instance(center - Vector3d::Constant(3), center + Vector3d::Constant(4), 2));
      boxes.push_back(box_instance(center - Vector3d::Constant(r), center + Vector3d::Constant(r), 2));
      ContactInstance contact{};
      for (int k = 0; k < 3; ++k) contact.point[k] = body.center[k] + (k == 0 ? body.radius : 0);
      contact.normal[0] = 1;
      contact.radius = body.radius;
      contacts.push_back(contact);
    }
  }
};

/// Draws with or without culling.
struct CrowdPicture {
  Renderer renderer;
  CrowdPicture(const Crowd& crowd, bool cull, int samples)
      : renderer(plan_width, plan_height,
                 {.supersampling = samples, .light = Quality::quick, .cull_lines = cull}) {
    renderer.set_scene(frame_scene(crowd.spheres.scene, crowd.spheres.initial));
    renderer.instances().upload(std::span<const BodyInstance>(crowd.spheres.instances));
    renderer.instances().upload(std::span<const BoxInstance>(crowd.boxes));
    renderer.instances().upload(std::span<const ContactInstance>(crowd.contacts));
  }
  Image draw(const OrbitCamera& camera, const FrameLayers& layers) {
    renderer.draw(camera, layers, {0, 1});
    return renderer.read_picture();
  }
};

TEST(LinePass, WhatIsLeftOutBeforeItIsDrawnWouldNotHaveBeenSeen) {
  test_context();
  const Crowd crowd;
  ASSERT_GT(static_cast<std::int64_t>(crowd.boxes.size()), LinePass::max_broad_boxes);
  const FrameLayers everything{.spheres = true, .boxes = true, .last_level = 2, .contacts = true},
      lines_alone{.boxes = true, .last_level = 2, .contacts = true, .grid = false};
  const OrbitCamera all = frame_all({{0, 0, 0}, {100, 100, 100}}, 4.0 / 3, {});
  OrbitCamera inside = all, near = all, beside = all, flat = all;
  inside.distance = 20;  // inside the crowd: some bodies cross the near plane
  near.distance = 90;
  beside.target += Vector3d(90, 40, 0);  // half of the crowd is outside the picture
  flat.orthographic = true;
  CrowdPicture culled(crowd, true, 1), whole(crowd, false, 1);
  for (const OrbitCamera& camera : {all, inside, near, beside, flat})
    for (const FrameLayers& layers : {everything, lines_alone})
      EXPECT_TRUE(culled.draw(camera, layers) == whole.draw(camera, layers))
          << "distance " << camera.distance;
  EXPECT_TRUE(CrowdPicture(crowd, true, 2).draw(near, everything) ==
              CrowdPicture(crowd, false, 2).draw(near, everything));
  // These pictures contain boxes and contacts.
  FrameLayers no_boxes = everything, no_contacts = everything;
  no_boxes.boxes = no_contacts.contacts = false;
  const Image both = culled.draw(all, everything);
  EXPECT_FALSE(both == culled.draw(all, no_boxes));
  EXPECT_FALSE(both == culled.draw(all, no_contacts));
}

constexpr int size = 200;

/// One contact in the middle of the box, seen along its normal: the ring and the tip of the needle.
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

/// Counts reddish pixels. The background is grey.
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

/// Largest red, green and blue of the ring's rim.
Rgb ring_color(const Image& image) {
  Rgb most;
  for (int x = size / 2 + 6; x < size; ++x) {  // beyond the tip of the needle
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
  // With an unknown scale the colour is that of its middle.
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
