// Effect of grooming on the vertices of a block in a step: the share of velocity that air drag leaves, and the mass
// that the goal pull adds (kernels/grooming.h). Included after core/near_bodies.inl.
class Grooming {
 public:
  // `scratch`: of the block.
  Grooming(const Block& b, const StepInput& input, Scalar* scratch)
      : block_(b), rows_(scratch + solverScratch(b.vertices, kLanes)), wind_(fill3(input.parameters->wind)) {
    const Parameters& p = *input.parameters;
    on_ = b.factors || p.goal_rate > 0;
    if (!on_) return;
    const double h = static_cast<double>(p.time_step) / p.substeps;
    const DragStep usual(p.air_drag, h);
    substep_ = lit(h);
    keep_ = lit(usual.keep);
    time2_ = lit(usual.time2);
    gravity_ = fill3(p.gravity);
    for (int i = 0; i < b.vertices; ++i) {
      Scalar *keep = row(kKeep, i), *time2 = row(kTime2, i);
      for (int lane = 0; lane < kLanes; ++lane) {
        const double scale = b.grooming != nullptr ? plane(kAirDragScale, i)[lane] : 1.0;
        const DragStep own(p.air_drag * scale, h);
        keep[lane] = static_cast<Scalar>(own.keep);
        time2[lane] = static_cast<Scalar>(own.time2);
      }
      const real free = select(load(massData(b, kWeight, i)) > lit(0), lit(1), lit(0));
      const real own_mass = load(massData(b, kMass, i));
      const real m = select(free > lit(0), own_mass * (time2_ * inverse(load(time2))), own_mass);
      const real rate = lit(p.goal_rate) * groomingFactor(b, kGoalScale, i) * free;
      const real stiffness = goalStiffness(own_mass, rate, time2_);
      store(rate, row(kRate, i));
      store(stiffness, row(kStiffnessAdded, i));
      store(m + stiffness, row(kMassWith, i));
      store(free * inverse(m + stiffness), row(kWeightWith, i));
    }
  }
  // Whether any grooming acts. If not, no other member may be called.
  bool on() const { return on_; }

  real keep(int i) const { return load(row(kKeep, i)); }
  real time2(int i) const { return load(row(kTime2, i)); }  // s^2, see DragStep
  real rate(int i) const { return load(row(kRate, i)); }    // 1/s, of the goal pull; 0 if pinned
  real mass(int i) const {
    return load(row(kMassWith, i));
  }  // effective: for forces times the usual time2, with the goal's stiffness
  real weight(int i) const { return load(row(kWeightWith, i)); }
  // Right-hand side of the rod's bending system for vertex i at `shift` in this substep, without internal forces.
  // `way`: displacement by gravity, wind and external forces with the usual air drag, less RodStep::jump_, without goal
  // pull.
  real3 loadTowardsGoal(int i, const real3& way, const RootFrame& root, const real3& shift) const {
    const real3 lack = (restPoint(block_, root, i) - load3(block_.position, i)) - shift;
    const real3 driven = block_.acceleration != nullptr ? gravity_ + accelerationOf(block_, i) : gravity_;
    const real3 own = madd(driven, time2(i) - time2_, madd(wind_, (keep_ - keep(i)) * substep_, way));
    const real3 pulled = goalPull(own, mass(i), load(row(kStiffnessAdded, i)), lack);
    return select(weight(i) > lit(0), pulled, makeReal3(lit(0), lit(0), lit(0)));
  }

 private:
  enum Row : int { kKeep, kTime2, kRate, kStiffnessAdded, kMassWith, kWeightWith };
  static_assert(kWeightWith + 1 == kGroomingRows);
  Scalar* row(Row which, int i) const { return rows_ + (static_cast<size_t>(i) * kGroomingRows + which) * kLanes; }
  const Scalar* plane(GroomingPlane which, int i) const {
    return block_.grooming + (static_cast<size_t>(i) * kGroomingPlanes + which) * kLanes;
  }

  const Block& block_;
  Scalar* rows_;
  real3 wind_, gravity_;
  real substep_ = lit(0), keep_ = lit(1), time2_ = lit(0);
  bool on_ = false;
};
