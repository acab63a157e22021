#include "core/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/geometry.h"
#include "core/name_lookup.h"

namespace strandcast {

namespace {

std::vector<Pose> rootPosesOn(const StrandModel& model, std::span<const Pose> bones) {
  std::vector<Pose> roots;
  for (size_t s = 0; s < model.strands(); ++s)
    roots.push_back(bones[model.rootBone(s)] * model.rest_roots[s]);
  return roots;
}

Parameters withSolvableSubsteps(Parameters parameters) {
  if (parameters.solver == SolverKind::kRod) {
    const int least = static_cast<int>(std::ceil(parameters.time_step / kLongestSubstep - 1e-3f));
    const int most = static_cast<int>(parameters.time_step / kShortestSubstep + 1e-3f);
    parameters.substeps = std::clamp(parameters.substeps, least, std::max(most, 1));
  }
  return parameters;
}

// Validate constructor arguments before any other member uses them.
std::unique_ptr<StrandModel> checked(StrandModel model) {
  checkModel(model, "Simulation");
  return std::make_unique<StrandModel>(std::move(model));
}
std::unique_ptr<Backend> checked(std::unique_ptr<Backend> backend) {
  if (backend == nullptr) throw Error("the backend is null", "Simulation", "create it with createBackend()");
  return backend;
}

}  // namespace

Simulation::Simulation(StrandModel model, std::vector<RigidBody> bodies, Parameters parameters,
                       std::unique_ptr<Backend> backend, std::unique_ptr<ExternalForces> external_forces,
                       std::unique_ptr<BroadPhase> broad_phase)
    : model_(checked(std::move(model))),
      parameters_(parameters),
      backend_(checked(std::move(backend))),
      external_forces_(std::move(external_forces)),
      bones_begin_(model_->bones.size()),
      bones_end_(model_->bones.size()),
      bones_begin_local_(model_->bones.size()),
      bones_end_local_(model_->bones.size()),
      lengths_(strandLengths(*model_)),
      reach_(*model_, strandOrder(*model_), lengths_),
      strand_boxes_(reach_.neighbourhoods()),
      bodies_(broad_phase != nullptr ? std::move(broad_phase) : makeAllPairs(), strand_boxes_.size()) {
  checkParameters(parameters_, "Simulation");
  effective_parameters_ = withSolvableSubsteps(parameters_);
  for (RigidBody& body : bodies) {
    checkBody(body, "Simulation");
    bodies_.add(std::move(body));
  }
  std::vector<float> rest_distances = bodies_.restDistances(*model_, parameters_.hair_radius);
  if (!rest_distances.empty()) model_->rest_distance = std::move(rest_distances);
  backend_->load(*model_, restState(*model_, model_->rest_roots));
  has_external_forces_ = configureExternalForces(effective_parameters_);
  placeBodies();
  backend_->prepare(effective_parameters_, !bodies_.primitives().empty());
}

bool Simulation::configureExternalForces(const Parameters& parameters) {
  if (!(external_forces_ ? external_forces_->isNeeded(parameters) : needsExternalForces(parameters)))
    return false;
  if (!backend_->takesAccelerations())
    throw Error(
        "this backend does not support sources of wind, gusts, turbulence, wind_grid, air_drag_along, "
        "volume_stiffness and hair_friction",
        backend_->name(), "choose --backend simd or reference");
  if (!external_forces_)
    throw Error(
        "the simulation has no air system for gusts, turbulence, wind_grid, air_drag_along, volume_stiffness "
        "or hair_friction",
        "Simulation", "leave them at their defaults");
  external_forces_->configure(*model_, parameters, *backend_);
  return true;
}

void Simulation::setHeadPose(const Pose& head) {
  checkPose(head, "Simulation::setHeadPose");
  bones_end_[0] = head;
}

void Simulation::checkBone(size_t bone, const char* where) const {
  if (bone >= bones_end_.size())
    throw Error("unknown bone " + std::to_string(bone), where,
                "the model has " + std::to_string(bones_end_.size()));
}

const Pose& Simulation::bonePose(size_t bone) const {
  checkBone(bone, "Simulation::bonePose");
  return bones_begin_[bone];
}

void Simulation::setBonePose(size_t bone, const Pose& pose) {
  checkBone(bone, "Simulation::setBonePose");
  checkPose(pose, "Simulation::setBonePose");
  bones_end_[bone] = pose;
}

void Simulation::setBonePose(const std::string& bone, const Pose& pose) {
  const auto known = std::find(model_->bones.begin(), model_->bones.end(), bone);
  if (known == model_->bones.end())
    throw Error("unknown bone '" + bone + "'", "Simulation::setBonePose", didYouMean(bone, model_->bones));
  setBonePose(static_cast<size_t>(known - model_->bones.begin()), pose);
}

BodyId Simulation::addBody(RigidBody body) {
  checkBody(body, "Simulation::addBody");
  // The backend may throw: it comes before what changes the set.
  backend_->prepare(effective_parameters_, true);
  const BodyId added = bodies_.add(std::move(body));
  placeBodies();
  return added;
}

void Simulation::setBodyPose(BodyId body, const Pose& pose) {
  bodies_.setPose(body, pose, "Simulation::setBodyPose");
}

void Simulation::setBodyBend(BodyId body, const SurfaceBend& bend) {
  bodies_.setBend(body, bend, "Simulation::setBodyBend");
}

const Pose& Simulation::bodyPose(BodyId body) const {
  return bodies_.pose(body, bones_begin_[0], "Simulation::bodyPose");
}

const SurfaceBend& Simulation::bodyBend(BodyId body) const {
  return bodies_.bend(body, "Simulation::bodyBend");
}

const RigidBody& Simulation::body(BodyId body) const { return bodies_.body(body, "Simulation::body"); }

void Simulation::removeBody(BodyId body) {
  bodies_.remove(body, "Simulation::removeBody");
  placeBodies();
}

void Simulation::setParameters(const Parameters& parameters) {
  checkParameters(parameters, "Simulation::setParameters");
  if (parameters.solver != parameters_.solver)
    throw Error("the solver of a simulation cannot change", "Simulation::setParameters",
                "make another simulation");
  const Parameters stepped = withSolvableSubsteps(parameters);
  backend_->prepare(stepped, !bodies_.primitives().empty());
  const bool surrounded = configureExternalForces(stepped);
  if (surrounded && !has_external_forces_)
    external_forces_->reset(origin_.position);  // the air has stood still meanwhile
  has_external_forces_ = surrounded;
  parameters_ = parameters;
  effective_parameters_ = stepped;
}

void Simulation::chooseOrigin(const Pose& head) {
  origin_ = Origin::forHead(head);
  world_guides_.resize(origin_.isWorld() ? 0 : model_->vertices());
}

void Simulation::placeBodies() {
  bodies_.place(bones_begin_[0], bones_end_[0], origin_, parameters_.time_step);
}

void Simulation::advanceMotion() {
  bones_begin_ = bones_end_;
  bodies_.advance();
}

StepInput Simulation::nextInput() {
  placeBodies();
  for (size_t bone = 0; bone < bones_begin_.size(); ++bone) {
    bones_begin_local_[bone] = origin_.toLocal(bones_begin_[bone]);
    bones_end_local_[bone] = origin_.toLocal(bones_end_[bone]);
  }
  // The broad phase needs bounded strands. Strands of the rod stay within their length of the root; others
  // may stretch.
  const NearBodyLists* near = nullptr;
  if (parameters_.solver == SolverKind::kRod && !bodies_.primitives().empty()) {
    reach_.place(bones_begin_local_, bones_end_local_, parameters_.hair_radius + kQueryReach, strand_boxes_);
    near = &bodies_.findNear(strand_boxes_);
  }
  return {.parameters = &effective_parameters_,
          .bones_begin = bones_begin_local_,
          .bones_end = bones_end_local_,
          .primitives = bodies_.primitives(),
          .shapes = &bodies_.shapes(),
          .near = near};
}

void Simulation::step() {
  StepInput input = nextInput();
  if (pull_) backend_->guides();  // addPull() needs them; external forces may use their memory
  if (has_external_forces_) external_forces_->step(input, *backend_);
  if (pull_) addPull(input);
  backend_->step(input);
  advanceMotion();
  time_ += parameters_.time_step;
  ++steps_;
}

void Simulation::pullHair(const Vec3& from, float radius, const Vec3& to, float rate) {
  checkPull(from, radius, to, rate);
  if (!backend_->takesAccelerations())
    throw Error("this backend does not support pulls", backend_->name(), "choose simd, gpu or reference");
  if (!pull_ || !pull_->closedAt(from, radius)) pull_.emplace(*model_, guides(), from, radius);
  pull_->moveTo(to, rate);
  backend_->prepareAccelerations();
}

void Simulation::addPull(StepInput& input) {
  const std::span<const Vec3> others =
      has_external_forces_ ? external_forces_->accelerations() : std::span<const Vec3>{};
  input.accelerations = pull_->accelerations(others, guides(), backend_->velocities(), parameters_.time_step);
}

bool needsExternalForces(const Parameters& p) {
  const bool varies = (p.gust > 0 || p.turbulence > 0) && !p.wind.isZero();
  return p.wind_grid > 0 || varies || p.air_drag_along < 1 || p.volume_stiffness > 0 || p.hair_friction > 0;
}

std::vector<Pose> Simulation::rootPoses() const { return rootPosesOn(*model_, bones_begin_); }

StrandState Simulation::restNow() const {
  std::vector<Pose> bones;
  for (const Pose& bone : bones_begin_) bones.push_back(origin_.toLocal(bone));
  StrandState rest = restState(*model_, rootPosesOn(*model_, bones));
  if (!model_->pin_bones.empty())
    for (size_t s = 0; s < model_->strands(); ++s)
      for (uint32_t v = model_->offsets[s]; v < model_->offsets[s + 1]; ++v)
        if (model_->isBonePinned(s, v))
          rest.positions[v] = bones[model_->pin_bones[v]].apply(model_->restPosition(s, v));
  return rest;
}

void Simulation::reset() {
  releaseHair();
  bones_end_ = bones_begin_;
  bodies_.cancelMotion();
  chooseOrigin(bones_begin_[0]);
  uploadState(restNow());
  if (external_forces_) external_forces_->reset(origin_.position);
}

void Simulation::uploadState(const StrandState& state) {
  placeBodies();
  backend_->upload(state);
}

void Simulation::rebaseOrigin() {
  if (!origin_.isFar(bones_begin_[0])) return;
  StrandState state;
  backend_->download(state);
  const Origin before = origin_;
  chooseOrigin(bones_begin_[0]);
  const Vec3 way = origin_.toLocal(before.position);
  for (Vec3& position : state.positions) position += way;
  uploadState(state);
  if (has_external_forces_) external_forces_->moveOrigin(origin_.position);
}

size_t Simulation::resetDiverged() {
  rebaseOrigin();
  if (!backend_->mayHaveDiverged()) return 0;
  const std::span<const Vec3> now = backend_->guides();
  std::vector<size_t> broken;
  for (size_t s = 0; s < model_->strands(); ++s) {
    const uint32_t first = model_->offsets[s], end = model_->offsets[s + 1];
    const float far = kDivergedReach * lengths_[s];
    bool good = true;
    for (uint32_t v = first; v < end; ++v) good = good && (now[v] - now[first]).squaredNorm() <= far * far;
    if (!good) broken.push_back(s);
  }
  if (broken.empty()) return 0;
  StrandState state;
  backend_->download(state);
  const StrandState rest = restNow();
  for (const size_t s : broken) {
    for (uint32_t v = model_->offsets[s]; v < model_->offsets[s + 1]; ++v) {
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

void Simulation::carryHair(std::span<const Pose> motions) {
  StrandState state;
  backend_->download(state);
  for (size_t s = 0; s < model_->strands(); ++s) {
    const uint32_t root = model_->offsets[s];
    size_t bone = model_->rootBone(s);
    for (uint32_t v = root; v < model_->offsets[s + 1]; ++v) {
      if (v > root && model_->isPinned(s, v) && !model_->pin_bones.empty()) bone = model_->pin_bones[v];
      const Pose& motion = motions[bone];
      state.positions[v] = motion.apply(state.positions[v]);
      state.velocities[v] = motion.rotate(state.velocities[v]);
      if (!state.contacts.empty()) state.contacts[v] = motion.rotate(state.contacts[v]);
      if (!state.frames.empty()) state.frames[v] = (motion.rotation * state.frames[v]).normalized();
    }
  }
  uploadState(state);
  if (external_forces_) external_forces_->reset(origin_.position);
}

void Simulation::jumpToPoses() {
  const Origin before = origin_;
  chooseOrigin(bones_end_[0]);
  std::vector<Pose> motions;
  for (size_t bone = 0; bone < bones_end_.size(); ++bone)
    motions.push_back(origin_.toLocal(bones_end_[bone]) * before.toLocal(bones_begin_[bone]).inverse());
  advanceMotion();
  carryHair(motions);
}

void Simulation::teleport(const Pose& head) {
  checkPose(head, "Simulation::teleport");
  const Origin before = origin_;
  chooseOrigin(head);
  const Pose carry = origin_.toLocal(head) * before.toLocal(bones_begin_[0]).inverse();
  for (Pose& bone : bones_begin_) {
    bone = carry * before.toLocal(bone);
    bone.rotation.normalize();
    bone = origin_.toWorld(bone);
  }
  bones_begin_[0] = head;
  bones_end_ = bones_begin_;
  // Not jumpToPoses(): bodies that do not follow the head keep their motion, and all bones have one exact
  // motion, without the rounding of their world poses.
  carryHair(std::vector<Pose>(bones_begin_.size(), carry));
}

void Simulation::resumeFrom(const StrandState& state, double time) {
  const size_t vertices = model_->vertices();
  const auto fits = [&](const auto& array, const auto& isFinite, bool may_lack = false) {
    return (array.size() == vertices || (may_lack && array.empty())) &&
           std::all_of(array.begin(), array.end(), isFinite);
  };
  const auto vector = [](const Vec3& v) { return v.allFinite(); };
  const bool sound = fits(state.positions, vector) && fits(state.velocities, vector) &&
                     fits(
                         state.frames, [](const Quat& q) { return q.coeffs().allFinite(); }, true) &&
                     fits(
                         state.tensions, [](float t) { return std::isfinite(t); }, true) &&
                     fits(state.contacts, vector, true) && std::isfinite(time) && time >= 0;
  if (!sound)
    throw Error("the hair state does not fit the model", "Simulation::resumeFrom",
                fmt::format("it has {} vertices of {}, or numbers that are not finite",
                            state.positions.size(), vertices));
  advanceMotion();
  chooseOrigin(bones_begin_[0]);
  StrandState own = state;
  for (Vec3& position : own.positions) position = origin_.toLocal(position);
  uploadState(own);
  if (external_forces_) external_forces_->reset(origin_.position);
  time_ = time;
}

std::span<const Vec3> Simulation::guidesOf(size_t first, size_t count) {
  const std::span<const Vec3> own = backend_->guidesOf(first, count);
  if (origin_.isWorld()) return own;
  const auto at = static_cast<ptrdiff_t>(first);
  const std::span<const Vec3> part = own.subspan(first, count);
  std::transform(part.begin(), part.end(), world_guides_.begin() + at,
                 [this](const Vec3& p) { return origin_.toWorld(p); });
  return world_guides_;
}

std::span<const PackedRun> Simulation::packGuides(const GuideGrid& grid, PackingFrame frame) {
  frame.origin = origin_.position;
  return backend_->packGuides(grid, frame);
}

Measurement Simulation::measure(StrandRange strands) {
  const size_t end = std::min(strands.end, model_->strands()), begin = std::min(strands.begin, end);
  const uint32_t first = model_->offsets[begin];
  return strandcast::measure(*model_, backend_->guidesOf(first, model_->offsets[end] - first),
                             bodies_.primitives(), bodies_.shapes().words, {begin, end});
}

StrandState Simulation::state() {
  StrandState state;
  backend_->download(state);
  for (Vec3& position : state.positions) position = origin_.toWorld(position);
  return state;
}

}  // namespace strandcast
