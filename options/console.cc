#include "options/console.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <poll.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/spdlog.h>
#include <unistd.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <system_error>

#include "collision/field_bake.h"
#include "core/error.h"
#include "core/name_lookup.h"
#include "io/text_number.h"

namespace strandcast {

std::atomic<bool> g_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "signal handlers may only touch lock-free atomics");

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_interrupted = true; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // a second Ctrl-C kills a program that hangs
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

namespace {

/// Inserts the leading 0: CLI11 takes -0.5 for a number and -.5 for an option.
std::string withWholePart(const std::string& argument) {
  const bool is_short = argument.starts_with("-.") && argument.size() > 2 &&
                        std::isdigit(static_cast<unsigned char>(argument[2])) != 0;
  if (!is_short) return argument;
  return numberOf(argument) ? "-0" + argument.substr(1) : argument;
}

/// Appends the option names of `app` and of its option groups.
void addOptionNames(const CLI::App& app, std::vector<std::string>& names) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* group :
       app.get_subcommands([](const CLI::App* sub) { return sub->get_name().empty(); }))
    addOptionNames(*group, names);
}

/// A suggestion for a word that no program or verb knows, to end a message with.
std::string adviceOn(const std::string& word, const CLI::App& verb) {
  std::vector<std::string> known;
  if (word.starts_with('-')) {
    for (const CLI::App* app = &verb; app != nullptr; app = app->get_parent()) addOptionNames(*app, known);
    return didYouMean(word.substr(0, word.find('=')), known);
  }
  for (const CLI::App* sub : verb.get_subcommands(nullptr))
    if (!sub->get_name().empty() && !sub->get_group().empty()) known.push_back(sub->get_name());
  const std::string near = didYouMean(word, known);
  return near.empty() && !known.empty() ? fmt::format("choose one of {}", fmt::join(known, ", ")) : near;
}

/// The message on unexpected arguments; empty where there are none.
std::string unexpected(const CLI::App& app) {
  const CLI::App* verb = &app;
  std::string called = std::filesystem::path(app.get_name()).filename().string();
  while (!verb->get_subcommands().empty()) {
    verb = verb->get_subcommands().front();
    called += ' ' + verb->get_name();
  }
  const std::vector<std::string> left = app.remaining(true);
  if (left.empty()) return {};
  const std::string& word = left.front();
  const bool is_option = word.starts_with('-'), has_verbs = verb->get_require_subcommand_min() > 0;
  const std::string advice = adviceOn(word, *verb), see = fmt::format("see `{} --help`", called);
  return Error(fmt::format("'{}' is not {}", word,
                           is_option   ? "an option"
                           : has_verbs ? "a verb"
                                       : "expected"),
               called, advice.empty() ? see : advice + (advice.ends_with('?') ? " " : "; ") + see)
      .what();
}

}  // namespace

ProgressBar::ProgressBar() : terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() { clear(); }

void ProgressBar::clear() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

void ProgressBar::show(const std::string& what, double part) {
  if (!terminal_) return;
  constexpr int kWidth = 30;
  const int full = static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * kWidth));
  const std::string bar = std::string(full, '#') + std::string(kWidth - full, '-');
  std::fputs(fmt::format("\r\033[K[{}] {:3.0f} %  {}", bar, 100 * part, what).c_str(), stderr);
  std::fflush(stderr);
  shown_ = true;
}

std::string jsonText(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

namespace {

thread_local std::string t_log_label;

/// Prints the label of the thread that logs.
class LabelFlag final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg&, const std::tm&, spdlog::memory_buf_t& to) override {
    if (t_log_label.empty()) return;
    to.append(t_log_label.data(), t_log_label.data() + t_log_label.size());
    to.push_back(':');
    to.push_back(' ');
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<LabelFlag>();
  }
};

}  // namespace

LogLabel::LogLabel(const std::string& label) { t_log_label = label; }
LogLabel::~LogLabel() { t_log_label.clear(); }
const std::string& LogLabel::current() { return t_log_label; }

void printLogLabels() {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<LabelFlag>('*').set_pattern("[%Y-%m-%d %H:%M:%S.%e] [%n] [%^%l%$] %*%v");
  spdlog::set_formatter(std::move(formatter));
}

void Report::add(const std::string& key, const std::string& label, const std::string& text) {
  rows_.push_back({key, label, text, jsonText(text)});
}

void Report::add(const std::string& key, const std::string& label, double value, const std::string& unit,
                 int digits) {
  rows_.push_back({key, label, fmt::format("{:.{}f} {}", value, digits, unit), nlohmann::json(value).dump()});
}

void Report::addCount(const std::string& key, const std::string& label, uint64_t value) {
  rows_.push_back({key, label, fmt::format("{}", value), fmt::format("{}", value)});
}

std::string Report::json() const {
  std::string object;
  for (const Row& row : rows_)
    object += fmt::format("{}{}: {}", object.empty() ? "" : ", ", nlohmann::json(row.key).dump(), row.json);
  return fmt::format("{{{}}}", object);
}

void Report::print(bool json) const {
  if (json) {
    std::puts(this->json().c_str());
  } else {
    size_t width = 0;
    for (const Row& row : rows_) width = std::max(width, row.label.size());
    for (const Row& row : rows_) std::puts(fmt::format("  {:<{}}  {}", row.label, width, row.text).c_str());
  }
  std::fflush(stdout);
}

int withOutputWritten(int exit_code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  pollfd out{STDOUT_FILENO, 0, 0};
  const bool has_reader_gone = poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
  if (has_reader_gone) return exit_code;
  std::fputs("error: standard output cannot be written; is the disk full?\n", stderr);
  return kExitBadInput;
}

std::optional<int> parseArguments(CLI::App& app, int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int i = 0; i < argc; ++i) words.push_back(withWholePart(argv[i]));
  if (argc == 2 && words[1] == "--help-markdown") {
    std::fputs(markdownHelp(app, std::filesystem::path(words[0]).filename().string()).c_str(), stdout);
    return withOutputWritten(0);
  }
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  try {
    app.parse(argc, pointers.data());
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    const auto code = static_cast<CLI::ExitCodes>(error.get_exit_code());
    const bool is_about_words = code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError;
    if (const std::string line = is_about_words ? unexpected(app) : ""; !line.empty()) {
      std::fputs(fmt::format("error: {}\n", line).c_str(), stderr);
      return kExitBadInput;
    }
    return withOutputWritten(app.exit(error) == 0 ? 0 : kExitBadInput);
  }
}

int runProgram(const std::function<int()>& body) {
  try {
    return withOutputWritten(body());
  } catch (const Interrupted&) {
    std::fputs("stopped\n", stderr);
    return kExitInterrupted;
  } catch (const BakeStopped&) {
    std::fputs("stopped\n", stderr);
    return kExitInterrupted;
  } catch (const std::system_error& error) {
    if (std::ferror(stdout) != 0) return withOutputWritten(0);  // fmt throws where more than a buffer is lost
    std::fputs(fmt::format("error: {}\n", error.what()).c_str(), stderr);
  } catch (const std::exception& error) {
    std::fputs(fmt::format("error: {}\n", error.what()).c_str(), stderr);
  }
  return kExitBadInput;
}

}  // namespace strandcast
