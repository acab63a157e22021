// The suite "wire": the film that is sent, the process that receives it, and the cases.
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "service/process.h"
#include "transport/messages.h"
#include "validation/suite.h"

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

namespace CLI {
class App;
}

namespace strandcast {

/// Declares the verb `wire-reader`, the child process of the suite "wire", which receives a film. It prints
/// "ready" once it has the groom. After the last frame, or a second after its input ended, it prints one line
/// of JSON, a WireReading.
std::function<int()> addWireReader(CLI::App& app);

/// What the reader process measured.
struct WireReading {
  uint64_t frames_whole = 0, frames_concealed = 0;
  double processor_seconds = 0;  ///< s, of all its threads since "ready", without the comparisons
  /// Largest distance of a received vertex from the film, mm, over about every tenth complete frame; NaN
  /// where none was compared.
  double worst_error_mm = 0;
  /// Number of each frame and its completion time, ns by the steady clock.
  std::vector<std::pair<uint64_t, int64_t>> arrivals;
};

/// Arguments for the reader process.
struct WireReaderOptions {
  std::string transport;  ///< "dds" or "lcm"
  int domain = 0;
  uint64_t last_frame = 1;
  double rate = 60;  ///< frames per second
  std::string film;  ///< SharedFilm::path()
};

/// The reader process, as seen from the publisher's process. All waits for it are bounded.
class WireReader {
 public:
  explicit WireReader(const WireReaderOptions& options);
  /// Waits for "ready". False where the process ended or has no groom within 30 s.
  bool waitReady();
  /// Call after the last frame was sent. Empty where the process ended or does not answer within 10 s.
  std::optional<WireReading> reading();
  /// Why there is no reading, as text. Ends the process.
  std::string failure() { return "the reader " + process_.end(); }

 private:
  ChildProcess process_;
};

/// "wire": simulated hair sent and received on this machine, for each transport, codec, number of guides and
/// rate. Documented promises have a limit; other quantities have an infinite limit and are reported only.
/// Ignores the laboratory's backend. Other load on the machine affects the results.
const Suite& wireSuite();

}  // namespace strandcast
