// Ctrl-C is heard wherever many effects are looked at.
#include <gtest/gtest.h>

#include <csignal>

#include "base/error.h"
#include "base/interrupt.h"
#include "diagnosis/detectable.h"
#include "diagnosis/search/hints.h"
#include "diagnosis/small_plate.h"
#include "simulators/tables/loaded_table.h"

namespace chladni::diagnosis {
namespace {

class Interrupt : public testing::Test {
 protected:
  void SetUp() override {
    catch_interrupts();
    ASSERT_EQ(std::raise(SIGINT), 0);
  }
  void TearDown() override { forget_interrupt(); }
};

TEST_F(Interrupt, IsHeardByTheScoreTest) {
  const Observed observed = observed_in(state_of(small_plate()), 100.0);
  const std::vector<Deviation> none;
  const std::vector<const Effect*> all(effects().begin(), effects().end());
  EXPECT_THROW(static_cast<void>(hints({small_plate(), observed, none}, Fit{}, all, {})),
               Interrupted);
}

TEST_F(Interrupt, IsHeardByTheDetectableSizes) {
  simulators::LoadedTable table;
  table.lines = 20;
  table.high_hz = 700.0;
  const auto measured = simulators::loaded_table(simulators::believed_table(8), table);
  DiagnosisOptions options;
  options.tolerances = exact_model();
  EXPECT_THROW(static_cast<void>(detectable(small_plate(), measured, options)), Interrupted);
}

}  // namespace
}  // namespace chladni::diagnosis
