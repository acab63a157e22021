#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"

namespace strandcast {

/// What the Error says that `action` throws; empty where it throws none.
template <class Action>
std::string errorOf(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// Expects `act` to throw an Error whose text is one line and contains each of `parts`.
template <class Act>
void expectError(Act act, const std::vector<std::string>& parts) {
  try {
    act();
  } catch (const Error& error) {
    const std::string message = error.what();
    for (const std::string& part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "no \"" << part << "\" in: " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return;
  }
  ADD_FAILURE() << "nothing was thrown, expected an error with \"" << (parts.empty() ? "" : parts[0]) << '"';
}

}  // namespace strandcast
