#pragma once

namespace CLI {
class Validator;
}

namespace strandcast {

/// Refuses an option's number unless it is one, and from `low` to `high`. CLI::Range lets NaN pass, which is
/// neither below nor above: it is for whole numbers only.
CLI::Validator finiteRange(double low, double high);

}  // namespace strandcast
