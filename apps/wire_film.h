#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "transport/messages.h"

namespace strandcast {

inline constexpr int kFilmVertices = 32;  ///< of a strand
inline constexpr size_t kFilmFrames = 32;
inline constexpr double kFilmRate = 120;  ///< frames per second of simulation time

/// Hair in motion, simulated before it is cast, so that what is measured is the wire alone.
struct Film {
  GroomDescription groom;
  BodyDescription body;
  std::vector<GuideFrame> frames;  ///< kFilmFrames
};
std::unique_ptr<Film> makeFilm(int strands);

/// Which of the film's frames is cast as this one, from 1, at a rate that divides kFilmRate: to and fro, so
/// that the hair never jumps.
size_t filmPlace(uint64_t number, double rate);

/// The positions of a film for another process to compare with what it receives.
class SharedFilm {
 public:
  /// Throws Error where there is no memory for it.
  explicit SharedFilm(const Film& film);
  ~SharedFilm();
  SharedFilm(const SharedFilm&) = delete;
  SharedFilm& operator=(const SharedFilm&) = delete;
  /// Of a file that other processes of this user can map while this lives.
  std::string path() const;

 private:
  int file_ = -1;
};

/// That file, in the other process.
class MappedFilm {
 public:
  /// Throws Error where it is no whole film.
  explicit MappedFilm(const std::string& path);
  ~MappedFilm();
  MappedFilm(const MappedFilm&) = delete;
  MappedFilm& operator=(const MappedFilm&) = delete;
  /// Positions of the frame at this place.
  std::span<const Vec3> at(size_t place) const;

 private:
  const Vec3* positions_ = nullptr;
  size_t vertices_ = 0;  // of a frame
};

}  // namespace strandcast
