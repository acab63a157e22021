#include "core/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/geometry.h"
#include "core/name_lookup.h"

namespace strandcast {

HairPull::HairPull(const StrandModel& model, std::span<const Vec3> positions, const Vec3& from, float radius)
    : from_(from), radius_(radius) {
  Held nearest{0, Vec3::Zero()};
  float least = -1;
  for (size_t s = 0; s < model.strands(); ++s) {
    for (uint32_t v = model.offsets[s]; v < model.offsets[s + 1]; ++v) {
      if (model.isPinned(s, v)) continue;
      const float distance = (positions[v] - from).norm();
      if (distance <= radius) held_.push_back({v, positions[v]});
      if (least >= 0 && !(distance < least)) continue;
      least = distance;
      nearest = {v, positions[v]};
    }
  }
  if (held_.empty() && least >= 0) held_.push_back(nearest);
}

void HairPull::moveTo(const Vec3& to, float rate) {
  way_ = to - from_;
  rate_ = rate;
}

void HairPull::addTo(std::span<Vec3> accelerations, std::span<const Vec3> positions,
                     std::span<const Vec3> velocities, float dt) const {
  // v' = v + dt a, x' = x + dt v', and a = rate^2 (target - x') - 2 rate v'.
  const float scale = 1 / (1 + 2 * rate_ * dt + rate_ * rate_ * dt * dt);
  for (const Held& held : held_) {
    const Vec3& v = velocities[held.vertex];
    const Vec3 ahead = held.place + way_ - positions[held.vertex] - dt * v;
    accelerations[held.vertex] += scale * (rate_ * rate_ * ahead - 2 * rate_ * v);
  }
}

namespace {

/// StrandModel::rest_distance from the rest distances of the vertices to `bodies`. No body holds a vertex
/// deeper than `depths`, one per body, m.
std::vector<float> restDistances(const StrandModel& model, std::span<const MovingPrimitive> bodies,
                                 std::span<const uint32_t> words, std::span<const float> depths,
                                 float hair_radius) {
  constexpr float kSlack = 2e-6f;  // m, so that rounding does not press on hair at rest
  std::vector<float> out(model.vertices(), kFarFromBodies), distances;  // distances: of one strand
  for (size_t s = 0; s < model.strands(); ++s) {
    const uint32_t root = model.offsets[s], end = model.offsets[s + 1];
    for (size_t i = 0; i < bodies.size(); ++i) {
      distances.clear();
      for (uint32_t v = root; v < end; ++v)
        distances.push_back(signedDistance(bodies[i], model.restPosition(s, v), words));
      auto inSkin = [&](uint32_t v) { return v >= root && v < end && distances[v - root] < hair_radius; };
      for (uint32_t v = root; v < end; ++v) {
        const float distance = distances[v - root];
        const bool skin = inSkin(v) || ((inSkin(v - 1) || inSkin(v + 1)) && distance < kSkinDepth);
        const float nearest = distance - (skin ? kSkinDepth : kSlack);
        out[v] = std::min(out[v], distance > -depths[i] ? nearest : -kFarFromBodies);
      }
    }
  }
  return out;
}

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
      broad_phase_(broad_phase != nullptr ? std::move(broad_phase) : makeAllPairs()),
      reach_(*model_, strandOrder(*model_), lengths_),
      strand_boxes_(reach_.neighbourhoods()) {
  checkParameters(parameters_, "Simulation");
  effective_parameters_ = withSolvableSubsteps(parameters_);
  std::vector<MovingPrimitive> rooted;
  std::vector<float> depths;
  for (RigidBody& body : bodies) {
    bodies_.push_back(placed(std::move(body), "Simulation"));
    const PlacedBody& added = bodies_.back();
    if (!added.body.holds_roots) continue;
    for (size_t i = 0; i < added.data.size(); ++i) {
      const ContactPrimitive& primitive = added.body.primitives[i];
      rooted.push_back(moved(primitive, added.begin, added.begin, parameters_.time_step, added.data[i]));
      // A field holds only vertices near its samples: deeper inside it stores distance bounds only.
      const FieldGrid* grid = primitive.field ? &primitive.field->grid : nullptr;
      depths.push_back(grid != nullptr ? grid->band - 2 * grid->cell : kFarFromBodies);
    }
  }
  if (!rooted.empty())
    model_->rest_distance = restDistances(*model_, rooted, shapes_.words, depths, parameters_.hair_radius);
  backend_->load(*model_, restState(*model_, model_->rest_roots));
  has_external_forces_ = configureExternalForces(effective_parameters_);
  reserveForBodies();
  backend_->prepare(effective_parameters_, !primitives_.empty());
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

Simulation::PlacedBody Simulation::placed(RigidBody body, const char* where) {
  for (const ContactPrimitive& primitive : body.primitives) checkPrimitive(primitive, where);
  if (!body.follows_head) checkPose(body.pose, where);
  PlacedBody out;
  out.id = next_body_++;
  if (!body.follows_head) out.begin = out.end = body.pose;
  for (const ContactPrimitive& primitive : body.primitives)
    if (body.bends && primitive.field && primitive.rotation.angularDistance(Quat::Identity()) > 1e-6f)
      throw Error("a distance field that bends is rotated within its body", where, "rotate the body instead");
  out.body = std::move(body);
  addShapes(out);
  return out;
}

void Simulation::addShapes(PlacedBody& body) {
  body.data.clear();
  body.bends.clear();
  for (const ContactPrimitive& primitive : body.body.primitives) {
    body.data.push_back(shapes_.add(primitive));
    body.bends.push_back(body.body.bends && primitive.field ? shapes_.addBend() : 0);
  }
}

const Simulation::PlacedBody* Simulation::findOrNull(BodyId body) const {
  for (const PlacedBody& placed : bodies_)
    if (placed.id == body) return &placed;
  return nullptr;
}
bool Simulation::hasBody(BodyId body) const { return findOrNull(body) != nullptr; }
const Simulation::PlacedBody& Simulation::find(BodyId body, const char* where) const {
  if (const PlacedBody* placed = findOrNull(body)) return *placed;
  throw Error("unknown body " + std::to_string(body), where, "it was never added, or was removed");
}
Simulation::PlacedBody& Simulation::find(BodyId body, const char* where) {
  return const_cast<PlacedBody&>(std::as_const(*this).find(body, where));
}

BodyId Simulation::addBody(RigidBody body) {
  PlacedBody added = placed(std::move(body), "Simulation::addBody");
  backend_->prepare(effective_parameters_, true);
  bodies_.push_back(std::move(added));
  reserveForBodies();
  return bodies_.back().id;
}

void Simulation::setBodyPose(BodyId body, const Pose& pose) {
  PlacedBody& known = find(body, "Simulation::setBodyPose");
  if (known.body.follows_head)
    throw Error("body " + std::to_string(body) + " follows the head", "Simulation::setBodyPose",
                "move the head, or add the body without follows_head");
  checkPose(pose, "Simulation::setBodyPose");
  known.end = pose;
}

void Simulation::setBodyBend(BodyId body, const SurfaceBend& bend) {
  PlacedBody& known = find(body, "Simulation::setBodyBend");
  if (!known.body.bends)
    throw Error("body " + std::to_string(body) + " does not bend", "Simulation::setBodyBend",
                "add it with RigidBody::bends");
  const bool finite =
      std::all_of(bend.terms.begin(), bend.terms.end(), [](const Vec3& t) { return t.allFinite(); });
  if (!finite || !bend.middle.allFinite())
    throw Error("a bend is not finite", "Simulation::setBodyBend", "check its terms and middle");
  known.bend_end = bend;
}

const Pose& Simulation::bodyPose(BodyId body) const {
  const PlacedBody& known = find(body, "Simulation::bodyPose");
  return known.body.follows_head ? bones_begin_[0] : known.begin;
}

const SurfaceBend& Simulation::bodyBend(BodyId body) const {
  return find(body, "Simulation::bodyBend").bend_begin;
}

std::vector<BodyId> Simulation::bodyIds() const {
  std::vector<BodyId> ids;
  for (const PlacedBody& known : bodies_) ids.push_back(known.id);
  return ids;
}

const RigidBody& Simulation::body(BodyId body) const { return find(body, "Simulation::body").body; }

void Simulation::removeBody(BodyId body) {
  find(body, "Simulation::removeBody");
  std::erase_if(bodies_, [&](const PlacedBody& known) { return known.id == body; });
  shapes_.clear();
  for (PlacedBody& left : bodies_) addShapes(left);
  placePrimitives();
}

void Simulation::setParameters(const Parameters& parameters) {
  checkParameters(parameters, "Simulation::setParameters");
  if (parameters.solver != parameters_.solver)
    throw Error("the solver of a simulation cannot change", "Simulation::setParameters",
                "make another simulation");
  const Parameters stepped = withSolvableSubsteps(parameters);
  backend_->prepare(stepped, !primitives_.empty());
  const bool surrounded = configureExternalForces(stepped);
  if (surrounded && !has_external_forces_)
    external_forces_->reset(origin_);  // the air has stood still meanwhile
  has_external_forces_ = surrounded;
  parameters_ = parameters;
  effective_parameters_ = stepped;
}

Pose Simulation::toLocal(Pose pose) const {
  pose.position -= origin_;
  return pose;
}

void Simulation::chooseOrigin(const Pose& head) {
  const bool near = head.position.cwiseAbs().maxCoeff() <= kNearOrigin;
  origin_ = near ? Vec3(Vec3::Zero()) : Vec3(head.position.array().round());
  world_guides_.resize(near ? 0 : model_->vertices());
}

void Simulation::placePrimitives() {
  primitives_.clear();  // keeps its memory
  for (const PlacedBody& placed : bodies_) {
    const bool head = placed.body.follows_head;
    const Pose begin = toLocal(head ? bones_begin_[0] : placed.begin),
               end = toLocal(head ? bones_end_[0] : placed.end);
    for (size_t i = 0; i < placed.data.size(); ++i) {
      const ContactPrimitive& primitive = placed.body.primitives[i];
      primitives_.push_back(moved(primitive, begin, end, parameters_.time_step, placed.data[i]));
      if (placed.bends[i] == 0) continue;
      const MovingBend bend = bendOf(primitive, placed.bend_begin, placed.bend_end);
      shapes_.setBend(placed.bends[i], bend);
      applyBend(primitives_.back(), bend, placed.bends[i]);
    }
  }
}

void Simulation::reserveForBodies() {
  constexpr size_t kMax = size_t{1} << 22;
  placePrimitives();
  body_boxes_.reserve(primitives_.size());
  near_.offsets.reserve(strand_boxes_.size() + 1);
  near_.bodies.reserve(std::min(strand_boxes_.size() * primitives_.size(), kMax));
}

void Simulation::findNearBodies() {
  body_boxes_.clear();
  for (const MovingPrimitive& primitive : primitives_) body_boxes_.push_back(sweptBox(primitive));
  reach_.place(bones_begin_local_, bones_end_local_, parameters_.hair_radius + kQueryReach, strand_boxes_);
  broad_phase_->findPairs(body_boxes_, strand_boxes_, near_);
}

StepInput Simulation::nextInput() {
  placePrimitives();
  for (size_t bone = 0; bone < bones_begin_.size(); ++bone) {
    bones_begin_local_[bone] = toLocal(bones_begin_[bone]);
    bones_end_local_[bone] = toLocal(bones_end_[bone]);
  }
  // The broad phase needs bounded strands. Strands of the rod stay within their length of the root; others
  // may stretch.
  const bool listed = parameters_.solver == SolverKind::kRod && !primitives_.empty();
  if (listed) findNearBodies();
  return {&effective_parameters_,   bones_begin_local_, bones_end_local_, primitives_, {}, &shapes_,
          listed ? &near_ : nullptr};
}

void Simulation::step() {
  StepInput input = nextInput();
  if (has_external_forces_) external_forces_->step(input, *backend_);
  if (pull_) addPull(input);
  backend_->step(input);
  bones_begin_ = bones_end_;
  for (PlacedBody& body : bodies_) {
    body.begin = body.end;
    body.bend_begin = body.bend_end;
  }
  time_ += parameters_.time_step;
  ++steps_;
}

void Simulation::pullHair(const Vec3& from, float radius, const Vec3& to, float rate) {
  const auto is_place = [](const Vec3& place) {
    return place.allFinite() && place.cwiseAbs().maxCoeff() <= kMaxHandCoordinate;
  };
  const bool sound =
      is_place(from) && is_place(to) && radius >= 0 && radius <= 10 && rate >= 0 && rate <= 1000;
  if (!sound)
    throw Error("a pull is out of range",
                fmt::format("from {} {} {} to {} {} {}, radius {} m, rate {} 1/s", from.x(), from.y(),
                            from.z(), to.x(), to.y(), to.z(), radius, rate),
                "give places within 1000 m, a radius of 0 to 10 m and a rate of 0 to 1000 1/s");
  if (!backend_->takesAccelerations())
    throw Error("this backend does not support pulls", backend_->name(), "choose simd, gpu or reference");
  if (!pull_ || !pull_->closedAt(from, radius)) pull_.emplace(*model_, guides(), from, radius);
  pull_->moveTo(to, rate);
  backend_->prepareAccelerations();
  pull_accelerations_.resize(model_->vertices());
}

void Simulation::addPull(StepInput& input) {
  if (has_external_forces_) {
    const std::span<const Vec3> others = external_forces_->accelerations();
    std::copy(others.begin(), others.end(), pull_accelerations_.begin());
  } else {
    std::fill(pull_accelerations_.begin(), pull_accelerations_.end(), Vec3::Zero());
  }
  pull_->addTo(pull_accelerations_, guides(), backend_->velocities(), parameters_.time_step);
  input.accelerations = pull_accelerations_;
}

bool needsExternalForces(const Parameters& p) {
  const bool varies = (p.gust > 0 || p.turbulence > 0) && !p.wind.isZero();
  return p.wind_grid > 0 || varies || p.air_drag_along < 1 || p.volume_stiffness > 0 || p.hair_friction > 0;
}

std::vector<Pose> Simulation::rootPoses() const { return rootPosesOn(*model_, bones_begin_); }

StrandState Simulation::restNow() const {
  std::vector<Pose> bones;
  for (const Pose& bone : bones_begin_) bones.push_back(toLocal(bone));
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
  for (PlacedBody& body : bodies_) {
    body.end = body.begin;
    body.bend_end = body.bend_begin;
  }
  chooseOrigin(bones_begin_[0]);
  uploadState(restNow());
  if (external_forces_) external_forces_->reset(origin_);
}

void Simulation::uploadState(const StrandState& state) {
  placePrimitives();
  backend_->upload(state);
}

void Simulation::rebaseOrigin() {
  if (toLocal(bones_begin_[0]).position.cwiseAbs().maxCoeff() <= kFarFromOrigin) return;
  StrandState state;
  backend_->download(state);
  const Vec3 before = origin_;
  chooseOrigin(bones_begin_[0]);
  const Vec3 way = before - origin_;
  for (Vec3& position : state.positions) position += way;
  uploadState(state);
  if (has_external_forces_) external_forces_->moveOrigin(origin_);
}

size_t Simulation::resetDiverged() {
  constexpr float kTooFar = 2;  // times its length; only gauss_seidel could reach that
  rebaseOrigin();
  const std::span<const Vec3> now = backend_->guides();
  std::vector<size_t> broken;
  for (size_t s = 0; s < model_->strands(); ++s) {
    const uint32_t first = model_->offsets[s], end = model_->offsets[s + 1];
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

void Simulation::teleport(const Pose& head) {
  checkPose(head, "Simulation::teleport");
  StrandState state;
  backend_->download(state);
  // All poses are relative to the old or the new origin: world coordinates of a far head are too coarse for
  // the difference.
  const Pose from = toLocal(bones_begin_[0]);
  for (Pose& bone : bones_begin_) bone = toLocal(bone);
  chooseOrigin(head);
  const Pose carry = toLocal(head) * from.inverse();
  for (Vec3& position : state.positions) position = carry.apply(position);
  for (std::vector<Vec3>* plane : {&state.velocities, &state.contacts})
    for (Vec3& vector : *plane) vector = carry.rotate(vector);
  for (Quat& frame : state.frames) frame = (carry.rotation * frame).normalized();
  for (Pose& bone : bones_begin_) {
    bone = carry * bone;
    bone.rotation.normalize();
    bone.position += origin_;
  }
  bones_begin_[0] = head;
  bones_end_ = bones_begin_;
  uploadState(state);
  if (external_forces_) external_forces_->reset(origin_);
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
  bones_begin_ = bones_end_;
  for (PlacedBody& body : bodies_) {
    body.begin = body.end;
    body.bend_begin = body.bend_end;
  }
  chooseOrigin(bones_begin_[0]);
  StrandState own = state;
  for (Vec3& position : own.positions) position -= origin_;
  uploadState(own);
  if (external_forces_) external_forces_->reset(origin_);
  time_ = time;
}

std::span<const Vec3> Simulation::guides() {
  const std::span<const Vec3> own = backend_->guides();
  if (origin_.isZero()) return own;
  std::transform(own.begin(), own.end(), world_guides_.begin(),
                 [this](const Vec3& p) { return Vec3(p + origin_); });
  return world_guides_;
}

Measurement Simulation::measure(StrandRange strands) {
  return strandcast::measure(*model_, backend_->guides(), primitives_, shapes_.words, strands);
}

StrandState Simulation::state() {
  StrandState state;
  backend_->download(state);
  for (Vec3& position : state.positions) position += origin_;
  return state;
}

}  // namespace strandcast
