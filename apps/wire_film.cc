#include "apps/wire_film.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "apps/scene_simulation.h"
#include "core/error.h"

namespace strandcast {
namespace {

constexpr double kWarmUp = 0.5;  // s of simulation before the film begins

/// Writes all positions; false on failure.
bool writeAll(int file, std::span<const Vec3> positions) {
  const char* from = reinterpret_cast<const char*>(positions.data());
  for (size_t left = positions.size_bytes(); left > 0;) {
    const ssize_t written = write(file, from, left);
    if (written <= 0) return false;
    from += written;
    left -= static_cast<size_t>(written);
  }
  return true;
}

}  // namespace

std::unique_ptr<Film> makeFilm(int strands) {
  Settings settings;
  settings.scene.name = "wavy";
  settings.scene.strands = strands;
  settings.scene.vertices = kFilmVertices;
  // One step per frame, so that no two frames are equal.
  settings.parameters.emplace_back("time_step", std::vector<double>{1 / kFilmRate});
  Scene scene = makeScene(settings.scene, {});
  Simulation simulation = makeSimulation(scene, settings);
  auto film = std::make_unique<Film>();
  film->groom.name = scene.name;
  film->groom.revision = 1;
  film->groom.guides = scene.groom.strands;
  film->body.mesh = scene.body;
  film->body.head_weights = scene.head_weights;
  film->frames.resize(kFilmFrames);
  const double step = simulation.parameters().time_step;
  double due = kWarmUp;
  for (GuideFrame& frame : film->frames) {
    for (; simulation.time() < due - step / 2; simulation.step())
      simulation.setHeadPose(scene.motion(simulation.time() + step));
    due += 1 / kFilmRate;
    const std::span<const Vec3> guides = simulation.guides();
    frame.positions.assign(guides.begin(), guides.end());
    frame.head = simulation.headPose();
    frame.revision = 1;
  }
  return film;
}

size_t filmPlace(uint64_t number, double rate) {
  constexpr size_t kTurn = 2 * (kFilmFrames - 1);
  const size_t place = number * static_cast<size_t>(kFilmRate / rate) % kTurn;
  return place < kFilmFrames ? place : kTurn - place;
}

SharedFilm::SharedFilm(const Film& film) : file_(memfd_create("strandcast film", MFD_CLOEXEC)) {
  bool is_whole = file_ >= 0;
  for (const GuideFrame& frame : film.frames) is_whole = is_whole && writeAll(file_, frame.positions);
  if (is_whole) return;
  if (file_ >= 0) close(file_);
  throw Error("no shared memory for the film to compare with",
              fmt::format("{} guides", film.groom.guides.strands()), "choose fewer with --only");
}

SharedFilm::~SharedFilm() { close(file_); }

std::string SharedFilm::path() const { return fmt::format("/proc/{}/fd/{}", getpid(), file_); }

MappedFilm::MappedFilm(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  void* start = MAP_FAILED;
  const bool is_film = file >= 0 && fstat(file, &status) == 0 && status.st_size > 0 &&
                       static_cast<size_t>(status.st_size) % (kFilmFrames * sizeof(Vec3)) == 0;
  if (is_film) {
    vertices_ = static_cast<size_t>(status.st_size) / (kFilmFrames * sizeof(Vec3));
    start = mmap(nullptr, static_cast<size_t>(status.st_size), PROT_READ, MAP_SHARED | MAP_POPULATE, file, 0);
  }
  if (file >= 0) close(file);
  if (start == MAP_FAILED)
    throw Error("this file is not a film", path, "it is made by `strandcast validate wire`");
  positions_ = static_cast<const Vec3*>(start);
}

MappedFilm::~MappedFilm() { munmap(const_cast<Vec3*>(positions_), vertices_ * kFilmFrames * sizeof(Vec3)); }

std::span<const Vec3> MappedFilm::at(size_t place) const {
  return {positions_ + place * vertices_, vertices_};
}

}  // namespace strandcast
