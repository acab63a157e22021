#pragma once
#include <functional>

namespace CLI {
class App;
}

namespace strandcast {

/// Runs a parsed verb and returns its exit code.
using Verb = std::function<int()>;

/// Each declares its verb and options on `app` and returns the function that runs it.
Verb addInfo(CLI::App& app);
Verb addConvert(CLI::App& app);
Verb addBake(CLI::App& app);
Verb addCheck(CLI::App& app);
Verb addRender(CLI::App& app);
Verb addCompare(CLI::App& app);
Verb addView(CLI::App& app);
Verb addValidate(CLI::App& app);
Verb addCtl(CLI::App& app);
Verb addKeys(CLI::App& app);
Verb addRecord(CLI::App& app);
Verb addReplay(CLI::App& app);

}  // namespace strandcast
