#pragma once
#include <span>
#include <vector>

#include "options/settings.h"
#include "render/hair_bodies.h"
#include "render/hair_pass.h"
#include "scenes/scene.h"
#include "transport/codec/codec.h"
#include "transport/messages.h"

namespace strandcast {

/// A groom whose hairs are bound to a few of them: what the wire and the renderer make of it, and how far it
/// is from the simulation of every strand. Needs a current OpenGL 4.5 context for its whole life.
class BoundHairTrial {
 public:
  /// Chooses one guide per `strands_per_guide` strands of the scene, binds all strands to them, encodes the
  /// hairs with the codec's default error and decodes them. `settings`: of the scene, for shake(). Throws
  /// Error.
  BoundHairTrial(const Settings& settings, size_t strands_per_guide);

  const StrandSet& guides() const { return guides_; }
  const StrandSet& strands() const { return scene_.groom.strands; }
  const HairDescription& hairs() const { return received_; }  ///< as a receiver has them
  size_t wireBytes() const { return wire_bytes_; }            ///< of all chunks' payloads

  /// m, largest distance of a drawn vertex from the artist's, where guides are at rest, as a reader has them.
  double worstAtRest(const CodecOptions& guides = {Codec::kFloat32});

  /// Hair during a shake of the head of a second, RMS over all vertices and times.
  struct Shaken {
    double worst_shader = 0;  ///< m, largest distance of the shader's bound hair from double precision
    double bound = 0;         ///< m, from the same strand, simulated
    double seeded = 0;        ///< m, of the seed-grown hair with the nearest root, from the simulated strand
    double motion = 0;        ///< m, of simulated strands from where the head alone carries them
    double stretch = 0;       ///< relative change of length of a bound hair, RMS over hairs
    /// m, largest change because guides near rest count as at rest (motionShare): of hair whose guides bend
    /// as at the end, but only as far as that takes most.
    double leaving_rest = 0;
  };
  /// Simulates every strand, and the guides alone.
  Shaken shake();

  /// Grows the bound hairs where guides are at these positions.
  void grow(std::span<const Vec3> guides, const Pose& head);
  HairPass& pass() { return pass_; }
  /// The bodies of the scene, for pass().bodies(); none in the beginning.
  std::vector<HairObstacle> obstacles() const;
  const GuideNodes& nodes() const { return nodes_; }

 private:
  std::vector<Vec3> grownBound() const;
  double worstLeavingRest(std::span<const Vec3> bent, const Pose& head) const;

  Settings settings_;
  Scene scene_;
  StrandSet guides_;
  HairDescription received_;
  size_t wire_bytes_ = 0;
  GuideNodes nodes_;
  HairPass pass_;
};

}  // namespace strandcast
