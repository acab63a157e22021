#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

inline constexpr int kFilmVertices = 32;  ///< per strand
inline constexpr size_t kFilmFrames = 32;
inline constexpr double kFilmRate = 120;  ///< frames per second of simulation time

/// Hair in motion, simulated in advance, so that measurements cover only the wire.
struct Film {
  GroomDescription groom;
  BodyDescription body;
  std::vector<GuideFrame> frames;  ///< kFilmFrames
};
/// Simulates the film with `strands` wavy strands.
std::unique_ptr<Film> makeFilm(int strands);

/// Index of the film frame to send as frame `number`, from 1, at a rate that divides kFilmRate. Plays
/// forwards and backwards, so that the hair never jumps.
size_t filmPlace(uint64_t number, double rate);

/// The positions of a film in shared memory, for another process to compare with what it receives.
class SharedFilm {
 public:
  /// Throws Error where there is not enough memory.
  explicit SharedFilm(const Film& film);
  ~SharedFilm();
  SharedFilm(const SharedFilm&) = delete;
  SharedFilm& operator=(const SharedFilm&) = delete;
  /// A file that other processes of this user can map during this object's lifetime.
  std::string path() const;

 private:
  int file_ = -1;
};

/// Maps that file in the other process.
class MappedFilm {
 public:
  /// Throws Error where the file is not a complete film.
  explicit MappedFilm(const std::string& path);
  ~MappedFilm();
  MappedFilm(const MappedFilm&) = delete;
  MappedFilm& operator=(const MappedFilm&) = delete;
  /// Positions of the frame at this index.
  std::span<const Vec3> at(size_t place) const;

 private:
  const Vec3* positions_ = nullptr;
  size_t vertices_ = 0;  // per frame
};

}  // namespace strandcast
