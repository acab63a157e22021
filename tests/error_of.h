#pragma once
#include <string>

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

}  // namespace strandcast
