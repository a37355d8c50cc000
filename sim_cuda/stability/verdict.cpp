#include "sim_cuda/stability/verdict.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>

namespace collidoscope {

double AssertionResult::worst() const {
  if (passed) return value;
  return value <= bound ? least : most;
}

void update(AssertionResult& known, const Assertion& assertion, const Extremes& extremes,
            std::int64_t state) {
  const bool fresh = !known.measured;
  const auto bounded = [&](double value, std::optional<double> bound, bool above,
                           std::optional<std::uint32_t> body) {
    if (!bound || !known.passed) return;
    const bool passed = above ? value <= *bound : value >= *bound;
    const double room = above ? *bound - value : value - *bound;
    const double least = known.value <= known.bound ? known.bound - known.value : known.value - known.bound;
    if (passed && known.measured && !(room < least)) return;
    known.measured = true;
    known.passed = passed;
    known.value = value;
    known.bound = *bound;
    known.state = state;
    known.body = body;
  };
  bounded(extremes.max, assertion.at_most, true, extremes.max_body);
  bounded(extremes.min, assertion.at_least, false, extremes.min_body);
  // A NaN stays.
  if (fresh || !(known.least <= extremes.min))
    known.least = std::isnan(known.least) ? known.least : extremes.min;
  if (fresh || !(known.most >= extremes.max)) known.most = std::isnan(known.most) ? known.most : extremes.max;
}

std::string failure_text(const Assertion& assertion, const AssertionResult& known,
                         const std::string& finding) {
  if (assertion.quantity == Quantity::expected_finding)
    return text_of(assertion) + ": " + (finding.empty() ? "no finding" : finding);
  std::string text =
      fmt::format("{}: {} at state {}{}", text_of(assertion), text_of(assertion.quantity, known.value),
                  known.state, known.body ? fmt::format(", body {}", *known.body) : "");
  const std::string worst = text_of(assertion.quantity, known.worst());
  if (worst != text_of(assertion.quantity, known.value))
    text += fmt::format("; {} to {}", known.worst() < known.bound ? "down" : "up", worst);
  return text;
}

void judge(TestResult& result, const std::vector<Assertion>& assertions, const ExpectedFailure* limit,
           bool broken, const std::string& finding) {
  std::vector<std::string> failures, unexpected;
  for (std::size_t k = 0; k < result.assertions.size(); ++k) {
    const AssertionResult& known = result.assertions[k];
    const ExpectedFailureTerm* allowed = limit != nullptr ? limit->term_of(k) : nullptr;
    if (known.passed) {
      if (allowed != nullptr && !broken)
        unexpected.push_back(
            fmt::format("{}: holds although a limit is declared; remove it", text_of(assertions[k])));
      continue;
    }
    failures.push_back(failure_text(assertions[k], known, finding));
    if (allowed == nullptr)
      unexpected.push_back(failures.back());
    else if ((assertions[k].at_most && !(known.most <= allowed->at_most.value_or(*assertions[k].at_most))) ||
             (assertions[k].at_least &&
              !(known.least >= allowed->at_least.value_or(*assertions[k].at_least))))
      unexpected.push_back(
          fmt::format("{}; the declared limit is {}", failures.back(), text_of(assertions[k], *allowed)));
  }
  if (broken) unexpected.insert(unexpected.begin(), result.failure);
  if (!broken) result.failure = fmt::to_string(fmt::join(failures, "; "));
  if (!unexpected.empty()) {
    result.outcome = TestOutcome::failed;
    result.why = fmt::to_string(fmt::join(unexpected, "; "));
  } else if (!failures.empty()) {
    result.outcome = TestOutcome::expected_failure;
    result.why = limit->why;
  }
}

}  // namespace collidoscope
