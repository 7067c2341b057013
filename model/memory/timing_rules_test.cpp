// SPDX-License-Identifier: Apache-2.0
// Each timing rule in a pair: a clock early it is refused, on time it is allowed; by the
// controller's own account and, from the commands alone, by the checker.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "model/memory/bank_timing.h"
#include "model/memory/command_checker.h"

namespace fasttree::model {
namespace {

using enum DramCommandKind;

struct Step {
  DramCommandKind kind;
  std::uint8_t bank;
  std::uint64_t clock;
};

struct RuleCase {
  const char* name;
  const char* rule;  ///< as the checker calls it
  std::vector<Step> before;
  Step command;  ///< its clock is the first that is allowed
  std::uint32_t trc = 49;
};

void PrintTo(const RuleCase& rule, std::ostream* out) {
  *out << rule.name;
}

// LPDDR3-1600: tRCD 15, tRP 15, tRAS 34, tRRD 8, tFAW 40, tWTR 6, tWR 12, tRTP 6, tCCD 4, CL 12,
// CWL 9, four clocks a burst, tRFCab 168, tRFCpb 72. The numbers below are worked out by hand.
const std::vector<RuleCase> kCases = {
    {"ActivateToRead", "tRCD", {{activate, 0, 0}}, {read, 0, 15}},
    {"ActivateToWrite", "tRCD", {{activate, 0, 0}}, {write, 0, 15}},
    {"ActivateToPrecharge", "tRAS", {{activate, 0, 0}}, {precharge, 0, 34}},
    {"ActivateToActivate", "tRC", {{activate, 0, 0}, {precharge, 0, 34}}, {activate, 0, 60}, 60},
    {"ActivateToRefreshBank",
     "tRC",
     {{activate, 0, 0}, {precharge, 0, 34}},
     {refresh_bank, 0, 60},
     60},
    {"ActivateToRefreshAll",
     "tRC",
     {{activate, 5, 0}, {precharge, 5, 34}},
     {refresh_all, 0, 60},
     60},
    {"PrechargeToActivate", "tRP", {{activate, 0, 0}, {precharge, 0, 100}}, {activate, 0, 115}},
    {"PrechargeToRefreshBank",
     "tRP",
     {{activate, 0, 0}, {precharge, 0, 100}},
     {refresh_bank, 0, 115}},
    {"PrechargeToRefreshAll",
     "tRP",
     {{activate, 7, 0}, {precharge, 7, 100}},
     {refresh_all, 0, 115}},
    {"ActivateToOtherBank", "tRRD", {{activate, 0, 0}}, {activate, 1, 8}},
    {"ActivateToRefreshOfOtherBank", "tRRD", {{activate, 1, 0}}, {refresh_bank, 0, 8}},
    {"RefreshToActivateOfOtherBank", "tRRD", {{refresh_bank, 0, 0}}, {activate, 1, 8}},
    {"FourActivates",
     "tFAW",
     {{activate, 0, 0}, {activate, 1, 8}, {activate, 2, 16}, {activate, 3, 24}},
     {activate, 4, 40}},
    {"FourActivatesLater",
     "tFAW",
     {{activate, 0, 0}, {activate, 1, 30}, {activate, 2, 38}, {activate, 3, 46}, {activate, 4, 54}},
     {activate, 5, 70}},
    {"ReadToRead", "tCCD", {{activate, 0, 0}, {read, 0, 15}}, {read, 0, 19}},
    {"ReadToReadOfOtherBank",
     "tCCD",
     {{activate, 0, 0}, {activate, 1, 8}, {read, 0, 30}},
     {read, 1, 34}},
    {"WriteToWrite", "tCCD", {{activate, 0, 0}, {write, 0, 15}}, {write, 0, 19}},
    {"WriteToRead", "tWTR", {{activate, 0, 0}, {write, 0, 15}}, {read, 0, 34}},
    {"WriteToReadOfOtherBank",
     "tWTR",
     {{activate, 0, 0}, {activate, 1, 8}, {write, 0, 40}},
     {read, 1, 59}},
    {"ReadToWrite", "read to write", {{activate, 0, 0}, {read, 0, 15}}, {write, 0, 24}},
    {"WriteToPrecharge", "tWR", {{activate, 0, 0}, {write, 0, 30}}, {precharge, 0, 55}},
    {"ReadToPrecharge", "tRTP", {{activate, 0, 0}, {read, 0, 40}}, {precharge, 0, 46}},
    {"RefreshBankToActivate", "tRFCpb", {{refresh_bank, 0, 0}}, {activate, 0, 72}},
    {"RefreshBankToRefreshBank", "tRFCpb", {{refresh_bank, 0, 0}}, {refresh_bank, 1, 72}},
    {"RefreshAllToActivate", "tRFCab", {{refresh_all, 0, 0}}, {activate, 3, 168}},
    {"RefreshAllToRefreshAll", "tRFCab", {{refresh_all, 0, 0}}, {refresh_all, 0, 168}},
    {"OneCommandAClock", "command bus", {{activate, 0, 0}, {activate, 1, 50}}, {precharge, 0, 51}},
};

class TimingRule : public testing::TestWithParam<RuleCase> {
 protected:
  DramSpec spec() const {
    DramSpec spec;
    spec.trc = GetParam().trc;
    return spec;
  }

  /// What the checker says of the commands before, and of this one at this clock.
  std::vector<std::string> rules_broken_at(std::uint64_t clock) const {
    ControllerConfig controller;
    controller.refresh = RefreshPolicy::none;
    CommandChecker checker(spec(), controller);
    for (const Step& step : GetParam().before) {
      checker.on_command({step.clock, step.kind, 0, step.bank, 0, 0});
    }
    EXPECT_EQ(checker.violation_count(), 0u) << "the commands before are legal";
    const Step& command = GetParam().command;
    checker.on_command({clock, command.kind, 0, command.bank, 0, 0});
    std::vector<std::string> rules;
    for (const CommandViolation& violation : checker.violations()) rules.push_back(violation.rule);
    return rules;
  }
};

TEST_P(TimingRule, TheControllersAccountAllowsItOnTimeAndNoClockEarlier) {
  BankTiming timing(spec());
  for (const Step& step : GetParam().before) {
    ASSERT_LE(timing.earliest(step.kind, step.bank), step.clock);
    timing.issue(step.kind, step.bank, 0, step.clock);
  }
  const Step& command = GetParam().command;
  EXPECT_EQ(timing.earliest(command.kind, command.bank), command.clock);
}

TEST_P(TimingRule, TheCheckerRefusesItAClockEarly) {
  const std::vector<std::string> broken = rules_broken_at(GetParam().command.clock - 1);
  EXPECT_EQ(std::count(broken.begin(), broken.end(), GetParam().rule), 1);
}

TEST_P(TimingRule, TheCheckerAllowsItOnTime) {
  EXPECT_TRUE(rules_broken_at(GetParam().command.clock).empty());
}

INSTANTIATE_TEST_SUITE_P(Lpddr3, TimingRule, testing::ValuesIn(kCases),
                         [](const auto& test) { return std::string(test.param.name); });

struct StateCase {
  const char* name;
  const char* rule;
  std::vector<DramCommand> commands;  ///< the last is illegal
};

void PrintTo(const StateCase& state, std::ostream* out) {
  *out << state.name;
}

class BankState : public testing::TestWithParam<StateCase> {};

TEST_P(BankState, TheCheckerRefusesWhatTheBankCannotDo) {
  ControllerConfig controller;
  controller.refresh = RefreshPolicy::none;
  CommandChecker checker(DramSpec{}, controller);
  for (const DramCommand& command : GetParam().commands) {
    EXPECT_EQ(checker.violation_count(), 0u);
    checker.on_command(command);
  }
  ASSERT_EQ(checker.violation_count(), 1u);
  EXPECT_EQ(checker.violations()[0].rule, GetParam().rule);
}

INSTANTIATE_TEST_SUITE_P(
    Lpddr3, BankState,
    testing::Values(
        StateCase{"ReadOfClosedBank", "state", {{5, read, 0, 0, 0, 0}}},
        StateCase{"WriteOfWrongRow", "row", {{0, activate, 0, 0, 7, 0}, {90, write, 0, 0, 8, 0}}},
        StateCase{
            "ActivateOfOpenBank", "state", {{0, activate, 0, 0, 7, 0}, {90, activate, 0, 0, 8, 0}}},
        StateCase{"RefreshOfOpenBank",
                  "state",
                  {{0, activate, 0, 0, 7, 0}, {90, refresh_bank, 0, 0, 0, 0}}},
        StateCase{"RefreshOfAllWithOneOpen",
                  "state",
                  {{0, activate, 0, 3, 7, 0}, {90, refresh_all, 0, 0, 0, 0}}},
        StateCase{"RefreshOutOfTurn", "refresh order", {{0, refresh_bank, 0, 1, 0, 0}}},
        StateCase{"NoSuchBank", "address", {{0, activate, 0, 8, 0, 0}}},
        StateCase{"NoSuchChannel", "address", {{0, activate, 1, 0, 0, 0}}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(CommandCheckerTest, MissingRefreshesAreSeen) {
  DramSpec spec;
  ControllerConfig controller;  // per bank: one each 390 clocks, one may be on its way
  CommandChecker checker(spec, controller);
  checker.finish(2 * 390 - 1);
  EXPECT_EQ(checker.violation_count(), 0u);
  checker.finish(2 * 390);
  ASSERT_EQ(checker.violation_count(), 1u);
  EXPECT_EQ(checker.violations()[0].rule, "tREFI");
}

}  // namespace
}  // namespace fasttree::model
