#include "apps/console.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <system_error>

#include "collision/field_bake.h"

namespace strandcast {
namespace {

/// CLI11 takes -0.5 for a number and -.5 for an option.
std::string withWholePart(const std::string& argument) {
  const bool is_short = argument.starts_with("-.") && argument.size() > 2 &&
                        std::isdigit(static_cast<unsigned char>(argument[2])) != 0;
  if (!is_short) return argument;
  char* end = nullptr;
  std::strtod(argument.c_str(), &end);
  return *end == '\0' ? "-0" + argument.substr(1) : argument;
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

void Report::print(bool json) const {
  if (json) {
    std::string object;
    for (const Row& row : rows_)
      object += fmt::format("{}{}: {}", object.empty() ? "" : ", ", nlohmann::json(row.key).dump(), row.json);
    std::puts(fmt::format("{{{}}}", object).c_str());
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
  std::vector<const char*> pointers;
  for (const std::string& word : words) pointers.push_back(word.c_str());
  try {
    app.parse(argc, pointers.data());
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
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
