#include "core/simulation.h"

#include <algorithm>

#include "core/error.h"
#include "core/nearest_name.h"
#include "core/pose_check.h"

namespace strandcast {
namespace {

void checkPrimitive(const ContactPrimitive& primitive) {
  if (!primitive.a.allFinite() || !primitive.b.allFinite() || !std::isfinite(primitive.radius) ||
      !std::isfinite(primitive.friction))
    throw Error("a body's shape is not finite", "Simulation", "check its points, radius and friction");
}

}  // namespace

Simulation::Simulation(StrandModel model, std::vector<RigidBody> bodies, Parameters parameters,
                       std::unique_ptr<Backend> backend)
    : model_(std::move(model)),
      bodies_(std::move(bodies)),
      parameters_(parameters),
      backend_(std::move(backend)),
      bones_begin_(model_.bones.size()),
      bones_end_(model_.bones.size()),
      roots_begin_(model_.rest_roots),
      roots_end_(model_.rest_roots) {
  checkParameters(parameters_, "Simulation");
  for (const RigidBody& body : bodies_)
    for (const ContactPrimitive& primitive : body.primitives) checkPrimitive(primitive);
  for (size_t s = 0; s < model_.strands(); ++s)
    lengths_.push_back(arcLength({model_.rest_local.data() + model_.offsets[s], model_.verticesOf(s)}));
  size_t primitives = 0;
  for (const RigidBody& body : bodies_) primitives += body.primitives.size();
  primitives_.resize(primitives);
  backend_->load(model_, restState(model_, roots_begin_));
  placePrimitives();
}

void Simulation::setHeadPose(const Pose& head) {
  checkPose(head, "Simulation::setHeadPose");
  bones_end_[0] = head;
}

void Simulation::setBonePose(size_t bone, const Pose& pose) {
  if (bone >= bones_end_.size())
    throw Error("there is no bone " + std::to_string(bone), "Simulation::setBonePose",
                "the model has " + std::to_string(bones_end_.size()));
  checkPose(pose, "Simulation::setBonePose");
  bones_end_[bone] = pose;
}

void Simulation::setBonePose(const std::string& bone, const Pose& pose) {
  const auto known = std::find(model_.bones.begin(), model_.bones.end(), bone);
  if (known == model_.bones.end())
    throw Error("there is no bone '" + bone + "'", "Simulation::setBonePose",
                "did you mean '" + nearestName(bone, model_.bones) + "'?");
  setBonePose(static_cast<size_t>(known - model_.bones.begin()), pose);
}

void Simulation::setParameters(const Parameters& parameters) {
  checkParameters(parameters, "Simulation::setParameters");
  parameters_ = parameters;
}

void Simulation::placeRoots(const std::vector<Pose>& bones, std::vector<Pose>& roots) const {
  for (size_t s = 0; s < roots.size(); ++s) roots[s] = bones[model_.rootBone(s)] * model_.rest_roots[s];
}

void Simulation::placePrimitives() {
  size_t next = 0;
  for (const RigidBody& body : bodies_) {
    const Pose begin = body.follows_head ? bones_begin_[0] : Pose{};
    const Pose end = body.follows_head ? bones_end_[0] : Pose{};
    for (const ContactPrimitive& primitive : body.primitives)
      primitives_[next++] = moved(primitive, begin, end, parameters_.time_step);
  }
}

StepInput Simulation::nextInput() {
  placeRoots(bones_end_, roots_end_);
  placePrimitives();
  return {&parameters_, roots_begin_, roots_end_, primitives_, bones_begin_, bones_end_};
}

void Simulation::step() {
  backend_->step(nextInput());
  std::swap(roots_begin_, roots_end_);
  bones_begin_ = bones_end_;
  time_ += parameters_.time_step;
  ++steps_;
}

StrandState Simulation::restNow() const {
  StrandState rest = restState(model_, roots_begin_);
  if (!model_.pin_bones.empty())
    for (size_t s = 0; s < model_.strands(); ++s)
      for (uint32_t v = model_.offsets[s]; v < model_.offsets[s + 1]; ++v)
        if (model_.isBonePinned(s, v))
          rest.positions[v] = bones_begin_[model_.pin_bones[v]].apply(model_.restPosition(s, v));
  return rest;
}

void Simulation::reset() {
  bones_end_ = bones_begin_;
  placePrimitives();
  backend_->upload(restNow());
}

size_t Simulation::resetBroken() {
  constexpr float kTooFar = 2;  // times its length: what only gauss_seidel could reach
  const std::span<const Vec3> now = guides();
  std::vector<size_t> broken;
  for (size_t s = 0; s < model_.strands(); ++s) {
    const uint32_t first = model_.offsets[s], end = model_.offsets[s + 1];
    const float far = kTooFar * lengths_[s];
    bool good = true;
    for (uint32_t v = first; v < end; ++v) good = good && (now[v] - now[first]).squaredNorm() <= far * far;
    if (!good) broken.push_back(s);
  }
  if (broken.empty()) return 0;
  StrandState state;
  backend_->download(state);
  const StrandState rest = restNow();
  for (const size_t s : broken) {
    for (uint32_t v = model_.offsets[s]; v < model_.offsets[s + 1]; ++v) {
      state.positions[v] = rest.positions[v];
      state.velocities[v] = rest.velocities[v];
      state.frames[v] = rest.frames[v];
      state.tensions[v] = rest.tensions[v];
      state.contacts[v].setZero();
    }
  }
  backend_->upload(state);
  return broken.size();
}

void Simulation::teleport(const Pose& head) {
  checkPose(head, "Simulation::teleport");
  StrandState state;
  backend_->download(state);
  const Pose carry = head * bones_begin_[0].inverse();
  for (Vec3& position : state.positions) position = carry.apply(position);
  for (std::vector<Vec3>* plane : {&state.velocities, &state.contacts})
    for (Vec3& vector : *plane) vector = carry.rotate(vector);
  for (Quat& frame : state.frames) frame = (carry.rotation * frame).normalized();
  for (Pose& bone : bones_begin_) {
    bone = carry * bone;
    bone.rotation.normalize();
  }
  bones_begin_[0] = head;
  bones_end_ = bones_begin_;
  placeRoots(bones_begin_, roots_begin_);
  placePrimitives();
  backend_->upload(state);
}

Measurement Simulation::measure() { return strandcast::measure(model_, guides(), primitives_); }

StrandState Simulation::state() {
  StrandState state;
  backend_->download(state);
  return state;
}

}  // namespace strandcast
