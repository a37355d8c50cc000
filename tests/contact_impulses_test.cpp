// Tests the recorded contact impulses against momentum: their sum is the momentum change of each body.

#include "sim_cuda/solver/contact_impulses.h"
#include "sim_cuda/run/published_records.h"

#include <algorithm>
#include <map>

#include "tests/executors.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

class Impulses : public OnEachExecutor {};
ON_EACH_EXECUTOR(Impulses);

double relative(double value, double expected) { return std::abs(value - expected) / std::abs(expected); }

TEST_P(Impulses, OfTwoSpheresHeadOn) {
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const double e : {0.0, 0.25, 1.0}) {
      Scene scene = empty_space();
      scene.physics.precision = precision;
      scene.materials[0].restitution = e;
      scene.bodies = {sphere(1, Vector3d(0, 0, 0), Vector3d(3, 0, 0)),
                      sphere(0.5, Vector3d(1.45, 0, 0), Vector3d(-1, 0, 0))};
      scene.bodies[0].mass = 2;
      scene.bodies[1].mass = 6;
      World world(scene, options());
      world.records().record_impulses(true);
      EXPECT_TRUE(world.records().impulses().empty()) << "nothing has happened yet";
      world.step();
      const std::vector<ContactImpulse> list = world.records().impulses();
      ASSERT_EQ(list.size(), 1u);
      const double reduced_mass = 2.0 * 6 / (2 + 6), approach = 4;
      EXPECT_LT(relative(list[0].impulse, (1 + e) * reduced_mass * approach), 1e-6);
      EXPECT_EQ(world.measure().max_impulse, list[0].impulse);
      world.step();
      EXPECT_EQ(world.measure().max_impulse, 0) << "they part, or move on together";
    }
}

// Compares the momentum change of each body in a step with the recorded impulses, along the normals of the
// state before.
void expect_momentum(const Scene& scene, const RunOptions& options, int steps, double tolerance) {
  World world(scene, options);
  world.records().record_impulses(true);
  std::size_t contacts = 0;
  for (int step = 0; step < steps; ++step) {
    const BodyStates before = world.bodies();
    world.step();
    const BodyStates after = world.bodies();
    std::vector<Vector3d> given(before.position.size(), Vector3d(0, 0, 0));
    double largest = 0;
    for (const ContactImpulse& contact : world.records().impulses()) {
      EXPECT_LT(contact.a, contact.b);
      EXPECT_GE(contact.impulse, 0);
      const Vector3d along = (before.position[contact.b] - before.position[contact.a]).normalized();
      given[contact.a] -= contact.impulse * along;
      given[contact.b] += contact.impulse * along;
      largest = std::max(largest, contact.impulse);
      ++contacts;
    }
    for (std::size_t i = 0; i < given.size(); ++i) {
      const Vector3d gained = world.initial().mass[i] * (after.velocity[i] - before.velocity[i]);
      EXPECT_LE((gained - given[i]).norm(), tolerance * std::max(largest, 1e-9)) << "body " << i;
    }
  }
  EXPECT_GT(contacts, 0u);
}

TEST_P(Impulses, PassAlongAChain) {
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.physics.iterations = 10;
  for (int i = 0; i < 6; ++i)
    scene.bodies.push_back(sphere(1, Vector3d(1.99 * i, 0, 0), Vector3d(i == 0 ? 2 : 0, 0, 0)));
  World world(scene, options());
  world.records().record_impulses(true);
  world.step();
  const double mass = world.initial().mass[0];
  const std::vector<ContactImpulse> list = world.records().impulses();
  ASSERT_EQ(list.size(), 5u);
  // Equal masses, elastic: each ball passes its whole momentum on.
  for (std::uint32_t k = 0; k < 5; ++k) {
    EXPECT_EQ(list[k].a, k);
    EXPECT_EQ(list[k].b, k + 1);
    EXPECT_LT(relative(list[k].impulse, 2 * mass), 1e-12) << k;
  }
  expect_momentum(scene, options(), 1, 1e-12);
}

TEST_P(Impulses, AreTheMomentumThatBodiesGain) {
  for (const int iterations : {1, 4}) {
    // A dense cloud without walls.
    Scene scene = empty_space();
    scene.materials[0].restitution = 0.5;
    scene.physics.precision = Precision::f64;
    scene.physics.iterations = iterations;
    Random random(7);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * (random() / 4294967296.0);
    };
    for (int i = 0; i < 300; ++i)
      scene.bodies.push_back(sphere(uniform(0.2, 1), Vector3d(uniform(-4, 4), uniform(-4, 4), uniform(-4, 4)),
                                    Vector3d(uniform(-5, 5), uniform(-5, 5), uniform(-5, 5))));
    expect_momentum(scene, options(), 4, 1e-9);
    scene.physics.precision = Precision::f32;
    expect_momentum(scene, options(), 4, 1e-3);
  }
}

TEST_P(Impulses, OfTheMassSplitSetToo) {
  // A giant sphere with more contacts than there are colours.
  Scene scene = empty_space();
  scene.physics.precision = Precision::f64;
  scene.physics.iterations = 2;
  scene.bodies.push_back(sphere(5, Vector3d(0, 0, 0)));
  Random random(3);
  for (int i = 0; i < 120; ++i) {
    Vector3d way(0, 0, 0);
    for (int axis = 0; axis < 3; ++axis) way[axis] = random() / 4294967296.0 - 0.5;
    way.normalize();
    scene.bodies.push_back(sphere(0.3, 5.25 * way, -3 * way));
  }
  World world(scene, options());
  world.step();
  ASSERT_GT(world.measure().uncoloured_contacts, 0);
  expect_momentum(scene, options(), 2, 1e-9);
}

TEST_P(Impulses, OfSeveralSubstepsAreThoseOfTheLast) {
  Scene whole = box_collider(400), parts = whole;
  whole.physics.substeps = 3;
  whole.physics.time_step = 3.0 / 64;
  parts.physics.time_step = 1.0 / 64;
  whole.physics.time_step = whole.physics.time_step.seconds();
  parts.physics.time_step = parts.physics.time_step.seconds();
  World a(whole, options()), b(parts, options());
  for (World* world : {&a, &b}) world->records().record_impulses(true);
  a.step(10);
  b.step(30);
  ASSERT_EQ(a.state_hash(), b.state_hash());
  const std::vector<ContactImpulse> one = a.records().impulses(), other = b.records().impulses();
  ASSERT_EQ(one.size(), other.size());
  ASSERT_GT(one.size(), 20u);
  for (std::size_t k = 0; k < one.size(); ++k) EXPECT_EQ(one[k].impulse, other[k].impulse);
}

TEST_P(Impulses, NeverChangeTheStateAndCostNothingWhileOff) {
  const Scene scene = box_collider(800);
  RunOptions o = options();
  o.initial_pair_capacity = 100;  // the list grows during the recording
  World off(scene, o), on(scene, o), toggled(scene, o);
  on.records().record_impulses(true);
  for (int k = 0; k < 24; ++k) {
    toggled.records().record_impulses(k % 5 < 2);
    for (World* world : {&off, &on, &toggled}) world->step();
    on.detect();
    toggled.measure();
    ASSERT_EQ(on.state_hash(), off.state_hash()) << k;
    ASSERT_EQ(toggled.state_hash(), off.state_hash()) << k;
  }
  EXPECT_TRUE(off.records().impulses().empty());
  EXPECT_EQ(off.measure().max_impulse, 0);
  EXPECT_FALSE(on.records().impulses().empty());
  EXPECT_GT(on.measure().max_impulse, 0);
  EXPECT_GT(on.info().allocated_bytes, off.info().allocated_bytes);
  on.records().record_impulses(false);
  EXPECT_EQ(on.info().allocated_bytes, off.info().allocated_bytes);
  EXPECT_TRUE(on.records().impulses().empty());
  const auto launches = [](World& world) {
    world.step(2);
    int sum = 0;
    for (const StageTime& stage : world.times().stages) sum += stage.launches;
    return sum;
  };
  const int plain = launches(off);
  EXPECT_EQ(launches(on), plain);
  on.records().record_impulses(true);
  EXPECT_EQ(launches(on), plain + 1) << "one that clears";
}

TEST_P(Impulses, ArePublishedWithTheContactsOfTheState) {
  World world(box_collider(1000, Variant::paper), options());
  world.records().record_impulses(true);
  world.step(40);
  world.detect();  // the state's contacts differ from the last step's
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> given;
  for (const ContactImpulse& c : world.records().impulses()) given[{c.a, c.b}] = c.impulse;
  FrameLayers layers;
  layers.contacts = true;
  PublishedRecords records;
  world.publisher().copy(layers, records);
  const auto drawn = records.copy<ContactInstance>();
  int old = 0, fresh = 0;
  for (const ContactInstance& contact : drawn) {
    const auto known = given.find({contact.a, contact.b});
    EXPECT_EQ(static_cast<double>(contact.impulse), known == given.end() ? 0 : known->second);
    ++(known == given.end() ? fresh : old);
    const BodyReport body = world.inspect(contact.b);
    const auto same = std::ranges::find(body.contacts, contact.a, &BodyReport::Contact::other);
    ASSERT_NE(same, body.contacts.end());
    EXPECT_EQ(same->impulse, static_cast<double>(contact.impulse));
  }
  EXPECT_GT(old, 5);
  EXPECT_GT(fresh, 5) << "contacts that the last step did not have";
}

TEST(ImpulseView, FindsEveryPairAndNoOther) {
  const std::vector<Pair> pairs{{0, 2}, {0, 7}, {1, 2}, {3, 4}, {3, 9}, {8, 9}};
  const std::vector<double> impulse{1, 2, 3, 4, 5, 6};
  for (std::uint32_t count = 0; count <= 6; ++count) {
    const ImpulseView<double> view{pairs.data(), impulse.data(), &count};
    for (std::uint32_t a = 0; a < 10; ++a)
      for (std::uint32_t b = 0; b < 10; ++b) {
        double expected = 0;
        for (std::uint32_t k = 0; k < count; ++k)
          if (pairs[k].a == a && pairs[k].b == b) expected = impulse[k];
        EXPECT_EQ(view.of(a, b), expected);
      }
  }
  EXPECT_EQ(ImpulseView<double>{}.of(0, 2), 0);
}

}  // namespace
}  // namespace collidoscope
