#include "apps/viewer/session.h"

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "service/network.h"
#include "service/stream.h"

namespace strandcast {
namespace {

constexpr std::chrono::seconds kPatience{5};

}  // namespace

CommandSender::CommandSender(Subscriber& subscriber) : subscriber_(subscriber), thread_([this] { run(); }) {}

CommandSender::~CommandSender() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

uint64_t CommandSender::send(CommandKind kind, const std::string& name, std::vector<double> values) {
  Command command;
  const uint64_t id = newSession();
  command.id = id;
  command.kind = kind;
  command.name = name;
  command.values = std::move(values);
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(queue_, [&](const Command& other) {
      return other.kind == kind && other.name == name && kind != CommandKind::kStep;
    });
    queue_.push_back(std::move(command));
  }
  changed_.notify_all();
  return id;
}

size_t CommandSender::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size() + (asking_ ? 1 : 0);
}

std::vector<CommandOutcome> CommandSender::takeOutcomes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(outcomes_, {});
}

void CommandSender::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return stop_ || !queue_.empty(); });
    if (stop_) return;
    const Command command = queue_.front();
    queue_.pop_front();
    asking_ = true;
    lock.unlock();
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    CommandOutcome outcome{command.id, command.kind, command.name, "the daemon did not answer"};
    try {
      const auto answer = ask(subscriber_, command, [&] {
        const std::lock_guard stopping(mutex_);
        return stop_ || std::chrono::steady_clock::now() > deadline;
      });
      if (answer) outcome.refusal = *answer;
    } catch (const Error& error) {
      outcome.refusal = error.what();
    }
    lock.lock();
    asking_ = false;
    outcomes_.push_back(std::move(outcome));
  }
}

void NetworkList::listen() {
  if (listens()) return;
  problem_.clear();
  joining_ = std::async(std::launch::async, [settings = settings_] { return subscribe(settings); });
}

std::vector<Status> NetworkList::daemons() {
  if (joining_.valid() && joining_.wait_for(std::chrono::seconds(0)) == std::future_status::ready) {
    try {
      subscriber_ = joining_.get();
    } catch (const Error& error) {
      problem_ = error.what();
    }
  }
  return subscriber_ ? subscriber_->allStatuses() : std::vector<Status>{};
}

namespace {

constexpr int kSliceSize = 192;  // pixels
constexpr std::chrono::milliseconds kSliceInterval{200};

/// The description of a daemon's parameter; generic where this program does not know it.
ParameterInfo infoOf(const std::string& name, size_t components) {
  const int count = static_cast<int>(components);
  for (const ParameterInfo& info : parameterList())
    if (info.name == name && info.components == count) return info;
  constexpr double kAny = 1e9;
  return {name, "", "as the daemon defines", "known only to the daemon", count, -kAny, kAny, false};
}

}  // namespace

ViewerSession::ViewerSession(const Settings& settings, bool here, double timeout, Playout playout)
    : here_(here),
      groom_id_(settings.groom_id),
      stream_(settings, here, timeout, [this](Simulation& simulation) { observe(simulation); }),
      player_(stream_.subscriber(), playout),
      commands_(stream_.subscriber()) {}

ViewerSession::~ViewerSession() { stopRecording(); }

std::optional<std::vector<double>> ViewerSession::parameter(const std::string& name) const {
  if (const auto sent = sent_.find(name); sent != sent_.end()) return sent->second.values;
  if (const auto told = received_values_.find(name); told != received_values_.end()) return told->second;
  return std::nullopt;
}

std::vector<double> ViewerSession::usualParameter(const std::string& name) const {
  const auto first = initial_values_.find(name);
  return first != initial_values_.end() ? first->second : strandcast::parameter(Parameters(), name);
}

void ViewerSession::setParameter(const std::string& name, const std::vector<double>& values) {
  sent_[name] = {commands_.send(CommandKind::kSetParameter, name, values), values};
}

std::vector<CommandOutcome> ViewerSession::takeOutcomes() {
  std::vector<CommandOutcome> outcomes = commands_.takeOutcomes();
  for (const CommandOutcome& outcome : outcomes)
    std::erase_if(sent_, [&](const auto& sent) { return sent.second.id == outcome.id; });
  takeParameters();
  return outcomes;
}

void ViewerSession::takeParameters() {
  const std::optional<Status> status = stream_.subscriber().status();
  if (!status || status->parameters.components.empty()) return;
  const NamedValues values = entriesOf(status->parameters, "");
  received_values_ = {values.begin(), values.end()};
  if (received_from_ != status->session) {
    received_from_ = status->session;
    initial_values_ = received_values_;
    settable_.clear();
    for (const auto& [name, components] : values) settable_.push_back(infoOf(name, components.size()));
  }
}

NamedValues ViewerSession::parameters() const {
  NamedValues all;
  for (const ParameterInfo& info : parameterList())
    if (const auto values = parameter(info.name)) all.emplace_back(info.name, *values);
  return all;
}

void ViewerSession::requestSlice(const std::optional<SliceRequest>& request) {
  const std::lock_guard lock(mutex_);
  request_ = request;
  if (!here_) slice_problem_ = "a daemon does not publish its grids: name a --scene to simulate here";
}

std::optional<AirSlice> ViewerSession::takeSlice() {
  const std::lock_guard lock(mutex_);
  return std::exchange(slice_, std::nullopt);
}

std::string ViewerSession::sliceProblem() const {
  const std::lock_guard lock(mutex_);
  return slice_problem_;
}

void ViewerSession::observe(Simulation& simulation) {
  std::optional<SliceRequest> wanted;
  {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (!request_ || now < slice_due_) return;
    slice_due_ = now + kSliceInterval;
    wanted = request_;
  }
  std::optional<AirSlice> slice;
  std::string problem;
  try {
    slice = airSlice(fieldsWith(simulation, wanted->quantity), wanted->quantity, wanted->axis,
                     simulation.guides(), kSliceSize);
  } catch (const Error& error) {
    problem = error.what();
  }
  const std::lock_guard lock(mutex_);
  if (slice) slice_ = std::move(slice);
  slice_problem_ = problem;
}

void ViewerSession::startRecording(const std::filesystem::path& file) {
  stopRecording();
  RecordingOptions options;
  options.groom_id = groom_id_;
  auto recording = std::make_shared<StreamRecording>(subscriber(), file, options);
  stop_recording_ = false;
  recorded_seconds_ = 0;
  {
    const std::lock_guard lock(mutex_);
    recording_problem_.clear();
  }
  recording_ = std::thread([this, recording] {
    try {
      while (!stop_recording_) {
        recording->take(std::chrono::milliseconds(100));
        recorded_seconds_ = recording->recorder().seconds();
      }
      recording->close();
    } catch (const Error& error) {
      const std::lock_guard lock(mutex_);
      recording_problem_ = error.what();
    }
  });
}

void ViewerSession::stopRecording() {
  stop_recording_ = true;
  if (recording_.joinable()) recording_.join();
}

std::string ViewerSession::recordingProblem() const {
  const std::lock_guard lock(mutex_);
  return recording_problem_;
}

}  // namespace strandcast
