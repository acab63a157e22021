#include "service/stage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>

#include "collision/field_bake.h"
#include "core/error.h"
#include "options/console.h"
#include "options/scene_loading.h"
#include "transport/recording/record_file.h"

namespace strandcast {
namespace {

/// Checks what is cheap to check before the groom is claimed.
CharacterSettings checked(const CharacterSettings& character) {
  if (!character.record.empty()) RecordWriter::check(character.record);
  const std::filesystem::path& folder = character.settings.collider_folder;
  if (!folder.empty() && !std::filesystem::is_directory(folder))
    throw Error("the collider folder is not there", folder.string(),
                "name a folder of meshes (--collider-folder)");
  return character;
}

}  // namespace

Character::Character(const CharacterSettings& character, const DaemonChannel& join)
    : character_(checked(character)),
      session_(newSession()),
      claim_(character.settings, session_, join(character.settings, session_)) {
  publisher_ = claim_.take();
}

void Character::load() {
  Scene scene = makeSceneWithProgress(character_.settings.scene, [&] { claim_.check(); });
  if (!character_.record.empty()) {
    auto recorded = std::make_unique<RecordingPublisher>(std::move(publisher_));
    recording_ = recorded.get();
    publisher_ = std::move(recorded);
  }
  daemon_ = std::make_unique<Daemon>(character_.settings, std::move(scene), *publisher_, session_);
}

void Character::announce(const RecordingSource& source) {
  const Settings& settings = character_.settings;
  claim_.await();
  if (recording_ != nullptr) {
    if (settings.claim)
      spdlog::warn(
          "{} can be replayed but not simulated again: a shared groom is the work of several daemons",
          character_.record.string());
    const Status& status = daemon_->status();
    recording_->open(character_.record,
                     {settings.groom_id, settings.codec,
                      settings.claim ? "" : source(settings.groom_id, status.backend, status.device)});
  }
  if (g_interrupted) throw Interrupted();
  daemon_->announce();
  spdlog::info("{} groom {} on {} at {:g} frames/s; Ctrl-C ends it",
               settings.claim ? "sharing" : "publishing", settings.groom_id, networkName(settings),
               settings.rate);
}

CharacterEnding Character::cast(const std::atomic<bool>& stop) {
  CharacterEnding ending{character_.label(), character_.settings.groom_id, {}, {}, {}, true};
  ending.summary = daemon_->run(stop);
  ending.failure = ending.summary->failure;
  if (recording_ != nullptr) ending.recording_failure = recording_->close();
  ending.is_kept = ending.recording_failure.empty() && publisher_->failure().empty();
  return ending;
}

void shareMachine(std::vector<CharacterSettings>& characters, unsigned cores) {
  if (characters.size() < 2) return;
  const auto count = static_cast<double>(characters.size());
  const double processors = std::max(cores, 1u);
  const int share = std::max(1, static_cast<int>(processors / count));  // threads
  for (CharacterSettings& character : characters) {
    Settings& settings = character.settings;
    if (settings.threads == 0) settings.threads = settings.codec.threads = share;
    // The cost of a frame is that of one of its threads.
    if (character.budget_ms == 0)
      character.budget_ms = 1000 / settings.rate / std::max(1.0, count / processors) *
                            std::min(1.0, static_cast<double>(share) / settings.threads);
  }
}

namespace {

/// A place on the stage: a character, until it has ended or failed.
struct Place {
  CharacterEnding ending;
  std::unique_ptr<Character> character;

  /// Does a part of the character's work. Where that fails, the character leaves the stage.
  template <class Work>
  void attempt(const Work& work) {
    const LogLabel label(ending.character);
    try {
      work();
      return;
    } catch (const BakeStopped&) {
      throw;
    } catch (const std::exception& error) {
      ending.failure = error.what();
    }
    spdlog::error("{}", ending.failure);
    character.reset();
  }
};

/// Casts the character in this thread, to its end.
void cast(Place& place, const std::atomic<bool>& stop) {
  place.attempt([&] {
    place.ending = place.character->cast(stop);
    const CharacterEnding& ending = place.ending;
    for (const std::string& failure : {ending.recording_failure, ending.failure})
      if (!failure.empty()) spdlog::error("{}", failure);
    if (!stop && ending.failure.empty())
      spdlog::info("ended: {} frames, {} late", ending.summary->status.frames, ending.summary->late_frames);
    place.character.reset();  // its claim ends, while others go on
  });
}

}  // namespace

std::vector<CharacterEnding> Stage::run(const std::atomic<bool>& stop) {
  printLogLabels();
  std::vector<Place> places(characters_.size());
  for (size_t i = 0; i < places.size(); ++i) {
    places[i].ending.character = characters_[i].label();
    places[i].ending.groom_id = characters_[i].settings.groom_id;
    places[i].attempt([&] { places[i].character = std::make_unique<Character>(characters_[i], join_); });
  }
  for (Place& place : places)
    if (place.character) place.attempt([&] { place.character->load(); });
  for (Place& place : places)
    if (place.character)
      place.attempt([&] {
        place.character->announce(source_);
        const CharacterSettings& settings = place.character->settings();
        if (settings.budget_ms > 0)
          place.character->daemon().setBudget({settings.budget_ms, settings.settings.rate, pressure_});
      });
  std::vector<std::jthread> threads;
  for (Place& place : places)
    if (place.character) place.attempt([&] { threads.emplace_back([&place, &stop] { cast(place, stop); }); });
  threads.clear();  // joins
  std::vector<CharacterEnding> endings;
  for (Place& place : places) endings.push_back(std::move(place.ending));
  return endings;
}

}  // namespace strandcast
