#include "core/strand_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/measure.h"
#include "core/simulation.h"
#include "core/strand_block.h"
#include "tests/expect_error.h"
#include "validation/specimen.h"

namespace strandcast {
namespace {

StrandSet oneStrand(std::vector<Vec3> points) {
  StrandSet set;
  set.append(points);
  return set;
}

std::string errorOfModel(const StrandSet& set) {
  return errorOf([&] { makeStrandModel(set); });
}

TEST(StrandModel, KeepsTheRestShapeInTheRootFrame) {
  const StrandSet set = oneStrand({{1, 2, 3}, {1, 3, 3}, {2, 3, 3}});
  const StrandModel model = makeStrandModel(set);
  EXPECT_EQ(model.rest_local[0], Vec3(0, 0, 0));
  // z is the rest tangent at the root: it precedes the first edge by half of the 90 degrees of the first
  // joint.
  EXPECT_NEAR(model.rest_local[1].z(), std::cos(0.25 * 3.14159265), 1e-6);
  EXPECT_NEAR(model.rest_local[1].norm(), 1, 1e-6);
  EXPECT_TRUE(model.isPinned(0, 0));
  EXPECT_FALSE(model.isPinned(0, 1));
  EXPECT_FALSE(model.isPinned(0, 2));
  const StrandState state = restState(model, model.rest_roots);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_LT((state.positions[i] - set.positions[i]).norm(), 1e-6f);
    EXPECT_EQ(state.velocities[i], Vec3(0, 0, 0));
  }
}

// Greatest relative deviation of edge lengths from their mean, divided by evenTolerance().
float unevenness(const StrandModel& model) {
  const float mean = arcLength(model.rest_local) / static_cast<float>(model.vertices() - 1);
  float most = 0;
  for (size_t i = 1; i < model.vertices(); ++i)
    most = std::max(most, std::abs((model.rest_local[i] - model.rest_local[i - 1]).norm() / mean - 1));
  return most / evenTolerance(model, 0);
}

TEST(StrandModel, EdgesThatOnlyRoundingTellsApartAreEven) {
  for (const double far : {0.0, 1.7, 30.0, 3000.0}) {
    std::vector<Vec3> points;
    for (int i = 0; i < 40; ++i)  // a helix with edges of 2 mm
      points.push_back(
          Eigen::Vector3d(far + 0.008 * std::cos(0.2 * i), far - 0.0012 * i, 0.008 * std::sin(0.2 * i))
              .cast<float>());
    EXPECT_LT(unevenness(makeStrandModel(oneStrand(points))), 1) << far;
    points[20].y() += static_cast<float>(1e-6 + 1e-5 * far);
    EXPECT_GT(unevenness(makeStrandModel(oneStrand(points))), 1) << far;
  }
}

TEST(StrandModel, TakesStrandsThatPointAgainstZ) {
  const StrandSet set = oneStrand({{0, 0, 0}, {0, 0, -1}, {0, 1, -1}});
  const StrandModel model = makeStrandModel(set);
  const StrandState state = restState(model, model.rest_roots);
  for (size_t i = 0; i < 3; ++i) EXPECT_LT((state.positions[i] - set.positions[i]).norm(), 1e-6f);
}

TEST(StrandModel, ATaperedStrandIsLighterAndSofterTowardsItsTip) {
  const StrandSet set = oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 3, 0}, {0, 4, 0}});
  Material tapered;
  tapered.radius_scale.knots = {{0, 1}, {1, 0.5f}};
  const StrandModel even = makeStrandModel(set), model = makeStrandModel(set, {tapered});
  for (int j = 1; j < 4; ++j) {
    // Means over the cell: of radius^2 for mass, of radius^-4 (harmonic mean of stiffness) for bending.
    const double from = 1 - 0.125 * (j - 0.5), to = 1 - 0.125 * (j + 0.5);
    EXPECT_NEAR(model.bend[j] * model.reference_mass[0] / (even.bend[j] * even.reference_mass[0]),
                3 * (from - to) / (std::pow(to, -3) - std::pow(from, -3)), 1e-5);
    EXPECT_NEAR(model.mass[j] * model.reference_mass[0] / (even.mass[j] * even.reference_mass[0]),
                (std::pow(from, 3) - std::pow(to, 3)) / (3 * (from - to)), 1e-5);
  }
}

TEST(StrandModel, AJointBendsAsTheRodAroundItDoes) {
  const StrandSet set = oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 3, 0}, {0, 4, 0}});
  Material stepped;
  stepped.stiffness_scale.knots = {{0.3f, 1}, {0.3f, 0.1f}};
  const StrandModel even = makeStrandModel(set), model = makeStrandModel(set, {stepped});
  // The cell of joint 1 spans arc lengths 0.5 to 2 m; stiffness jumps at 1.2 m.
  const double factors[] = {1, 1.5 / (0.7 + 0.8 / 0.1), 0.1};
  for (int j = 0; j < 3; ++j) {
    EXPECT_NEAR(model.bend[j] / even.bend[j], factors[j], 1e-5) << j;
    EXPECT_NEAR(model.twist[j] / even.twist[j], factors[j], 1e-5) << j;
    EXPECT_EQ(model.mass[j], even.mass[j]) << j;
  }
}

TEST(StrandModel, ADensityCurveIsMassAndNothingElse) {
  const StrandSet set = oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 3, 0}, {0, 4, 0}});
  Material growing, stepped;
  growing.density_scale.knots = {{0, 1}, {1, 3}};
  stepped.density_scale.knots = {{0.3f, 1}, {0.3f, 5}};
  const double ends[] = {0, 0.5, 2, 3.5, 4};  // arc lengths, m, that bound the vertex cells
  const double growing_factors[] = {1.125, 1.625, 2.375, 2.875};      // 1 + x / 2 at the centres of cells
  const double stepped_factors[] = {1, (0.7 + 0.8 * 5) / 1.5, 5, 5};  // density jumps at 1.2 m
  const StrandModel even = makeStrandModel(set);
  for (const bool grows : {true, false}) {
    const StrandModel model = makeStrandModel(set, {grows ? growing : stepped});
    double sum = 0, kilograms = 0;
    for (int v = 0; v < 4; ++v) {
      const double factor = grows ? growing_factors[v] : stepped_factors[v];
      EXPECT_NEAR(model.mass[v] * model.reference_mass[0] / (even.mass[v] * even.reference_mass[0]), factor,
                  1e-5)
          << v;
      sum += model.mass[v];
      kilograms += factor * (ends[v + 1] - ends[v]) * std::numbers::pi * 1300 * 40e-6 * 40e-6;
    }
    EXPECT_NEAR(sum, 3, 1e-5) << "reference masses are means of edges";
    EXPECT_NEAR(model.reference_mass[0] * 3 / kilograms, 1, 1e-5);
    for (int j = 0; j < 3; ++j) {
      const double masses = model.reference_mass[0] / even.reference_mass[0];
      EXPECT_NEAR(model.bend[j] * masses / even.bend[j], 1, 1e-5) << j;
      EXPECT_NEAR(model.twist[j] * masses / even.twist[j], 1, 1e-5) << j;
      EXPECT_EQ(model.rest_strain[j], even.rest_strain[j]) << j;
    }
  }
}

TEST(StrandModel, CurvesOfDampingAndFrictionAreKeptOnlyWhereThereAreSome) {
  StrandSet set = oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 3, 0}, {0, 4, 0}});
  set.append(std::vector<Vec3>{{1, 0, 0}, {1, 1, 0}});
  set.parts = {0, 1};
  Material scaled, curved;
  scaled.damping_scale = 2;
  scaled.friction_scale = 3;
  curved.damping_scale = 4;
  curved.damping_curve.knots = {{0, 1}, {1, 3}};
  curved.friction_curve.knots = {{0.5f, 1}, {0.5f, 0}};
  EXPECT_TRUE(makeStrandModel(set, {scaled}).damping_along.empty()) << "no memory where they are 1";
  const StrandModel model = makeStrandModel(set, {curved, scaled});
  for (uint32_t v = 0; v < 4; ++v) {
    EXPECT_FLOAT_EQ(model.dampingFactor(0, v), 4 * (1 + model.rest_local[v].norm() / 2)) << v;
    EXPECT_FLOAT_EQ(model.frictionFactor(0, v), v < 2 ? 1 : 0) << v;
  }
  EXPECT_FLOAT_EQ(model.dampingFactor(1, 5), 2);
  EXPECT_FLOAT_EQ(model.frictionFactor(1, 5), 3);
  checkModel(model, "here");
  for (std::vector<float> StrandModel::*along : {&StrandModel::damping_along, &StrandModel::friction_along}) {
    StrandModel lacks = model;
    (lacks.*along).clear();
    EXPECT_NE(errorOf([&] { checkModel(lacks, "here"); }).find("without the other"), std::string::npos);
  }
}

TEST(StrandModel, ACurveAloneMakesAStrandOneWithFactors) {
  Material curved;
  curved.friction_curve.knots = {{0, 1}, {1, 0.5f}};
  const StrandModel model = makeStrandModel(oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}), {curved});
  EXPECT_TRUE(model.hasFactors(0));
}

TEST(StrandModel, AnEmptySetIsAModel) { EXPECT_EQ(makeStrandModel(StrandSet()).strands(), 0u); }

TEST(StrandModel, BadStrandsAreErrorsThatNameThem) {
  StrandSet set = oneStrand({{0, 0, 0}, {0, 1, 0}});
  set.append(std::vector<Vec3>{{0, 0, 0}});
  EXPECT_NE(errorOfModel(set).find("strand 1"), std::string::npos) << errorOfModel(set);
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  EXPECT_NE(errorOfModel(oneStrand({{0, 0, 0}, {0, nan, 0}})).find("finite"), std::string::npos);
  EXPECT_NE(errorOfModel(oneStrand({{0, 0, inf}, {0, 1, 0}})).find("finite"), std::string::npos);
  EXPECT_NE(errorOfModel(oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 1, 0}})).find("coincide"), std::string::npos);
  EXPECT_NE(errorOfModel(oneStrand(std::vector<Vec3>(129, Vec3(0, 0, 0)))).find("129 vertices"),
            std::string::npos);
}

TEST(StrandModel, RestEdgesLieInTheFrameOfTheEdgeBefore) {
  const std::vector<Vec3> rest = {{0, 0, 0}, {0, 0, 2}, {1, 0, 2}, {1, 0, 3}};
  std::array<Vec3, 4> edges;
  restEdges(rest, edges);
  EXPECT_LT((edges[0] - Vec3(0, 0, 2)).norm(), 1e-6f);
  EXPECT_LT((edges[1] - Vec3(1, 0, 0)).norm(), 1e-6f) << "a quarter turn towards x";
  EXPECT_LT((edges[2] - Vec3(-1, 0, 0)).norm(), 1e-6f) << "and a quarter turn back";
  EXPECT_EQ(edges[3], Vec3(0, 0, 0));
}

TEST(StrandModel, TheHashTellsStatesApart) {
  StrandState state;
  EXPECT_EQ(stateHash(state), 14695981039346656037ull);  // FNV-1a of nothing
  state.positions = {{1, 2, 3}};
  state.velocities = {{0, 0, 0}};
  const uint64_t hash = stateHash(state);
  EXPECT_EQ(stateHash(state), hash);
  state.velocities[0].z() = -0.0f;
  EXPECT_NE(stateHash(state), hash) << "it is of the bytes";
  std::swap(state.positions, state.velocities);
  EXPECT_NE(stateHash(state), hash);
}

TEST(Measure, SeesStretchPenetrationAndWhatIsNotFinite) {
  const StrandModel model = makeStrandModel(oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 3, 0}}));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3> positions = {{0, 0, 0}, {0, 1.5f, 0}, {0, 2.25f, 0}, {0, nan, 0}};
  const ContactPrimitive ball{PrimitiveKind::kSphere, Vec3(0, 2.25f, 0.9f), Vec3::UnitY(), 1.0f, 0};
  const ContactPrimitive around_root{PrimitiveKind::kSphere, Vec3(0, 0, 0), Vec3::UnitY(), 0.5f, 0};
  const std::vector<MovingPrimitive> bodies = {moved(ball, Pose(), Pose(), 0.01f),
                                               moved(around_root, Pose(), Pose(), 0.01f)};
  const Measurement m = measure(model, positions, bodies);
  EXPECT_NEAR(m.max_stretch, 0.5, 1e-6);
  EXPECT_NEAR(m.max_penetration, 0.1, 1e-6) << "the root is pinned and does not count";
  EXPECT_EQ(m.non_finite, 1u);
  EXPECT_NEAR(m.mean_stretch, (0.5 + 0.25) / 2, 1e-6) << "edges without a length do not count";
  std::vector<Vec3> torn = positions;
  torn[1].x() = nan;
  torn[3] = Vec3(0, 3.5f, 0);
  EXPECT_NEAR(measure(model, torn, {}).mean_stretch, 0.25, 1e-6) << "of the last edge alone";
  EXPECT_EQ(measure(model, torn, {}).edges, 1u);
  EXPECT_EQ(measure(makeStrandModel(StrandSet()), {}, bodies).mean_stretch, 0);
}

TEST(ContactPrimitive, MovesWithItsBody) {
  const ContactPrimitive capsule{PrimitiveKind::kCapsule, Vec3(1, 0, 0), Vec3(2, 0, 0), 0.1f, 0.3f};
  const Pose end{Vec3(0, 5, 0), Quat(Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitY()))};
  const MovingPrimitive m = moved(capsule, Pose(), end, 0.1f);
  EXPECT_NEAR(m.angular_velocity[1], 5, 1e-5) << "0.5 rad in 0.1 s";
  EXPECT_NEAR(m.a_end[0], std::cos(0.5f), 1e-6);
  EXPECT_NEAR(m.a_end[2], -std::sin(0.5f), 1e-6);
  EXPECT_NEAR(signedDistance(m, end.apply(Vec3(1.5f, 0.3f, 0))), 0.2, 1e-6);
  EXPECT_NEAR(signedDistance(m, end.apply(Vec3(3, 0, 0))), 0.9, 1e-6);
  const ContactPrimitive plane{PrimitiveKind::kPlane, Vec3(0, 0, 0), Vec3(0, 1, 0), 0, 0};
  EXPECT_NEAR(signedDistance(moved(plane, Pose(), end, 0.1f), Vec3(7, 5.5f, 1)), 0.5, 1e-6);
  const MovingPrimitive back = moved(capsule, Pose(), Pose{Vec3(0, 0, 0), Quat(-1, 0, 0, 0)}, 0.1f);
  EXPECT_NEAR(Vec3(back.angular_velocity[0], back.angular_velocity[1], back.angular_velocity[2]).norm(), 0,
              1e-4)
      << "-q is the same rotation as q";
}

TEST(StrandModel, ASetWhoseArraysDoNotFitIsRefused) {
  const auto complaint = [](auto spoil) {
    StrandSet set = oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}});
    set.append(std::vector<Vec3>{{1, 0, 0}, {1, 1, 0}});
    set.pinned = {1, 0, 0, 1, 0};
    set.radii.assign(5, 1e-4f);
    set.uvs.assign(2, Vec2::Zero());
    set.parts = {0, 1};
    set.ids = {8, 9};
    set.is_guide = {1, 0};
    set.groups = {0, 0};
    set.colours.assign(2, Vec3::Ones());
    EXPECT_EQ(errorOfModel(set), "");
    spoil(set);
    return errorOfModel(set);
  };
  for (const std::vector<uint32_t>& offsets :
       {std::vector<uint32_t>{}, {1, 5}, {0, 3}, {0, 50}, {0, 3, 3, 5}})
    EXPECT_NE(complaint([&](StrandSet& set) { set.offsets = offsets; }).find("offsets"), std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.pinned.pop_back(); }).find("wrong length"), std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.radii.push_back(0); }).find("wrong length"),
            std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.parts.pop_back(); }).find("wrong length"), std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.ids.pop_back(); }).find("wrong length"), std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.colours[1].x() = NAN; }).find("not finite"),
            std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.radii[2] = -1e-4f; }).find("negative radius"),
            std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.colours[1].z() = -1; }).find("negative colour"),
            std::string::npos);
  EXPECT_NE(complaint([](StrandSet& set) { set.positions[2].y() = 1e20f; }).find("10 km"), std::string::npos);
  EXPECT_NE(errorOf([] {
              makeStrandModel(oneStrand({{0, 0, 0}, {0, 1, 0}}), {});
            }).find("material"),
            std::string::npos);
}

TEST(StrandModel, AModelThatIsNotSoundIsRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto complaint = [](auto spoil) {
    StrandModel model = makeStrandModel(oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}));
    EXPECT_NO_THROW(checkModel(model, "here"));
    spoil(model);
    return errorOf([&] { checkModel(model, "here"); });
  };
  EXPECT_NE(complaint([](StrandModel& m) { m.offsets.back() = 7; }).find("offsets"), std::string::npos);
  EXPECT_NE(complaint([](StrandModel& m) { m.offsets = {0, 1, 3}; }).find("2 to 128"), std::string::npos);
  EXPECT_NE(complaint([](StrandModel& m) { m.bend.clear(); }).find("bend has 0 entries, not 3"),
            std::string::npos);
  EXPECT_NE(complaint([&](StrandModel& m) { m.bend[1] = nan; }).find("bend"), std::string::npos);
  EXPECT_NE(complaint([&](StrandModel& m) { m.rest_local[2].x() = nan; }).find("rest_local"),
            std::string::npos);
  EXPECT_NE(complaint([&](StrandModel& m) { m.rest_roots[0].position.x() = nan; }).find("rest_roots"),
            std::string::npos);
  EXPECT_NE(complaint([](StrandModel& m) { m.mass[1] = 0; }).find("mass"), std::string::npos);
  EXPECT_NE(complaint([](StrandModel& m) { m.root_bones = {1}; }).find("root_bones"), std::string::npos);
  EXPECT_NE(complaint([](StrandModel& m) { m.twist[0] = 1e30f; }).find("twist"), std::string::npos);
  const StrandModel model = makeStrandModel(oneStrand({{0, 0, 0}, {0, 1, 0}}));
  EXPECT_NE(errorOf([&] { restState(model, {}); }).find("0 roots are given for 1 strands"),
            std::string::npos);
}

TEST(StrandModel, SomeOfTheGroomingAloneIsRefused) {
  for (std::vector<float> StrandModel::*factors :
       {&StrandModel::air_drag_scale, &StrandModel::goal_scale, &StrandModel::damping_scale,
        &StrandModel::friction_scale, &StrandModel::tether}) {
    StrandModel model = makeStrandModel(oneStrand({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}));
    const bool of_strands = factors == &StrandModel::damping_scale || factors == &StrandModel::friction_scale;
    (model.*factors).assign(of_strands ? 1 : 3, 2.0f);
    EXPECT_NE(errorOf([&] { checkModel(model, "here"); }).find("some, but not all"), std::string::npos);
  }
}

TEST(StrandModel, AStrandOfTheStiffestJointsStepsToFiniteNumbers) {
  StrandSet set;
  set.append(helixStrand(0.01, 0.01, 0.2, 32));
  StrandModel model = makeStrandModel(set);
  std::fill(model.bend.begin(), model.bend.end(), kStiffestJoint);
  std::fill(model.twist.begin(), model.twist.end(), kStiffestJoint);
  for (const float time_step : {1.0f / 30, 1e-5f}) {
    Parameters parameters;
    parameters.time_step = time_step;
    parameters.substeps = 1;
    Simulation simulation(model, {}, parameters, makeReferenceBackend());
    for (int step = 0; step < 100; ++step) simulation.step();
    EXPECT_EQ(simulation.measure().non_finite, 0u) << time_step;
  }
}

}  // namespace
}  // namespace strandcast
